"""Values from where people keep them: options, scripts, callbacks, masks, CAD data."""

import re

import numpy as np
import pytest
from scipy.io import savemat
from slx_writer import ModelBuilder, mask_text, write_parts

from drake_leg.errors import InvalidValueError, UnknownValueError
from drake_leg.simulink import sources
from drake_leg.simulink.lacks import lacks_of
from drake_leg.simulink.matlab.data import Allowance
from drake_leg.simulink.matlab.workspace import Workspace
from drake_leg.simulink.reader import read_model
from drake_leg.simulink.suggestions import suggested_init, with_scripts

LAYOUTS = ["new", "old"]


@pytest.fixture
def few_steps(monkeypatch):
    """Let scripts take few steps only, so that they soon reach their budget."""

    def small(near, paths, model):
        return Workspace(near, paths, model=model, budget=Allowance(steps=20_000))

    monkeypatch.setattr(sources, "Workspace", small)


def one_gain(text="L", **settings):
    builder = ModelBuilder(**settings)
    builder.add_block("Gain", "K", {"Gain": text})
    return builder


def gain(path, **given):
    """Return the gain of a model, and where its variables come from."""
    model = read_model(path, **given)
    (block,) = (block for block in model.blocks if block.type == "Gain")
    value = block.parameters["Gain"]
    return value, model.variables.used


@pytest.mark.parametrize("layout", LAYOUTS)
@pytest.mark.parametrize("callback", ["PreLoadFcn", "PostLoadFcn", "InitFcn"])
def test_callbacks_give_values(tmp_path, layout, callback):
    path = one_gain("2*L", callbacks={callback: "W = 1;\nL = 3*W;"}).write(
        tmp_path / "m.slx", layout=layout
    )
    assert gain(path) == (6.0, {"L": f"{callback}, line 2"})


@pytest.mark.parametrize("layout", LAYOUTS)
def test_the_model_workspace_may_be_code_or_a_file(tmp_path, layout):
    code = {"WSDataSource": "MATLAB Code", "WSMATLABCode": "L = [1 2];"}
    path = one_gain("L", workspace=code, callbacks={"InitFcn": "L = 7;"}).write(
        tmp_path / "m.slx", layout=layout
    )
    assert gain(path) == ((1.0, 2.0), {"L": "model workspace"})
    (tmp_path / "data.m").write_text("L = 5;")
    savemat(tmp_path / "data.mat", {"L": 6.0})
    for name, kind, value in (("data.m", "MATLAB File", 5), ("data.mat", "MAT-File", 6)):
        file = {"WSDataSource": kind, "WSSourceFileName": f"C:\\Users\\me\\{name}"}
        path = one_gain("L", workspace=file).write(tmp_path / "n.slx", layout=layout)
        assert gain(path) == (value, {"L": f"model workspace ({name})"})


def test_the_model_workspace_may_lie_in_the_file(tmp_path):
    savemat(tmp_path / "w.mat", {"workspace": {"L": 4.0, "v": np.array([1.0, 2.0])}})
    packed = b"\x00\x01IM\0\0\0\0" + (tmp_path / "w.mat").read_bytes()[128:]
    parts = {**one_gain("L*v").parts(), "simulink/modelWorkspace.mxarray": packed}
    path = write_parts(tmp_path / "m.slx", parts)
    assert gain(path) == ((4.0, 8.0), dict.fromkeys(("L", "v"), "model workspace"))
    broken = {**parts, "simulink/modelWorkspace.mxarray": packed[:100]}
    model = read_model(write_parts(tmp_path / "b.slx", broken))
    assert "the model workspace is damaged" in str(model.variables.workspace.skipped[0])


def test_what_a_person_gives_comes_first(tmp_path):
    (tmp_path / "numbers.m").write_text("L = 2; W = 10; clear H; H = 3;")
    callbacks = {"PreLoadFcn": "L = 1; W = 1; H = 1; D = 1;", "InitFcn": "W = 99; D = 2*L;"}
    path = one_gain("[L W H D]", callbacks=callbacks).write(tmp_path / "m.slx")
    init = [tmp_path / "numbers.m"]
    assert gain(path)[0] == (1.0, 99.0, 1.0, 2.0)
    assert gain(path, init=init)[0] == (2.0, 10.0, 3.0, 4.0)
    value, sources = gain(path, init=init, values={"L": "2*pi/pi + 3", "H": 8})
    assert value == (5.0, 10.0, 8.0, 10.0)
    assert sources == {
        "L": "set by hand",
        "W": "numbers.m, line 1",
        "H": "set by hand",
        "D": "InitFcn, line 1",
    }


