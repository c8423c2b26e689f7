"""``drake-leg inspect``, in process, and through a pipe."""

import json
import subprocess
import sys

import pytest
from cad_files import open_cascade, write
from slx_models import published_leg, published_pendulum
from slx_writer import ModelBuilder, mask_text

from drake_leg.cli import main


@pytest.fixture
def leg(tmp_path):
    return published_leg().write(tmp_path / "leg.slx")


def inspected(capsys, *words):
    """Return the status, what is printed, and what is complained of."""
    status = main(["inspect", *map(str, words)])
    out, err = capsys.readouterr()
    return status, out, err


def test_the_table_of_the_leg(capsys, leg):
    status, out, err = inspected(capsys, leg, "--blocks")
    assert (status, err) == (0, "")
    lines = [" ".join(line.split()) for line in out.splitlines()]
    assert lines[0] == "leg: 50 blocks"
    assert lines[2] == "SID block kind settings that are not the default, in SI"
    for line in (
        "6 Brick Solid0 Brick Solid BrickDimensions [0.05 0.001 0.001] m",
        "16 Spherical Solid Spherical Solid SphereRadius 0.003 m",
        "17 Sine Wave Sin Amplitude 70",
        "24 Integrator1 Integrator",
        "28 wires",
        "Sine Wave (1) -> Mux (4) dx",
        "24 physical connections",
        "Revolute Joint (rconn 1) - Rigid Transform0 (lconn 1)",
        "code of MATLAB Function (SID 21)",
        "function y = jacob_inv(u)",
    ):
        assert line in lines
    assert "StopTime 20" in out
    assert max(map(len, out.splitlines())) <= 100


def test_columns_are_aligned(capsys, leg):
    _, out, _ = inspected(capsys, leg, "--blocks")
    rows = out.splitlines()[2:]
    place = rows[0].index("kind")
    for row in rows[: rows.index("")]:
        assert row[place - 1] == " "


def test_json_has_exactly_these_keys(capsys, leg):
    status, out, _ = inspected(capsys, leg, "--json")
    content = json.loads(out)
    assert status == 0
    keys = "blocks wires nodes functions solver variables skipped init lacks"
    assert list(content) == keys.split()
    assert set(content["blocks"][0]) == {"sid", "name", "type", "source", "system", "parameters"}
    assert set(content["wires"][0]) == {"from", "to", "name"}
    assert set(content["functions"][0]) == {"sid", "name", "script"}
    assert content["wires"][0] == {"from": "17#out:1", "to": "20#in:4", "name": "dx"}
    assert ["4#rconn:1", "5#lconn:1"] in content["nodes"]
    brick = content["blocks"][5]["parameters"]
    assert (brick["BrickDimensions"], brick["BrickDimensionsUnits"]) == ([0.05, 0.001, 0.001], "m")
    assert content["solver"]["StopTime"] == 20.0


def test_infinite_values_in_json(capsys, tmp_path):
    builder = ModelBuilder(solver={"StopTime": "inf"})
    builder.add_block("Integrator", "I")
    status, out, _ = inspected(capsys, builder.write(tmp_path / "m.slx"), "--json")
    content = json.loads(out)
    assert status == 0
    assert content["solver"]["StopTime"] == "inf"
    assert content["blocks"][0]["parameters"]["LowerSaturationLimit"] == "-inf"


def test_subsystems_name_the_path(capsys, tmp_path):
    builder = ModelBuilder()
    thigh = builder.add_block("SubSystem", "Thigh\nlink")
    builder.add_block("Gain", "K", {"Gain": "[1 2;3 4]"}, system=thigh)
    _, out, _ = inspected(capsys, builder.write(tmp_path / "m.slx"), "--blocks")
    assert "2    Thigh link/K  Gain       Gain [1 2; 3 4]\n" in out


