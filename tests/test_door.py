"""The front door: which names it has, that each teaches by an example, and that it opens fast."""

from __future__ import annotations

import ast
import dataclasses
import doctest
import inspect
import json
import math
import pydoc
import re
import subprocess
import sys
from pathlib import Path

import pytest

import drake_leg
from drake_leg.errors import InvalidValueError
from drake_leg.scene.artists import rendering_fault

ROOT = Path(drake_leg.__file__).parents[1]
SOURCE = Path(drake_leg.__file__).read_text(encoding="utf-8")
ROBOTS = ("PENDULUM", "LEG_A", "LEG_B", "SCARA", "HEXABOT")
MOST_IMPORTS = 5  # lines of a notebook that import from the package


def load(name):
    """Return a name of the door, and leave a module of that name where it was."""
    value = drake_leg.__getattr__(name)
    module = sys.modules.get(f"drake_leg.{name}")
    if module is not None:
        vars(drake_leg)[name] = module
    return value


@pytest.fixture(scope="module")
def fresh():
    """What a new interpreter says after ``import drake_leg``."""
    script = (
        "import json, sys, drake_leg; "
        "print(json.dumps({'modules': list(sys.modules), 'dir': dir(drake_leg)}))"
    )
    command = [sys.executable, "-W", "error", "-c", script]
    return json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)


def homes_for_types():
    """Return name -> (module, own name) of what the door re-exports to type checkers.

    They take ``import y as y`` and ``y = module.y`` for re-exports, and no other import.
    """
    (block,) = (
        node
        for node in ast.parse(SOURCE).body
        if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"
    )
    homes, modules = {}, {}
    for node in block.body:
        if isinstance(node, ast.Assign):
            (target,) = node.targets
            homes[target.id] = (modules[node.value.value.id], node.value.attr)
            continue
        for alias in node.names:
            if alias.asname == alias.name:
                homes[alias.name] = (node.module, alias.name)
            elif alias.asname:
                modules[alias.asname] = f"{node.module}.{alias.name}"
    return homes


def test_the_names_are_the_same_for_people_for_types_and_for_the_loader(fresh):
    assert homes_for_types() == drake_leg._HOMES
    assert sorted(fresh["dir"]) == sorted([*drake_leg._HOMES, "__version__"])


def test_its_help_is_the_tour():
    shown = pydoc.plain(pydoc.render_doc(drake_leg))
    assert "A step of the leg, its foot 140 mm forward and back, in ten lines" in shown
    assert len(shown.splitlines()) < 150


def test_there_are_about_forty():
    assert 25 <= len(drake_leg._HOMES) <= 45


def test_it_imports_neither_drake_nor_numpy(fresh):
    heavy = {"pydrake", "numpy", "scipy", "sympy", "matplotlib"}
    assert not heavy & set(fresh["modules"])


def test_an_unknown_name_is_refused():
    with pytest.raises(AttributeError, match="no attribute 'nonsense'"):
        drake_leg.nonsense  # noqa: B018


def test_the_tour_names_everything_with_a_line():
    tour = inspect.getdoc(drake_leg)
    for name in drake_leg._HOMES:
        assert re.search(rf"^- .*``{name}``.*: \w", tour, flags=re.MULTILINE), name


def test_the_tours_example_runs(tmp_path, monkeypatch, capsys):
    (example,) = re.findall(r"::\n\n((?:    .*\n|\n)+)", inspect.getdoc(drake_leg))
    monkeypatch.chdir(tmp_path)
    exec(inspect.cleandoc(example), {})
    assert len(inspect.cleandoc(example).splitlines()) <= 10
    assert (tmp_path / "step.svg").exists()
    assert capsys.readouterr().out.startswith("[")


@pytest.mark.parametrize("name", sorted(drake_leg._HOMES))
def test_an_example_teaches(name, monkeypatch, tmp_path):
    if name == "write_video" and rendering_fault():
        pytest.skip(f"nothing can be rendered here: {rendering_fault()}")
    monkeypatch.chdir(tmp_path)
    thing = load(name)
    monkeypatch.setattr(drake_leg, name, thing)
    doc = inspect.getdoc(thing)
    assert "\nExamples\n--------\n" in doc, f"{name} has no example"
    if inspect.isfunction(thing):
        assert "\nParameters\n" in doc
        assert "\nReturns\n" in doc or thing.__annotations__["return"] == "None"
    # A class's methods are no names of the door.
    parser, runner = doctest.DocTestParser(), doctest.DocTestRunner(optionflags=doctest.ELLIPSIS)
    examples = parser.get_doctest(doc, {"drake_leg": drake_leg}, name, None, None)
    assert examples.examples
    skipped = [example.source for example in examples.examples if doctest.SKIP in example.options]
    assert not skipped or re.search(r"Not run here, as .*:\n", doc), f"{name} does not say why"
    report: list[str] = []
    runner.run(examples, out=report.append)
    assert runner.failures == 0, "".join(report)