def test_several_scripts_and_mat_files(tmp_path):
    (tmp_path / "first.m").write_text("a = 1; c = 1;")
    savemat(tmp_path / "second.mat", {"b": 2.0})
    (tmp_path / "third.m").write_text("c = a + b;")
    path = one_gain("c").write(tmp_path / "m.slx")
    names = ("first.m", "second.mat", "third.m")
    assert gain(path, init=[tmp_path / name for name in names])[0] == 3.0


def test_scripts_that_callbacks_call_lie_beside_or_in_folders(tmp_path):
    (tmp_path / "lib" / "deep").mkdir(parents=True)
    (tmp_path / "model").mkdir()
    (tmp_path / "lib" / "deep" / "numbers.m").write_text("L = twice(4);")
    (tmp_path / "model" / "twice.m").write_text("function y = twice(x)\ny = 2*x;")
    path = one_gain("L + twice(1)", callbacks={"InitFcn": "numbers"}).write(
        tmp_path / "model" / "m.slx"
    )
    assert gain(path, paths=[tmp_path / "lib"]) == (10.0, {"L": "numbers.m, line 1"})
    with pytest.raises(UnknownValueError, match="'L' is not a known") as refusal:
        gain(path)
    assert refusal.value.names == ("L",)


def test_what_callbacks_do_to_the_system_is_named_and_the_rest_goes_on(tmp_path):
    code = "system('touch pwned');\nfigure; plot(1);\nload('absent.mat')\nL = 3;\n!touch pwned"
    path = one_gain(callbacks={"InitFcn": code}).write(tmp_path / "m.slx")
    assert gain(path)[0] == 3.0
    skipped = [str(one) for one in read_model(path).variables.workspace.skipped]
    assert [one.partition(" ")[0] for one in skipped] == ["system", "plot", "a", "!"]
    assert "line 3 of InitFcn" in skipped[2]
    assert "'absent.mat' is not in the given folders" in skipped[2]
    assert not (tmp_path / "pwned").exists()


def test_a_callback_that_never_ends_costs_its_own_variables_only(tmp_path, few_steps):
    callbacks = {"PreLoadFcn": "L = 3;\nwhile 1\nM = 1; end", "InitFcn": "N = 4;"}
    path = one_gain("[L N]", callbacks=callbacks).write(tmp_path / "m.slx")
    assert gain(path)[0] == (3.0, 4.0)
    (one,) = read_model(path).variables.workspace.skipped
    assert re.match("line [23] of PreLoadFcn: it takes more than", str(one))


@pytest.mark.parametrize(
    ("script", "reason"),
    [
        ("L = (3;", "line 1 of s.m: "),
        ("L = 3;\nwhile 1, end", "line 2 of s.m: it takes more than"),
        (None, "there is no file .*s.m"),
    ],
)
def test_a_script_that_a_person_gives_must_be_good(tmp_path, few_steps, script, reason):
    path = one_gain().write(tmp_path / "m.slx")
    if script is not None:
        (tmp_path / "s.m").write_text(script)
    with pytest.raises(InvalidValueError, match=reason):
        read_model(path, init=[tmp_path / "s.m"])


@pytest.mark.parametrize(
    ("values", "reason"),
    [
        ({"2L": 1}, "'2L' is no name of a variable"),
        ({"L": "m1"}, "the value of L is 'm1': 'm1' is not a known"),
        ({"L": "1 +"}, "the value of L is '1 .': it ends too early"),
        ({"L": "word"}, "the value of L is 'word'"),
    ],
)
def test_values_that_make_no_sense_are_refused(tmp_path, values, reason):
    path = one_gain().write(tmp_path / "m.slx")
    with pytest.raises(InvalidValueError, match=reason):
        read_model(path, values=values)


def test_data_of_cad_import_are_found_by_the_models_name(tmp_path):
    text = (
        "smiData.RigidTransform(2).translation = [0.0 0.0 0.0];\n"
        "smiData.RigidTransform(1).translation = [1 2 3];  % mm\n"
        "smiData.Solid(2).mass = 0.5;\n"
    )
    (tmp_path / "arm_DataFile.m").write_text(text)
    (tmp_path / "other_DataFile.m").write_text("smiData.Solid(2).mass = 9;")
    path = one_gain("smiData.Solid(2).mass*smiData.RigidTransform(1).translation").write(
        tmp_path / "arm.slx"
    )
    value, sources = gain(path)
    assert value == (0.5, 1.0, 1.5)
    assert sources["smiData"].startswith("arm_DataFile.m")