def test_masks_show_their_parameters(capsys, tmp_path):
    builder = ModelBuilder()
    thigh = builder.add_block("SubSystem", "Thigh")
    builder.blocks[thigh].mask = mask_text({"L": "100", "w": "[1 2]", "file": "'leg.stl'"})
    builder.add_block("Gain", "K", {"Gain": "L/4"}, system=thigh)
    path = builder.write(tmp_path / "m.slx")
    _, out, _ = inspected(capsys, path, "--blocks")
    lines = [" ".join(line.split()) for line in out.splitlines()]
    assert "1 Thigh SubSystem L 100, w [1 2], file 'leg.stl'" in lines
    assert "2 Thigh/K Gain Gain 25" in lines
    _, out, _ = inspected(capsys, path, "--json")
    assert json.loads(out)["blocks"][0]["parameters"]["L"] == 100.0


def test_control_signs_are_not_sent_to_the_terminal(capsys, tmp_path):
    builder = ModelBuilder()
    builder.add_block("Gain", "K\u202e\u009b2J\x7f", {"Gain": "2"})
    _, out, _ = inspected(capsys, builder.write(tmp_path / "m.slx"), "--blocks")
    assert "K\\x202e\\x9b2J\\x7f" in out


def test_an_empty_model(capsys, tmp_path):
    status, out, _ = inspected(capsys, ModelBuilder().write(tmp_path / "m.slx"))
    assert status == 0
    assert out.startswith("m: 0 blocks, 0 wires")


def test_what_is_not_understood_is_listed(capsys, tmp_path):
    builder = published_pendulum({"DampingCoefficient": "b"})
    builder.add_library("my_lib/Leg", "Leg 1")
    path = builder.write(tmp_path / "m.slx")
    status, out, _ = inspected(capsys, path)
    assert status == 0
    assert "not understood: 2\n" in out
    assert "my_lib/Leg  'Leg 1'\n" in out
    assert "  b     'Revolute Joint' DampingCoefficient\n" in out
    _, out, _ = inspected(capsys, path, "--json")
    found = json.loads(out)
    joint = next(block for block in found["blocks"] if block["name"] == "Revolute Joint")
    assert joint["parameters"]["DampingCoefficient"] is None
    lacks = {(lack["sid"], lack["parameter"], lack["text"]) for lack in found["lacks"]}
    assert (joint["sid"], "DampingCoefficient", "b") in lacks


@pytest.fixture
def lacking(tmp_path):
    """Write a pendulum without its damping and length, and a script that sets them."""
    (tmp_path / "numbers.m").write_text("b = 0.01; system('ls');\nL = 0.3;")
    builder = published_pendulum({"DampingCoefficient": "b"})
    builder.add_block("Gain", "K", {"Gain": "L*k"})
    return builder.write(tmp_path / "m.slx")


def test_what_is_missing_is_asked_for_with_the_script_that_sets_it(capsys, lacking):
    _, out, _ = inspected(capsys, lacking)
    flowing = " ".join(out.split())
    assert "names without a value (3)" in flowing
    script = lacking.with_name("numbers.m")
    assert f"perhaps --init {script} which sets b, L; or give each name a value: --set" in flowing
    _, out, _ = inspected(capsys, lacking, "--json")
    assert json.loads(out)["init"] == {
        "file": str(script),
        "names": ["b", "L"],
        "others": [],
    }


def test_a_value_that_is_neither_known_nor_used_is_null(capsys, tmp_path):
    model = ModelBuilder()
    unused = {"RotationMethod": "None", "RotationAngle": "unknown_angle"}
    model.add_library("sm_lib/Frames and Transforms/Rigid Transform", "Shift", unused)
    choice = {
        "inertia": "2",
        "num_ports": "foundation.enum.numPorts2.one",
        "inertia_unit": "kg*m^2",
    }
    choice["num_ports_unit"] = "1"
    model.add_library("fl_lib/Mechanical/Rotational Elements/Inertia", "Rotor", choice)
    status, out, _ = inspected(capsys, model.write(tmp_path / "model.slx"), "--json")
    assert status == 0
    found = json.loads(out)
    shift, rotor = (block["parameters"] for block in found["blocks"])
    assert shift["RotationAngle"] is None
    assert rotor["num_ports"] == "foundation.enum.numPorts2.one"
    assert not found["lacks"]


