import pytest
from slx_models import JACOB_INV, published_leg, published_pendulum
from slx_writer import ModelBuilder, read_understood, write_parts
from work import calls

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.model import SignalWire

LAYOUTS = ("new", "old")


@pytest.fixture
def read(tmp_path):
    def _read(builder, layout="new"):
        return read_understood(builder.write(tmp_path / "model.slx", layout=layout))

    return _read


def by_name(model, name):
    (block,) = [block for block in model.blocks if block.name == name]
    return block


@pytest.mark.parametrize("layout", LAYOUTS)
def test_published_leg(read, layout):
    model = read(published_leg(), layout)
    kinds = [block.kind for block in model.blocks]
    assert len(kinds) == 50
    counts = {kind: kinds.count(kind) for kind in kinds}
    assert counts == {
        "World Frame": 2,
        "Mechanism Configuration": 1,
        "Solver Configuration": 1,
        "Revolute Joint": 3,
        "Rigid Transform": 6,
        "Brick Solid": 3,
        "Spherical Solid": 1,
        "Sin": 1,
        "Constant": 5,
        "Mux": 1,
        "MATLAB Function": 1,
        "Demux": 1,
        "Scope": 4,
        "Integrator": 3,
        "Sum": 3,
        "Simulink-PS Converter": 3,
        "PS-Simulink Converter": 10,
        "6-DOF Joint": 1,
    }
    assert model.name == "model"
    assert model.solver["StopTime"] == 20.0
    assert len(model.wires) == 28
    assert len(model.nodes) == 24
    (function,) = model.functions
    assert function.script == JACOB_INV.format(50, 100, 100)
    assert by_name(model, "MATLAB Function").type == "SubSystem"


def test_both_layouts_say_the_same(read):
    assert read(published_leg(), "new") == read(published_leg(), "old")
    assert read(published_pendulum(), "new") == read(published_pendulum(), "old")


def test_a_node_joins_all_ends(read):
    builder = published_leg()
    settings = ("World Frame", "Mechanism\nConfiguration", "Solver\nConfiguration")
    expected = {f"{builder.sid(name)}#rconn:1" for name in settings}
    expected.add(f"{builder.sid('Revolute Joint')}#lconn:1")
    assert expected in [set(node) for node in read(builder).nodes]


def test_lines_that_share_a_port_are_one_node(read):
    builder = ModelBuilder()
    frames = [
        builder.add_library("sm_lib/Frames and Transforms/Rigid Transform", f"T{place}")
        for place in range(4)
    ]
    builder.physical(f"{frames[0]}#rconn:1", f"{frames[1]}#lconn:1")
    builder.physical(f"{frames[2]}#lconn:1", f"{frames[3]}#lconn:1")
    builder.physical(f"{frames[3]}#lconn:1", f"{frames[0]}#rconn:1")
    (node,) = read(builder).nodes
    assert set(node) == {"1#rconn:1", "2#lconn:1", "3#lconn:1", "4#lconn:1"}


@pytest.mark.parametrize("targets", range(1, 8))
def test_branches_at_any_depth(read, targets):
    builder = ModelBuilder()
    source = builder.add_block("Clock", "Clock")
    scopes = [builder.add_block("Scope", f"Scope{place}") for place in range(targets)]
    builder.connect(source, *scopes, name="t")
    assert read(builder).wires == tuple(
        SignalWire(source=f"{source}#out:1", target=f"{scope}#in:1", name="t") for scope in scopes
    )


def test_names_and_sources_without_line_breaks(read):
    model = read(published_leg())
    assert by_name(model, "Mechanism Configuration").source == (
        "sm_lib/Utilities/Mechanism Configuration"
    )


def test_names_in_any_script(read):
    builder = ModelBuilder()
    builder.add_block("Gain", 'Größe θ₁ 脚\t<&">')
    assert read(builder).blocks[0].name == 'Größe θ₁ 脚\t<&">'


@pytest.mark.parametrize("layout", LAYOUTS)
def test_subsystems_hold_their_blocks(read, layout):
    builder = ModelBuilder()
    outer = builder.add_block("SubSystem", "Outer")
    inner = builder.add_block("SubSystem", "Inner", system=outer)
    gain = builder.add_block("Gain", "K", {"Gain": "2"}, system=inner)
    script = "function y = f(u)\ny = u;\n"
    function = builder.add_function("f", script, system=inner)
    builder.connect(gain, function)
    model = read(builder, layout)
    assert [(block.name, block.system) for block in model.blocks] == [
        ("Outer", ""),
        ("Inner", outer),
        ("K", inner),
        ("f", inner),
    ]
    assert model.wires == (SignalWire(source=f"{gain}#out:1", target=f"{function}#in:1", name=""),)
    assert model.functions[0].script == script