# --- masks ----------------------------------------------------------------------------------------


def masked(builder, name, values, code="", system="", **attributes):
    sid = builder.add_block("SubSystem", name, system=system)
    builder.blocks[sid].mask = mask_text(values, code, **attributes)
    return sid


def test_masks_hold_structures_cells_and_texts(tmp_path):
    builder = ModelBuilder(callbacks={"InitFcn": "leg.mass = 2; leg.len = [1 2];"})
    outer = masked(builder, "S", {"p": "leg", "c": "{1, 'two', 3}", "kind": "'brick'"})
    text = "p.mass*p.len(2) + c{3} + strcmp(kind, 'brick')"
    builder.add_block("Gain", "K", {"Gain": text}, system=outer)
    assert gain(builder.write(tmp_path / "m.slx")) == (8.0, {"leg": "InitFcn, line 1"})


def test_a_masks_name_comes_before_a_variable_of_the_model(tmp_path):
    builder = ModelBuilder(callbacks={"InitFcn": "m = 100; k = 7;"})
    outer = masked(builder, "S", {"m": "k + 1", "n": "missing"})
    builder.add_block("Gain", "K", {"Gain": "m"}, system=outer)
    path = builder.write(tmp_path / "m.slx")
    assert gain(path) == (8.0, {"k": "InitFcn, line 1"})
    builder.blocks[builder.sid("K")].parameters["Gain"] = "n + q"
    with pytest.raises(UnknownValueError) as refusal:
        gain(builder.write(path))
    assert refusal.value.names == ("missing", "q")


def test_choices_are_numbers_and_switches_are_true_or_false(tmp_path):
    builder = ModelBuilder()
    outer = builder.add_block("SubSystem", "S")
    builder.blocks[outer].mask = (
        '<Mask><MaskParameter Name="law" Type="popup"><Value>Hunt</Value><TypeOptions>'
        "<Option>Linear</Option><Option>Hunt</Option></TypeOptions></MaskParameter>"
        '<MaskParameter Name="on" Type="checkbox"><Value>on</Value></MaskParameter></Mask>'
    )
    builder.add_block("Gain", "K", {"Gain": "[law on]"}, system=outer)
    assert gain(builder.write(tmp_path / "m.slx"))[0] == (2.0, 1.0)
    builder.blocks[outer].mask = builder.blocks[outer].mask.replace("<Value>Hunt", "<Value>Cubic")
    (lack,) = lacks_of(read_model(builder.write(tmp_path / "m.slx")))
    assert "'Cubic': it is none of its choices, 'Linear', 'Hunt'" in lack.reason


def test_choices_of_the_layout_of_2013_are_numbers(tmp_path):
    builder = ModelBuilder()
    outer = builder.add_block("SubSystem", "S")
    builder.blocks[outer].mask = (
        '<Object PropName="MaskObject" ClassName="Simulink.Mask"><Array PropName="Parameters">'
        '<Object><P Name="Type">popup</P><Array PropName="TypeOptions" Type="Cell">'
        "<Cell>Linear</Cell><Cell>Hunt</Cell></Array>"
        '<P Name="Name">law</P><P Name="Value">Hunt</P></Object></Array></Object>'
    )
    builder.add_block("Gain", "K", {"Gain": "law"}, system=outer)
    assert gain(builder.write(tmp_path / "m.slx"))[0] == 2.0


def test_a_mask_sets_and_promotes_parameters_of_blocks_inside(tmp_path):
    builder = ModelBuilder(callbacks={"InitFcn": "far = 3;"})
    code = (
        "r = get_param(gcb, 'value@radius');\nmask = Simulink.Mask.get(gcb);\n"
        "how = mask.getParameter('way');\n"
        "if strcmp(how.Value, 'wide'), w = 2*r; else, w = 0; end\n"
        "set_param([gcb '/Inner'], 'width', num2str(w));\n"
        "set_param([gcb, '/Inner/B'], 'Gain', '11');"
    )
    outer = masked(builder, "S", {"radius": "far/2", "way": "'wide'"}, code)
    builder.blocks[outer].mask = (
        builder.blocks[outer]
        .mask.replace(
            "</Mask>",
            '<MaskParameter Name="up" Type="promote"><Value>far + 1</Value><TypeOptions>'
            "<Option>Inner/C/Gain</Option></TypeOptions></MaskParameter></Mask>",
        )
        .replace("'wide'</Value>", "wide</Value>")
        .replace('Name="way" Type="edit"', 'Name="way" Type="edit" Evaluate="off"')
    )
    inner = masked(builder, "Inner", {"width": "0"}, system=outer)
    for name, text in (("A", "width"), ("B", "0"), ("C", "0")):
        builder.add_block("Gain", name, {"Gain": text}, system=inner)
    model = read_model(builder.write(tmp_path / "m.slx"))
    gains = {b.name: b.parameters["Gain"] for b in model.blocks if b.type == "Gain"}
    assert gains == {"A": 3.0, "B": 11.0, "C": 4.0}