def test_values_come_from_scripts_and_options(capsys, lacking):
    script = lacking.with_name("numbers.m")
    status, out, _ = inspected(capsys, lacking, "--init", script, "--set", "k=2*pi,L=[1,2]")
    assert status == 0
    flowing = " ".join(out.split())
    assert "everything is understood as data; whether it runs, `drake-leg run` tells" in flowing
    assert "values set by hand (2), numbers.m (1)" in flowing
    assert "skipped system (a script reaches neither the system nor files here), line 1" in flowing
    _, out, _ = inspected(capsys, lacking, "--init", script, "--set", "k=2", "--json")
    content = json.loads(out)
    assert content["variables"] == {
        "b": "numbers.m, line 1",
        "L": "numbers.m, line 2",
        "k": "set by hand",
    }
    assert content["init"] is None


@pytest.mark.parametrize(
    ("words", "reason"),
    [
        (["--set", "k"], "--set k gives no value: write it as L1=0.05"),
        (["--set", "k=1/"], "the value of k is '1/': it ends too early"),
        (["--init", "absent.m"], "there is no file absent.m"),
        (["--init", "m.txt"], "m.txt is neither a script (.m, .mlx) nor a .mat file, nor a model"),
        (["--init", "m.slx"], "there is no file m.slx"),
    ],
)
def test_what_is_given_wrongly_is_refused(capsys, lacking, words, reason):
    status, _, err = inspected(capsys, lacking, *words)
    assert status == 2
    assert reason in err


def test_a_summary_counts_the_kinds_of_blocks(capsys, leg):
    _, out, _ = inspected(capsys, leg)
    flowing = " ".join(out.split())
    assert flowing.startswith(
        "leg: 50 blocks, 28 wires, 24 physical connections, 1 MATLAB function"
    )
    assert "PS-Simulink Converter 10, Rigid Transform" in flowing
    assert "everything is understood" in flowing


@pytest.mark.slow
@pytest.mark.parametrize("encoding", ["ascii", "utf-8"])
def test_names_in_any_script_on_any_terminal(tmp_path, encoding):
    builder = ModelBuilder()
    builder.add_block("Gain", "脚 θ")
    path = builder.write(tmp_path / "m.slx")
    done = subprocess.run(
        [sys.executable, "-m", "drake_leg", "inspect", path, "--blocks"],
        capture_output=True,
        env={"PYTHONIOENCODING": encoding},
        check=True,
    )
    expected = "脚 θ" if encoding == "utf-8" else "\\u811a \\u03b8"
    assert expected in done.stdout.decode(encoding)
    assert done.stderr == b""


@pytest.mark.slow
@pytest.mark.parametrize("words", [[], ["--blocks"], ["--json"]])
def test_a_closed_pipe_is_no_traceback(leg, words):
    command = [sys.executable, "-m", "drake_leg", "inspect", str(leg), *words]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        process.stdout.close()
        assert b"Traceback" not in process.stderr.read()
        assert process.wait() == 0


@pytest.mark.slow
def test_a_step_file_lists_its_features(capsys, tmp_path):
    open_cascade()
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox

    path = write(tmp_path / "box.step", BRepPrimAPI_MakeBox(10.0, 20.0, 30.0).Shape())
    status, out, err = inspected(capsys, path)
    lines = out.splitlines()
    assert (status, err) == (0, "")
    assert {"planar surfaces (6)", "segments (12)", "points (8)"} < set(lines)
    assert "  0.01,0.01,0.015,1,0,0  area 600 mm²" in lines
    assert lines[-1].startswith("--feature 'box.step:planar surface 1=")
    for option in ("--json", "--blocks", "--set=a=1", "--init=a.m"):
        status, out, err = inspected(capsys, path, option)
        assert (status, out) == (2, "")
        assert f"{option.split('=')[0]} is for Simulink models and means nothing here" in err
    path.write_text("no STEP")
    _, _, err = inspected(capsys, path)
    assert err == f"drake-leg: {path} is a file which is damaged\n"
    _, _, err = inspected(capsys, tmp_path / "none.step")
    assert "none.step is a file which cannot be read" in err