def test_functions_of_one_name_are_told_apart(read):
    builder = ModelBuilder()
    scripts = {}
    for place in range(3):
        system = builder.add_block("SubSystem", f"Leg {place}") if place else ""
        script = f"function y = f(u)\ny = {place}*u;\n"
        scripts[builder.add_function("f", script, system=system)] = script
    for layout in LAYOUTS:
        found = {function.sid: function.script for function in read(builder, layout).functions}
        assert found == scripts


@pytest.mark.parametrize("layout", LAYOUTS)
def test_commented_blocks_are_left_out_with_their_lines(read, layout):
    builder = published_leg()
    builder.set("foot velocities", Commented="on").set("Revolute Joint2", Commented="on")
    model = read(builder, layout)
    assert len(model.blocks) == 48
    assert len(model.wires) == 25
    gone = builder.sid("Revolute Joint2")
    assert not any(port.startswith(f"{gone}#") for node in model.nodes for port in node)


@pytest.mark.parametrize("layout", LAYOUTS)
def test_signals_pass_blocks_that_are_commented_through(read, layout):
    builder = ModelBuilder()
    clock = builder.add_block("Clock", "Clock")
    gains = [builder.add_block("Gain", f"K{place}", {"Commented": "through"}) for place in (0, 1)]
    scopes = [builder.add_block("Scope", f"S{place}") for place in (0, 1)]
    builder.connect(clock, gains[0], name="t")
    builder.connect(gains[0], gains[1], scopes[0])
    builder.connect(gains[1], scopes[1], name="near")
    model = read(builder, layout)
    assert [block.name for block in model.blocks] == ["Clock", "S0", "S1"]
    assert {(wire.source, wire.target, wire.name) for wire in model.wires} == {
        (f"{clock}#out:1", f"{scopes[0]}#in:1", "t"),
        (f"{clock}#out:1", f"{scopes[1]}#in:1", "near"),
    }


def test_each_port_passes_to_its_own_number(read):
    builder = ModelBuilder()
    clocks = [builder.add_block("Clock", f"C{place}") for place in (1, 2)]
    box = builder.add_block("SubSystem", "Box", {"Commented": "through"})
    builder.add_block("Nonsense", "N", {"Commented": "through"}, system=box)
    scopes = [builder.add_block("Scope", f"S{place}") for place in (1, 2, 3)]
    for place, clock in enumerate(clocks, 1):
        builder.connect(clock, f"{box}#in:{place}")
    for place, scope in enumerate(scopes, 1):
        builder.connect(f"{box}#out:{place}", scope)
    model = read(builder)
    assert [(wire.source, wire.target) for wire in model.wires] == [
        (f"{clock}#out:1", f"{scope}#in:1") for clock, scope in zip(clocks, scopes[:2], strict=True)
    ]


def test_frames_pass_blocks_that_are_commented_through(read):
    builder = published_leg().set("Rigid Transform2", Commented="through")
    joint, gone, brick, far = (
        builder.sid(name)
        for name in ("Revolute Joint1", "Rigid Transform2", "Brick Solid1", "Rigid Transform3")
    )
    nodes = [set(node) for node in read(builder).nodes]
    assert {f"{joint}#rconn:1", f"{brick}#rconn:1", f"{far}#lconn:1"} in nodes
    assert len(nodes) == 23
    assert not any(port.startswith(f"{gone}#") for node in nodes for port in node)


def test_what_is_inside_a_commented_subsystem_passes_nothing(read):
    builder = ModelBuilder()
    system = builder.add_block("SubSystem", "Off", {"Commented": "on"})
    clock = builder.add_block("Clock", "C", system=system)
    gain = builder.add_block("Gain", "K", {"Commented": "through"}, system=system)
    builder.connect(clock, gain)
    builder.connect(gain, builder.add_block("Scope", "S", system=system))
    model = read(builder)
    assert model.blocks == model.wires == ()