def test_a_callback_reads_the_parameters_of_blocks(tmp_path):
    code = "far = str2num(get_param([bdroot '/S/Far'], 'Value')) + 1;\nno = get_param('m/Q', 'x');"
    builder = ModelBuilder(callbacks={"InitFcn": code})
    outer = builder.add_block("SubSystem", "S")
    builder.add_block("Constant", "Far", {"Value": "2"}, system=outer)
    builder.add_block("Gain", "K", {"Gain": "far"})
    path = builder.write(tmp_path / "m.slx")
    assert gain(path)[0] == 3.0
    assert [one.what for one in read_model(path).variables.workspace.skipped] == ["no"]


def test_a_callback_knows_the_variant_that_is_chosen(tmp_path):
    code = "choice = get_param([bdroot '/S'], 'ActiveVariant'); hole = str2num(choice(end));"
    builder = ModelBuilder(callbacks={"InitFcn": code})
    builder.add_block("SubSystem", "S", {"LabelModeActiveChoice": "Hole_7"})
    builder.add_block("Gain", "K", {"Gain": "hole"})
    assert gain(builder.write(tmp_path / "m.slx"))[0] == 7.0


def test_a_copy_has_the_name_and_the_folder_of_its_model(tmp_path):
    code = "switch bdroot, case 'walker', load values; end"
    builder = ModelBuilder(callbacks={"InitFcn": code})
    builder.add_block("Gain", "K", {"Gain": "far"})
    home = tmp_path / "robot" / "models"
    home.mkdir(parents=True)
    savemat(home / "values.mat", {"far": 5.0})
    walker = builder.write(home / "walker.slx")
    copy = tmp_path / "my_walker.slx"
    copy.write_bytes(walker.read_bytes())
    assert gain(copy, paths=[tmp_path / "robot"])[0] == 5.0
    assert lacks_of(read_model(copy))
    copy.write_bytes(walker.read_bytes() + b" ")
    assert lacks_of(read_model(copy, paths=[tmp_path / "robot"]))


# --- what is missing ------------------------------------------------------------------------------


def test_all_that_is_missing_is_asked_for_by_name(tmp_path):
    builder = ModelBuilder()
    outer = masked(builder, "S", {"m": "m1"})
    builder.add_block("Gain", "K", {"Gain": "m + m2"}, system=outer)
    builder.add_block("Gain", "J", {"Gain": "leg.mass"})
    lacks = lacks_of(read_model(builder.write(tmp_path / "m.slx")))
    names = {lack.names for lack in lacks}
    assert names == {("m1", "m2"), ("leg",)}


def suggested(path, **given):
    model = read_model(path, **given)
    return suggested_init(model, lacks_of(model))


def test_the_script_that_sets_most_is_suggested(tmp_path):
    (tmp_path / "less.m").write_text("m1 = 1;")
    (tmp_path / "more.m").write_text("if true, m1 = 1; end\nm2 = 2; other = 3;")
    (tmp_path / "broken.m").write_text("m1 = (; m2 = 2; m3 = 3")
    (tmp_path / "runs.m").write_text("clear all\nmore\nload('third')")
    savemat(tmp_path / "third.mat", {"m3": 1.0})
    path = one_gain("m1*m2*m3").write(tmp_path / "m.slx")
    found = suggested(path)
    assert (found.path.name, found.names) == ("runs.m", ("m1", "m2", "m3"))
    assert suggested(path, init=[found.path]) is None
    (tmp_path / "runs.m").unlink()
    assert suggested(path).path.name == "more.m"