@pytest.mark.parametrize("name", ROBOTS)
def test_a_robot_shows_its_table(name):
    robot = load(name)
    html = robot._repr_html_()
    assert robot.title in html
    assert html.count("<tr>") == len(robot.segments) + 1
    for number in range(1, len(robot.moving) + 1):
        assert len(re.findall(rf"<td>q{number}\b", html)) == 1


def test_a_run_shows_its_summary_and_a_figure_and_writes_what_the_command_writes(tmp_path):
    result = load("run")("pendulum", duration=0.5, out=tmp_path / "move", figures="svg")
    html = result._repr_html_()
    assert "max_angle_error_rad" in html
    assert "data:image/png;base64," in html
    written = {path.name for path in (tmp_path / "move").iterdir()}
    assert {"recording.csv", "summary.json"} <= written
    assert {f"{name}.svg" for name in result.figures} <= written
    summary = json.loads((tmp_path / "move" / "summary.json").read_text(encoding="utf-8"))
    assert summary == {"run": "pendulum", **result.summary}
    assert "rows</b>" in result.recording._repr_html_()


def test_a_misspelt_name_of_the_door_is_guessed():
    with pytest.raises(AttributeError, match=r"no attribute 'simulte': did you mean simulate\?"):
        drake_leg.simulte  # noqa: B018
    with pytest.raises(AttributeError, match=r"no attribute '_repr_'$"):
        drake_leg._repr_  # noqa: B018


def test_a_run_says_which_options_it_has():
    with pytest.raises(InvalidValueError, match=r"no option 'amplitud': did you mean amplitude\?"):
        load("run")("leg-b", amplitud=0.05)
    with pytest.raises(InvalidValueError, match=r"no option 'amp': did you mean amplitude\?"):
        load("run")("leg-b", amp=0.05)
    with pytest.raises(InvalidValueError, match="there is no run 'leg'"):
        load("run")("leg")
    with pytest.raises(InvalidValueError, match="there is no figure 'nonsense'"):
        load("run")("leg-b", duration=0.1).figures["nonsense"]


def test_a_robot_of_ones_own_makes_the_step():
    result = load("run")(load("SCARA"), q0=[30, 90, -120, 0.05], duration=0.2)
    assert result.summary["max_position_error_m"] < 1e-9
    assert result.title == "SCARA arm: the step"


def test_a_simulation_shows_its_scopes():
    diagram = load("build_pendulum")(load("PendulumConfig")(robot=load("PENDULUM")))
    html = load("simulate")(diagram, duration=0.1)._repr_html_()
    assert "<td>energy</td>" in html


@pytest.mark.parametrize("inline", [pytest.param(False, marks=pytest.mark.slow), True])
def test_a_diagram_and_every_figure_show_themselves_once_in_a_notebook(inline):
    script = (
        "from IPython.core.interactiveshell import InteractiveShell\n"
        "from IPython.core.pylabtools import select_figure_formats\n"
        "shell = InteractiveShell.instance()\n"
        "import drake_leg as dl\n"
        "diagram = dl.build_pendulum(dl.PendulumConfig(robot=dl.PENDULUM))\n"
        "data, _ = shell.display_formatter.format(diagram)\n"
        "assert data['image/svg+xml'].startswith('<svg'), data.keys()\n"
        f"if {inline}: select_figure_formats(shell, {{'png'}})\n"
        "import matplotlib.pyplot as plt\n"
        "step = dl.run('pendulum', duration=0.1).figures\n"
        "for figure in (dl.frames_drawing(dl.LEG_B), *step.values()):\n"
        "    data, _ = shell.display_formatter.format(figure)\n"
        "    assert [kind for kind in data if kind != 'text/plain'] == ['image/png'], data.keys()\n"
        "    assert plt.get_fignums() == []\n"
        "print(len(step), 'shown')\n"
    )
    command = [sys.executable, "-c", script]
    shown = subprocess.run(command, check=True, capture_output=True, text=True, cwd=ROOT).stdout
    assert re.search(r"^[1-9]\d* shown$", shown, re.MULTILINE)


@pytest.mark.parametrize(
    ("name", "start"),
    [
        ("HexabotLegConfig", "hip 90°, knee -50°, ankle -90°"),
        ("EllipseConfig", "hip 90°, knee -50°, ankle -90°"),
        ("ScaraConfig", "shoulder 30°, elbow 90°, wrist -120°"),
        ("PendulumConfig", "pivot 0°"),
    ],
)
def test_a_configuration_shows_its_settings(name, start):
    config = load(name)()
    html = config._repr_html_()
    assert f"<td>{start}</td>" in html
    assert f"<td>{config.robot.title} ({config.robot.name})</td>" in html
    assert "<td>9.80665 m/s²</td>" in html
    assert html.count("<tr>") == len(dataclasses.fields(config)) + 1


def test_what_is_computed_is_written_in_a_line():
    leg = load("LEG_B")
    result = load("run")("leg-b", duration=0.1)
    diagram = load("build_pendulum")(load("PendulumConfig")())
    simulated = load("simulate")(diagram, duration=0.1)
    posture = load("examine_posture")(leg, [0.0, 0.1, 0.2])
    proof = load("prove")(leg, samples=2)
    for what in (leg, result, result.recording, simulated, posture, proof):
        assert repr(what) == str(what)
        assert repr(what).startswith(f"<{type(what).__name__}")
        assert len(repr(what)) < 80
        assert "\n" not in repr(what)