def test_a_circle_of_blocks_that_are_commented_through_is_said(read):
    builder = ModelBuilder()
    gain, other = (builder.add_block("Gain", name, {"Commented": "through"}) for name in "KL")
    scope = builder.add_block("Scope", "S")
    builder.connect(gain, other)
    builder.connect(other, gain, scope)
    with pytest.raises(InvalidValueError, match="signal at 3#in:1 forms a loop of blocks that"):
        read(builder)


@pytest.mark.parametrize("layout", LAYOUTS)
@pytest.mark.parametrize("mask", ["texts", "object"])
def test_functions_of_old_files(read, layout, mask):
    builder = published_leg().set("MATLAB Function", SFBlockType=None)
    if mask == "texts":
        builder.set("MATLAB Function", MaskType="Stateflow")
    else:
        builder.blocks[builder.sid("MATLAB Function")].mask = (
            '<Object PropName="MaskObject" ClassName="Simulink.Mask"><P Name="Type">Stateflow</P>'
            "</Object>"
        )
    model = read(builder, layout)
    assert len(model.blocks) == 50
    assert by_name(model, "MATLAB Function").kind == "MATLAB Function"
    assert [function.script for function in model.functions] == [JACOB_INV.format(50, 100, 100)]


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("<eml>", "<state><eml>"),
        ("<eml>", '<P Name="type">STATE_CHART</P><eml>'),
        ("chart>", "nothing>"),
    ],
)
def test_other_charts_of_old_files_are_no_functions(tmp_path, old, new):
    builder = ModelBuilder()
    function = builder.add_function("f", "function y = f(u)\ny = u;\n")
    builder.blocks[function].parameters = {"MaskType": "Stateflow"}
    parts = {
        name: text.replace("<chart ", "<nothing ").replace("</chart>", "</nothing>")
        if "nothing" in new
        else text.replace(old, new).replace(
            "</eml>", "</eml></state>" if "state>" in new else "</eml>"
        )
        for name, text in builder.parts().items()
    }
    model = read_understood(write_parts(tmp_path / "m.slx", parts))
    assert all(function.is_chart for function in model.functions)
    assert model.blocks[0].kind == ("SubSystem" if "nothing" in new else "Chart")


def test_all_inside_a_commented_subsystem_is_left_out(read):
    builder = ModelBuilder()
    system = builder.add_block("SubSystem", "Off", {"Commented": "on"})
    gain = builder.add_block("Nonsense", "N", system=system)
    builder.connect(gain, builder.add_block("Scope", "S", system=system))
    model = read(builder)
    assert model.blocks == model.wires == ()


def test_hanging_lines_are_skipped(tmp_path):
    builder = ModelBuilder()
    builder.add_block("Gain", "K")
    parts = builder.parts()
    root = "simulink/systems/system_root.xml"
    hanging = (
        '<Line><P Name="Src">1#out:1</P></Line><Line><P Name="Dst">1#in:1</P></Line>'
        '<Line LineType="Connection"><P Name="Points">[1,2]</P></Line>'
        '<Line><P Name="Src">1#out:1</P><Branch><P Name="Points">[0, 1]</P></Branch></Line>'
    )
    parts[root] = parts[root].replace("</System>", f"{hanging}</System>")
    model = read_understood(write_parts(tmp_path / "m.slx", parts))
    assert model.wires == model.nodes == ()


def test_older_files_count_ports_in_a_text(tmp_path):
    builder = ModelBuilder()
    builder.add_block("Demux", "D", {"Ports": "[1, 3]"})
    builder.add_block("Mux", "M", ports={"in": 5, "out": 1})
    model = read_understood(builder.write(tmp_path / "m.slx", layout="old"))
    assert by_name(model, "D").parameters["Outputs"] == 3.0
    assert by_name(model, "M").parameters["Inputs"] == 5.0


def test_solver_defaults_and_settings(read):
    model = read(ModelBuilder(solver={}))
    assert model.solver == {
        "Solver": "VariableStepAuto",
        "SolverType": "Variable-step",
        "StartTime": 0.0,
        "StopTime": 10.0,
        "RelTol": 1e-3,
        "AbsTol": "auto",
        "MaxStep": "auto",
        "MinStep": "auto",
        "InitialStep": "auto",
        "FixedStep": "auto",
    }
    for layout in LAYOUTS:
        settings = {"SolverName": "ode4", "StopTime": "2*pi", "FixedStep": "1e-3"}
        solver = read(ModelBuilder(solver=settings), layout).solver
        assert solver["SolverType"] == "Fixed-step"
        assert solver["StopTime"] == pytest.approx(6.283185307179586)
        assert solver["FixedStep"] == 1e-3