def test_a_script_of_a_project_is_suggested_before_one_that_sets_as_many(tmp_path):
    (tmp_path / "sweep.m").write_text("m1 = 1; m2 = 2;")
    (tmp_path / "values.m").write_text("m1 = 3; m2 = 4;")
    (tmp_path / "startup_robot.m").write_text("go = 1;\nif go\n  values\n  m\nend")
    path = one_gain("m1*m2").write(tmp_path / "m.slx")
    (tmp_path / "html").mkdir()
    (tmp_path / "html" / "m.m").write_text("m1 = 100;")
    found = suggested(path, paths=[tmp_path])
    assert found.path.name == "startup_robot.m"
    assert gain(path, init=[found.path], paths=[tmp_path])[0] == 12.0


def test_a_script_that_sets_the_fields_is_suggested_before_another(tmp_path):
    (tmp_path / "a.m").write_text("leg.other = 1;")
    (tmp_path / "b.m").write_text("leg.mass = 1;")
    path = one_gain("leg.mass").write(tmp_path / "m.slx")
    assert suggested(path).path.name == "b.m"


def test_a_script_that_sets_values_comes_before_one_that_only_runs_it(tmp_path):
    (tmp_path / "derive.m").write_text("setup;\nother = m1;")
    (tmp_path / "setup.m").write_text("m1 = 1;\nm2 = 2;")
    found = suggested(one_gain("m1*m2").write(tmp_path / "m.slx"))
    assert (found.path.name, found.others) == ("setup.m", ())


def test_a_variable_with_the_name_of_a_function_is_asked_for(tmp_path):
    (tmp_path / "setup.m").write_text("floor.height = 2;\ngamma = 3;")
    path = one_gain("gamma*floor.height").write(tmp_path / "m.slx")
    found = suggested(path)
    assert found.path.name == "setup.m"
    assert gain(path, init=[found.path])[0] == 6.0


def test_variables_are_those_at_the_first_run_of_the_model(tmp_path):
    lines = "L = 1; n = 4;\nsim('other'); n = 5;\n{}\nL = 2; n = missing; k = 7;\nsim('m')"
    path = one_gain("10*L + n").write(tmp_path / "m.slx")
    for how in ("sim('m.slx', 10);", "out = sim('m', 'StopTime', '2');", 'sim("m");'):
        (tmp_path / "main.m").write_text(lines.format(how))
        assert gain(path, init=[tmp_path / "main.m"])[0] == 15.0, how
    (tmp_path / "main.m").write_text("L = 1; n = 4;\nsim('other'); L = 2;")
    assert gain(path, init=[tmp_path / "main.m"])[0] == 24.0


def test_a_model_is_run_by_its_name_alone_or_behind_the_prefix_of_a_copy(tmp_path):
    (tmp_path / "main.m").write_text("L = 1;\nsim('leg');\nL = 2;")
    for name, expected in (("leg", 10.0), ("12_leg", 10.0), ("bootleg", 20.0)):
        path = one_gain("10*L").write(tmp_path / f"{name}.slx")
        assert gain(path, init=[tmp_path / "main.m"])[0] == expected, name
        path.unlink()
    one_gain("1").write(tmp_path / "leg.slx")  # is another model
    path = one_gain("10*L").write(tmp_path / "robot_leg.slx")
    assert gain(path, init=[tmp_path / "main.m"])[0] == 20.0


def test_a_script_that_has_the_name_of_a_model_runs_by_its_file(tmp_path):
    (tmp_path / "m.m").write_text("L = 3;")
    path = one_gain("10*L").write(tmp_path / "m.slx")
    for how in ("run('m.m')", "run m.m", "run('scripts/m.m')"):
        (tmp_path / "main.m").write_text(f"L = 1;\n{how};")
        assert gain(path, init=[tmp_path / "main.m"])[0] == 30.0, how
    (tmp_path / "main.m").write_text("L = 1;\nm;")  # opens the model
    assert gain(path, init=[tmp_path / "main.m"])[0] == 10.0


def test_a_script_that_fails_or_gives_nothing_is_passed_over(tmp_path, few_steps):
    (tmp_path / "endless.m").write_text("while true, m1 = 1; m2 = 2; end")
    (tmp_path / "missing.m").write_text("m1 = read_it(); m2 = m1;")
    (tmp_path / "setup.m").write_text("m1 = 3;\nother = 4;")
    (tmp_path / "more.m").write_text("m2 = 5;")
    path = one_gain("m1*m2").write(tmp_path / "m.slx")
    model, used = with_scripts(read_model(path), lambda init: read_model(path, init=init))
    assert sorted(each.path.name for each in used) == ["more.m", "setup.m"]
    assert not lacks_of(model)