@pytest.mark.parametrize("path", sorted((ROOT / "notebooks").glob("*.ipynb")), ids=lambda p: p.stem)
def test_a_notebook_has_few_imports(path):
    cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
    code = "\n".join("".join(c["source"]) for c in cells if c["cell_type"] == "code")
    lines = re.findall(r"^\s*(?:from|import) drake_leg.*", code, flags=re.MULTILINE)
    assert len(lines) <= MOST_IMPORTS, "\n".join(lines)


def test_the_report_is_made_in_one_call(tmp_path, monkeypatch):
    """The page itself is the subject of tests/lab/page."""

    def write_report(folder, progress):
        (folder / "report.html").write_bytes(b" " * 2_000_000)
        progress(1)
        return ()

    monkeypatch.setattr("drake_leg.lab.page.page.write_report", write_report)
    made = load("report")(tmp_path / "report")
    assert made.failures == ()
    assert made.page == tmp_path / "report" / "report.html"
    assert made.page.stat().st_size > 1e6
    assert str(made.page) in made._repr_html_()


TAKE_A_ROBOT = ("build_plant", "derive", "examine_posture", "frames_drawing", "movable", "prove")


@pytest.mark.parametrize("name", TAKE_A_ROBOT)
def test_the_name_of_a_robot_is_no_robot(name):
    more = ([0.0, 0.0, 0.0],) if name == "examine_posture" else ()
    with pytest.raises(InvalidValueError, match=r"'leg-b' is not a Robot: take one .* load_robot"):
        getattr(drake_leg, name)("leg-b", *more)


@pytest.mark.parametrize("name", ["replay", "still", "view", "write_video"])
def test_the_name_of_a_robot_is_not_shown(name, tmp_path):
    arguments = {"replay": ("leg-b", 3), "write_video": (tmp_path / "a.gif", "leg-b", 3)}
    with pytest.raises(InvalidValueError, match=r"no model file 'leg-b': give a Robot, .*LEG_B"):
        getattr(drake_leg, name)(*arguments.get(name, ("leg-b",)))


WRONG_ARGUMENTS = [
    ("derive", (15,), {}, "the equation wanted is 15, which is not a text: write .* such as '15'"),
    ("derive", (["1.5"],), {}, r"the equation wanted is \['1.5'\], which is not a text"),
    ("derive", ("frame 2",), {}, "no equation 'frame 2'; did you mean 'frame 2 in frame 1'"),
    ("derive", ("jacobin by both",), {}, "did you mean 'Jacobian by both methods'"),
    ("derive", ("9.9",), {}, "there are 'frame 1 in frame 0', 'frame 2 in frame 1'"),
    ("derive", (), {"budget": "x"}, "the budget is 'x'; it must be a number"),
    ("derive", (), {"budget": -1.0}, "the budget is -1.0 s; it must be a positive number"),
    ("prove", (), {"budget": 10**400}, "the budget is an integer too large for a float; it must"),
    ("prove", (), {"progress": 3}, "progress is 3; it must be a function"),
    ("prove", (), {"samples": 10**5000}, "samples is an integer too large for a float; it must"),
    ("prove", (), {"samples": "3"}, "samples is '3'; it must be a whole number, 1 to 10000"),
    ("prove", (), {"samples": 2.5}, "samples is 2.5; it must be a whole number"),
    ("prove", (), {"samples": True}, "samples is True; it must be a whole number"),
    ("prove", (), {"samples": 0}, "samples is 0; it must be a whole number, 1 to"),
    ("prove", (), {"seed": None}, "the seed is None; it must be a whole number, at least 0"),
    ("prove", (), {"budget": None}, "the budget is None; it must be a number"),
    ("build_plant", (), {"gravity": 10**400}, "gravity is an integer too large for a float; it"),
    ("build_plant", (), {"gravity": "9.81"}, "gravity is '9.81'; it must be a number"),
    ("build_plant", (), {"gravity": [0, 0, -9.81]}, "gravity is .*; it must be a number"),
    ("build_plant", (), {"gravity": -9.81}, "gravity is -9.81 m/s.2; it must be zero or positive"),
    ("build_plant", (), {"gravity": math.nan}, "gravity is nan m/s.2; it must be zero or positive"),
]


@pytest.mark.parametrize(("name", "arguments", "settings", "sentence"), WRONG_ARGUMENTS)
def test_a_wrong_argument_is_refused_in_a_sentence(name, arguments, settings, sentence):
    with pytest.raises(InvalidValueError, match=sentence):
        load(name)(drake_leg.PENDULUM, *arguments, **settings)


def test_the_block_says_what_it_takes():
    with pytest.raises(InvalidValueError, match=r"not a Robot: pass movable\(robot\)"):
        drake_leg.InverseJacobian(drake_leg.LEG_B)