def test_a_model_without_configuration_has_the_defaults(tmp_path):
    parts = ModelBuilder().parts()
    del parts["simulink/configSet0.xml"]
    model = read_understood(write_parts(tmp_path / "m.slx", parts))
    assert model.solver["StopTime"] == 10.0


def edited(tmp_path, old, new, builder=None):
    if builder is None:
        builder = ModelBuilder()
        builder.connect(builder.add_block("Gain", "K"), builder.add_block("Scope", "S"))
    parts = {name: text.replace(old, new) for name, text in builder.parts().items()}
    return write_parts(tmp_path / "m.slx", parts)


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        ('SID="2"', 'SID="1"', "two blocks have the SID 1, the second is 'S'"),
        ('SID="2"', "", "block 'S' has no SID"),
        ('BlockType="Scope"', "", "block 'S' has no BlockType"),
        ("2#in:1", "7#in:1", "a line ends at 7#in:1, but there is no block with SID 7"),
        ("1#out:1", "9#out:1", "a line ends at 9#out:1, but there is no block with SID 9"),
        ("2#in:1", "2#out:1", "a line ends at 2#out:1, which is not an input"),
        ("1#out:1", "1#in:1", "a line begins at 1#in:1, which is not an output"),
        ("2#in:1", "somewhere", "a line ends at 'somewhere', which is not a port"),
        ('"Scope"', '"Quantum"', "block 'S' .SID 2. is of type 'Quantum'"),
        ('"Scope"', '"ModelReference"', "block 'S' .SID 2. is a diagram in a file of its own"),
        ('"Scope"', '"Reference"', "block 'S' .SID 2. names no library block"),
        ("</Line>", "</Line><Line><P Name='Src'>1#out:1</P><P Name='Dst'>2#in:1</P></Line>", "two"),
    ],
)
def test_what_makes_no_sense_is_said(tmp_path, old, new, sentence):
    with pytest.raises(InvalidValueError, match=sentence):
        read_understood(edited(tmp_path, old, new))


def test_unknown_library_blocks_are_named(tmp_path):
    builder = ModelBuilder()
    builder.add_library("my_lib/Leg", "Leg 1")
    with pytest.raises(
        InvalidValueError, match=r"'Leg 1' \(SID 1\) comes from 'my_lib/Leg'.*no file my_lib"
    ):
        read_understood(builder.write(tmp_path / "m.slx"))


def test_one_system_shown_twice_is_refused(tmp_path):
    builder = ModelBuilder()
    for name in "AB":
        builder.add_block("SubSystem", name)
    with pytest.raises(InvalidValueError, match="shows the system system_1, which another block"):
        read_understood(edited(tmp_path, "system_2", "system_1", builder))


@pytest.mark.parametrize("name", ["system_9", "../../etc/passwd", "", "a" * 500])
def test_missing_systems_are_named(tmp_path, name):
    builder = ModelBuilder()
    builder.add_block("SubSystem", "A")
    with pytest.raises(InvalidValueError, match="it has no part for the system"):
        read_understood(edited(tmp_path, '"system_1"', f'"{name}"', builder))


def test_endless_depth_is_refused(tmp_path):
    builder = ModelBuilder()
    system = ""
    for place in range(150):
        system = builder.add_block("SubSystem", f"S{place}", system=system)
    for layout, sentence in (("new", "more than 100 deep"), ("old", "deeper than 200 levels")):
        with pytest.raises(InvalidValueError, match=sentence):
            read_understood(builder.write(tmp_path / f"{layout}.slx", layout=layout))


@pytest.mark.slow
def test_the_work_is_proportional_to_the_number_of_blocks(tmp_path):
    def work(joints):
        builder = published_leg()
        for place in range(joints):
            builder.add_library(
                "sm_lib/Joints/6-DOF Joint", f"J{place}", {"PxPositionTargetValue": f"{place}"}
            )
        path = builder.write(tmp_path / f"{joints}.slx")
        assert len(read_understood(path).blocks) == 50 + joints
        return calls(lambda: read_understood(path))

    few, more, most = work(0), work(50), work(150)
    assert most - few == pytest.approx(3 * (more - few), rel=0.2)