def test_scripts_that_set_as_many_are_told(tmp_path):
    far = tmp_path / "old"
    far.mkdir()
    for folder in (far, tmp_path):
        (folder / "setup.m").write_text("m1 = 1;")
    found = suggested(one_gain("m1").write(tmp_path / "m.slx"), paths=[far])
    assert (found.path, found.others) == (tmp_path / "setup.m", (far / "setup.m",))


def test_of_scripts_the_one_whose_values_fit_is_used(tmp_path):
    """As of data files of several arms, only some of which have as many parts as the model."""
    for name, code in (
        ("all", "arm.mass = [1 2]; g = 9.8;"), ("b", "arm.mass = [1 2 3];"),
        ("c", "arm.mass = [4 5 6];"), ("gone", "arm.mass = gone;"),
    ):  # fmt: skip
        (tmp_path / f"{name}.m").write_text(code)
    builder = one_gain("arm.mass(3)")
    builder.add_block("Gain", "J", {"Gain": "arm.mass(2)"})
    path = builder.write(tmp_path / "m.slx")

    def values():
        model, used = with_scripts(read_model(path), lambda init: read_model(path, init=init))
        return len(lacks_of(model)), [(each.path.name, each.others) for each in used]

    assert values() == (0, [("b.m", (tmp_path / "c.m", tmp_path / "gone.m"))])
    for name in ("b", "c"):
        (tmp_path / f"{name}.m").unlink()
    assert values() == (1, [("all.m", ())])


def test_nothing_is_suggested_where_nothing_helps(tmp_path):
    (tmp_path / "a.m").write_text("other = 1;")
    assert suggested(one_gain("m1").write(tmp_path / "m.slx")) is None
    assert suggested(one_gain("1").write(tmp_path / "n.slx")) is None


@pytest.mark.parametrize(
    ("source", "texts", "lacking"),
    [
        (
            "Frames and Transforms/Rigid Transform",
            {"TranslationMethod": "None", "TranslationCartesianOffset": "gone"},
            set(),
        ),
        (
            "Frames and Transforms/Rigid Transform",
            {"TranslationMethod": "Cartesian", "TranslationCartesianOffset": "gone"},
            {"TranslationCartesianOffset"},
        ),
        (
            "Frames and Transforms/Rigid Transform",
            {"RotationMethod": "ArbitraryAxis", "RotationAngle": "a", "RotationMatrix": "gone"},
            {"RotationAngle"},
        ),
        (
            "Frames and Transforms/Rigid Transform",
            {"TranslationMethod": "SomethingNew", "TranslationStandardOffset": "gone"},
            {"TranslationStandardOffset"},
        ),
        (
            "Body Elements/Brick Solid",
            {"BasedOnType": "Density", "Density": "rho", "Mass": "gone", "CenterOfMass": "gone"},
            {"Density"},
        ),
        (
            "Body Elements/Brick Solid",
            {"InertiaType": "Custom", "Density": "gone", "Mass": "m", "MomentsOfInertia": "I"},
            {"Mass", "MomentsOfInertia"},
        ),
    ],
)
def test_what_a_block_does_not_use_is_not_asked_for(tmp_path, source, texts, lacking):
    builder = ModelBuilder()
    builder.add_library(f"sm_lib/{source}", "B", texts)
    lacks = lacks_of(read_model(builder.write(tmp_path / "m.slx")))
    assert {lack.parameter for lack in lacks} == lacking


def test_what_a_library_lacks_a_model_lends(tmp_path):
    savemat(tmp_path / "w.mat", {"workspace": {"L": 4.0}})
    packed = b"\x00\x01IM\0\0\0\0" + (tmp_path / "w.mat").read_bytes()[128:]
    (tmp_path / "w.mat").unlink()
    lender = {**one_gain("L").parts(), "simulink/modelWorkspace.mxarray": packed}
    lender_path = write_parts(tmp_path / "robot.slx", lender)
    whole = "simulink/blockdiagram.xml"
    parts = one_gain("2*L").parts()
    model = write_parts(tmp_path / "model.slx", parts)
    assert suggested(model) is None  # a model does not see another one's workspace
    parts[whole] = parts[whole].replace("Model>", "Library>")
    library = write_parts(tmp_path / "library.slx", parts)
    found = suggested(library)
    assert (found.path, found.names) == (lender_path, ("L",))
    source = "model workspace of robot.slx"
    assert gain(library, init=[found.path]) == (8.0, {"L": source})
    assert gain(library, init=[found.path], values={"L": 1})[0] == 2.0
