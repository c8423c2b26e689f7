import io
import json
import math
import re
import subprocess
import sys
from importlib.metadata import version
from pathlib import Path

import numpy as np
import pytest

from drake_leg import cli
from drake_leg.cli.terminal import as_options
from drake_leg.files import LIST
from drake_leg.progress import ProgressBar
from drake_leg.runs.catalogue import RUNS
from drake_leg.simulation.recording import Recording

COMMON = {
    "robot", "duration_s", "stopped_at_s", "stop_reason", "rows", "real_time_factor",
}  # fmt: skip
LEG = COMMON | {
    "stroke_m", "max_position_error_m", "max_off_axis_m", "max_velocity_error_m_s", "sigma_min_m",
    "det_j_min_m3", "det_j_max_m3", "max_rate_rad_s", "max_static_torque_n_m",
}  # fmt: skip
PENDULUM = COMMON | {
    "period_s", "exact_period_s", "energy_drift", "rest_angle_rad", "exact_rest_angle_rad",
}  # fmt: skip
KEYS = {
    "leg-a": LEG, "leg-b": LEG, "ellipse": LEG, "pendulum": PENDULUM, "pendulum-damped": PENDULUM,
    "pendulum-spring": PENDULUM, "scara": COMMON | {"stroke_m", "det_j_min_m2", "det_j_max_m2"},
    "hexapod": COMMON | {
        "commanded_distance_m", "distance_m", "distance_error_percent", "heading_error_deg",
        "greatest_roll_error_deg", "greatest_pitch_error_deg", "height_ripple_m", "greatest_slip_m",
        "mean_slip_m", "least_static_margin_m", "least_dynamic_margin_m", "peak_torque_n_m",
        "rms_torque_n_m", "mechanical_cost_of_transport", "electrical_cost_of_transport",
        "moving_mechanical_cost_of_transport", "moving_electrical_cost_of_transport",
        "clearance_m", "greatest_contact_force_n", "touch_downs_on_time", "touch_downs_early",
        "touch_downs_late", "touch_downs_not_found", "changes", "fell",
        "fell_at_s",
    },
}  # fmt: skip
DURATIONS = {"pendulum": 2.5, "pendulum-damped": 2.0, "pendulum-spring": 2.0}


def status_of(*words):
    try:
        return cli.main([str(word) for word in words])
    except SystemExit as stop:
        return stop.code


@pytest.fixture
def no_figures(monkeypatch):
    monkeypatch.setattr("drake_leg.runs.figures.figures_of_run", lambda *arguments: ())


@pytest.fixture
def run(no_figures, tmp_path, capsys):
    """Carry out a run without its pictures; its status, recording and summary."""

    def carried_out(name, *words, out="out"):
        status = status_of("run", name, "--out", tmp_path / out, *words)
        capsys.readouterr()
        return (
            status,
            Recording.read_csv(tmp_path / out / "recording.csv"),
            json.loads((tmp_path / out / "summary.json").read_text(encoding="utf-8")),
        )

    return carried_out


# --- list and help ---------------------------------------------------------------------------


def test_list_names_every_run_and_the_figures_that_it_reproduces(capsys):
    assert status_of("list") == 0
    printed = capsys.readouterr()
    lines = printed.out.splitlines()
    assert [line.split()[0] for line in lines] == list(RUNS)
    for line, kind in zip(lines, RUNS.values(), strict=True):
        assert kind.title in line
        assert kind.shows in line
    assert printed.err == ""


def test_the_help_of_the_program_names_its_commands_and_exit_statuses(capsys):
    assert status_of("--help") == 0
    text = capsys.readouterr().out
    for word in ("list", "run", "report", "Exit status", "130"):
        assert word in text


def test_the_help_of_the_program_tells_of_units_and_defaults(capsys):
    status_of("--help")
    text = capsys.readouterr().out
    assert "unit" in text
    assert "default" in text


def test_the_version_is_the_installed_one(capsys):
    assert status_of("--version") == 0
    printed = capsys.readouterr()
    assert (printed.out, printed.err) == (f"drake-leg {version('drake-leg')}\n", "")


def test_the_help_of_run_gives_every_option_with_its_unit_and_default(capsys):
    assert status_of("run", "--help") == 0
    text = " ".join(capsys.readouterr().out.split())
    for kind in RUNS.values():
        for field in kind.options.__dataclass_fields__.values():
            assert f"--{field.name.replace('_', '-')} " in text
            if field.metadata["unit"]:
                assert f"[{field.metadata['unit']}]" in text
    for shown in ("0.07", "9.80665", "90,-50,-90", "runge_kutta5", "0.4,0.01,0.01", "default"):
        assert shown in text
    for unit in ("[m/s]", "[rad/s]", "[deg]", "[kg/m^3]", "N*m/rad", "[s]"):
        assert unit in text
    assert "pendulum: 10; pendulum-damped, pendulum-spring: 30" in text


@pytest.mark.parametrize("words", [["list", "--help"], ["report", "--help"], ["run", "-h"]])
def test_every_command_has_a_help(capsys, words):
    assert status_of(*words) == 0
    assert capsys.readouterr().out.startswith(f"usage: drake-leg {words[0]}")


# --- runs with all their files ---------------------------------------------------------------


@pytest.fixture(scope="module", params=RUNS)
def carried_out(request, tmp_path_factory):
    """Every run once, without its pictures: name and folder."""
    name = request.param
    out = tmp_path_factory.mktemp("runs") / "new" / name
    words = ("run", name, "--out", out, "--duration", DURATIONS.get(name, 1.0))
    assert status_of(*words, "--figures", "none") == 0
    return name, out


PICTURED = [
    pytest.param(name, marks=() if name == "pendulum" else pytest.mark.slow) for name in RUNS
]


@pytest.mark.parametrize("name", PICTURED)
def test_a_run_leaves_a_recording_a_summary_and_pictures(name, tmp_path):
    out = tmp_path / "new" / name
    words = ("run", name, "--out", out, "--duration", DURATIONS.get(name, 1.0))
    assert status_of(*words, "--figures", "all") == 0
    names = {path.name for path in out.iterdir()}
    data = {LIST, "recording.csv", "summary.json"}
    pictures = {name for name in names if name.endswith((".png", ".svg", ".pdf"))}
    assert pictures | data == names
    listed = set((out / LIST).read_text(encoding="utf-8").splitlines()[1:])
    assert listed == names - {LIST}
    assert len(pictures) >= 6
    stems = {Path(picture).stem for picture in pictures}
    assert pictures == {f"{stem}.{ending}" for stem in stems for ending in ("png", "svg", "pdf")}
    assert [path.name for path in out.parent.iterdir()] == [name]


def test_the_summary_has_its_keys_and_no_unit_is_missing(carried_out):
    name, out = carried_out
    summary = json.loads((out / "summary.json").read_text(encoding="utf-8"))
    assert set(summary) >= KEYS[name]
    assert summary["duration_s"] == DURATIONS.get(name, 1.0)
    assert summary["stopped_at_s"] is None
    assert summary["stop_reason"] is None
    assert summary["real_time_factor"] > 0.0


def test_the_recording_can_be_read_and_is_finite_and_fine_enough(carried_out):
    name, out = carried_out
    recording = Recording.read_csv(out / "recording.csv")
    time = recording["time"]
    assert time[0] == 0.0
    assert time[-1] == DURATIONS.get(name, 1.0)
    assert np.diff(time).max() <= 0.04 + 1e-12
    assert all(np.isfinite(column).all() for column in recording.columns.values())
    without = re.compile(r"(planned_)?q[wxyz]|.*_(down|loaded)")  # a unit
    assert all("[" in header or without.fullmatch(header) for header in recording.columns)


def test_a_run_prints_one_line_of_what_it_wrote(no_figures, tmp_path, capsys):
    assert status_of("run", "leg-b", "--out", tmp_path / "out", "--duration", 0.2) == 0
    printed = capsys.readouterr()
    assert printed.err == ""
    (line,) = printed.out.splitlines()
    assert line.startswith(f"wrote {tmp_path / 'out'}: 6 rows")
    assert "of the exact path" in line


@pytest.mark.slow
def test_two_runs_write_the_same_bytes(tmp_path, capsys):
    for out in ("first", "second"):
        assert status_of("run", "leg-b", "--out", tmp_path / out, "--duration", 2.0) == 0
    names = {path.name for path in (tmp_path / "first").iterdir()}
    assert names == {path.name for path in (tmp_path / "second").iterdir()}
    for name in names - {"summary.json"}:
        pair = [(tmp_path / out / name).read_bytes() for out in ("first", "second")]
        assert pair[0] == pair[1], name
    first, second = (
        json.loads((tmp_path / out / "summary.json").read_text(encoding="utf-8"))
        for out in ("first", "second")
    )
    assert first.pop("real_time_factor") > 0.0
    assert second.pop("real_time_factor") > 0.0
    assert first == second


# --- options ---------------------------------------------------------------------------------


def test_a_negative_angle_may_follow_its_option_with_a_space_or_with_an_equals_sign(run):
    _, spaced, _ = run("leg-a", "--q0", "-90,50,90", "--duration", "0.2", out="a")
    _, joined, _ = run("leg-a", "--q0=-90,50,90", "--duration", "0.2", out="b")
    assert spaced["q1"][0] == pytest.approx(-math.pi / 2)
    for header, values in spaced.columns.items():
        np.testing.assert_array_equal(values, joined.columns[header])


@pytest.mark.parametrize(
    ("words", "column", "first"),
    [
        (["pendulum", "--q0", "-.5"], "q", math.radians(-0.5)),
        (["pendulum", "--q0=-5e-1"], "q", math.radians(-0.5)),
        (["pendulum-damped", "--target", "-10"], "q", math.radians(-10)),
        (["pendulum-damped"], "q", math.radians(30)),
        (["leg-b", "--l1", "0.06"], "y", 0.06 + 0.1 * (math.cos(0.87266462599716477)
                                                      - math.cos(math.radians(40)))),
        (["scara", "--tool-height", "0.1"], "z", 0.44),
    ],
)  # fmt: skip
def test_options_act(run, words, column, first):
    status, recording, _ = run(*words, "--duration", "0.1")
    assert status == 0
    assert recording[column][0] == pytest.approx(first, abs=1e-12)


def test_the_direction_and_the_amplitude_act(run):
    _, recording, summary = run(
        "leg-b", "--direction", "0,0,2", "--amplitude", "-0.02", "--duration", "1"
    )
    lowered = recording["z"][0] - 0.02 * (1 - math.cos(1.0))
    assert recording["z"][-1] == pytest.approx(lowered, abs=1e-9)
    assert summary["stroke_m"] == pytest.approx(0.02 * (1 - math.cos(1.0)), abs=1e-9)


def test_the_unit_of_the_damping_acts(run):
    words = ["pendulum-damped", "--duration", "0.5", "--damping"]
    _, si, _ = run(*words, repr(0.001 * 180 / math.pi), out="a")
    _, simscape, _ = run(*words, "0.001", "--damping-unit", "N*m/(deg/s)", out="b")
    np.testing.assert_allclose(si["q"], simscape["q"], atol=1e-13)


def test_the_integrator_the_accuracy_and_the_step_act(run):
    _, recording, summary = run(
        "leg-b", "--integrator", "runge_kutta3", "--accuracy", "1e-5", "--max-step", "0.01",
        "--duration", "0.2",
    )  # fmt: skip
    assert summary["integrator"] == "runge_kutta3"
    assert summary["accuracy"] == 1e-5
    assert summary["max_step_s"] == 0.01
    assert np.diff(recording["time"]).max() <= 0.01 + 1e-12


# --- the config file -------------------------------------------------------------------------


@pytest.fixture
def config(tmp_path):
    def written(text):
        path = tmp_path / "config.yaml"
        path.write_text(text, encoding="utf-8")
        return path

    return written


def test_a_config_file_holds_the_options_with_underscores(run, config):
    file = config(
        "duration: 0.3\nq0: [-90, 50, 90]\nmax_step: 0.01\ndamping: 0.002\n"
        "damping_unit: N*m/(deg/s)\nintegrator: radau3\ngain: 2\n"
    )
    status, recording, summary = run("leg-a", "--config", file)
    assert status == 0
    assert summary["duration_s"] == recording["time"][-1] == 0.3
    assert summary["integrator"] == "radau3"
    assert summary["max_step_s"] == 0.01
    assert recording["q1"][0] == pytest.approx(-math.pi / 2)
    np.testing.assert_allclose(recording["dx"], 2 * recording["input"])


@pytest.mark.parametrize("line", ["--duration=0.2", "--duration 0.2"])
def test_the_command_line_wins_over_the_config_file(run, config, line):
    file = config("duration: 0.1\namplitude: 0.01\n")
    _, recording, summary = run("leg-b", *line.split(), "--config", file)
    assert summary["duration_s"] == 0.2
    assert recording["dx"].max() == pytest.approx(0.01 * math.sin(0.2))


def test_an_option_that_may_be_none_may_be_null(run, config):
    _, _, summary = run("pendulum-damped", "--config", config("target: null\nduration: 0.1\n"))
    assert summary["q0_rad"] == pytest.approx(math.radians(30))


def test_numbers_in_exponential_form_are_numbers(run, config):
    _, _, summary = run("leg-b", "--config", config("duration: 1e-1\naccuracy: 1e-6\n"))
    assert summary["duration_s"] == 0.1
    assert summary["accuracy"] == 1e-6


def test_a_pendulums_only_angle_may_stand_without_brackets(run, config):
    """As on the command line: --q0 45."""
    status, recording, _ = run("pendulum", "--config", config("q0: 45\nduration: 0.1\n"))
    assert status == 0
    assert recording["q"][0] == pytest.approx(math.pi / 4)


BAD_CONFIGS = [
    ("speed: 3\n", "speed"),
    ("lift: 0.01\n", "lift"),  # the ellipse's
    ("damping-unit: N*m*s/rad\n", "damping-unit"),
    ("duration: .nan\n", "nan"),
    ("q0: [.nan, 0, 0]\n", "nan"),
    ("duration: .inf\n", "inf"),
    ("duration: abc\n", "abc"),
    ("duration: true\n", "duration"),
    ("duration: null\n", "duration"),
    ("duration: [0.1]\n", "duration"),
    ("integrator: 5\n", "integrator"),
    ("amplitude: [1, 2]\n", "amplitude is [1, 2]"),
    ("max_step: {a: 1}\n", "max_step is"),
    ("accuracy: yes\n", "accuracy is 'yes'"),
    ("force: 3\n", "force is 3"),
    ("q0: [90, [1], 0]\n", "q0 is [1]"),
    ("direction: x\n", "direction is 'x'"),
    ("q0: [1, 2]\n", "[1.0, 2.0]"),
    ("q0: [90, x, 0]\n", "x"),
    ("q0: '123'\n", "123"),
    ("- 1\n", "config.yaml"),
    ("just words\n", "config.yaml"),
    ("{unclosed: [\n", "config.yaml"),
    ("\tduration: 1\n", "config.yaml"),
    ("duration: 1\n---\nduration: 2\n", "config.yaml"),
    ("1: 2\n", "1"),
    ("on: yes\n", "config.yaml"),
    ("[" * 2000, "config.yaml"),
    ("!!python/object/apply:os.getcwd []\n", "config.yaml"),
]


@pytest.mark.parametrize(("text", "named"), BAD_CONFIGS, ids=[repr(t[:30]) for t, _ in BAD_CONFIGS])
def test_a_bad_config_file_is_refused(refused, config, text, named):
    refused("leg-b", "--config", config(text), named=named)


@pytest.mark.parametrize("text", ["", "1: 2\n", "on: yes\n", "null\n"])
def test_what_is_wrong_with_a_config_file_is_said_in_words_for_a_person(
    config, tmp_path, text, capsys
):
    words = ["run", "leg-b", "--out", tmp_path / "out", "--config", config(text)]
    assert status_of(*words) == 2
    sentence = capsys.readouterr().err
    for jargon in ("has no attribute", "PathLike", "NoneType", "<class"):
        assert jargon not in sentence


def test_a_config_file_of_bytes_is_refused(refused, tmp_path):
    (tmp_path / "config.yaml").write_bytes(b"\xff\xfe\x00")
    refused("leg-b", "--config", tmp_path / "config.yaml", named="config.yaml")


# --- bad input -------------------------------------------------------------------------------


@pytest.fixture
def refused(no_figures, tmp_path, capsys):
    """See that words are refused: status 2, one sentence that names the value, nothing written."""

    def see(name, *words, named, out="new/out", status=2):
        before = sorted(tmp_path.rglob("*"))
        assert status_of("run", name, "--out", tmp_path / out, *words) == status
        printed = capsys.readouterr()
        assert printed.out == ""
        (sentence,) = printed.err.splitlines()
        assert sentence.startswith("drake-leg")
        assert named in sentence
        assert "Traceback" not in sentence
        assert sorted(tmp_path.rglob("*")) == before

    return see


BAD_INPUT = [
    (["leg-c"], "'leg-c'"),
    ([""], "''"),
    (["leg-b", "--damping-unit", "Nm/s2"], "'Nm/s2'"),
    (["leg-b", "--q0", "90,-50"], "[90.0, -50.0]"),
    (["leg-b", "--q0", "1,2,3,4"], "4.0]"),
    (["leg-b", "--q0", "90,x,0"], "'x'"),
    (["leg-b", "--q0", ""], "--q0 is empty"),
    (["leg-b", "--q0", "nan,0,0"], "nan"),
    (["leg-b", "--q0", "-inf,0,0"], "inf"),
    (["leg-b", "--l1", "-0.05"], "-0.05"),
    (["leg-b", "--l2", "0"], "0"),
    (["leg-b", "--l3", "nan"], "nan"),
    (["leg-b", "--density", "-1"], "-1"),
    (["leg-b", "--duration", "-5"], "-5"),
    (["leg-b", "--duration", "0"], "0"),
    (["leg-b", "--duration", "nan"], "nan"),
    (["leg-b", "--duration", "-inf"], "inf"),
    (["leg-b", "--duration", "1e9"], "1e+09 s"),
    (["leg-b", "--duration", "1,2"], "'1,2'"),
    (["leg-b", "--duration", "ten"], "'ten'"),
    (["leg-b", "--amplitude", "inf"], "inf"),
    (["leg-b", "--frequency", "-1"], "-1"),
    (["leg-b", "--direction", "0,0,0"], "[0.0, 0.0, 0.0]"),
    (["leg-b", "--direction", "1,0"], "[1.0, 0.0]"),
    (["leg-b", "--gain", "0"], "0"),
    (["leg-b", "--gravity", "-9.81"], "-9.81"),
    (["leg-b", "--damping", "-1"], "-1"),
    (["leg-b", "--integrator", "RK5"], "'RK5'"),
    (["leg-b", "--integrator", "explicit_euler", "--accuracy", "1e-3"], "explicit_euler"),
    (["leg-b", "--accuracy", "1"], "1"),
    (["leg-b", "--max-step", "0.1"], "0.1"),
    (["leg-b", "--lift", "0.1"], "--lift"),
    (["leg-b", "--colour", "red"], "--colour"),
    (["leg-b", "extra"], "extra"),
    (["leg-b", "--q0"], "--q0"),
    (["ellipse", "--direction", "0,0,1"], "horizontal"),
    (["ellipse", "--lift", "nan"], "nan"),
    (["scara", "--tool-height", "0.2"], "0.2"),
    (["pendulum", "--size", "0.3,0.02"], "[0.3, 0.02]"),
    (["pendulum", "--size", "0.3,-0.02,0.01"], "-0.02"),
    (["pendulum", "--q0", "1,2"], "[1.0, 2.0]"),
    (["pendulum", "--gravity", "-9.81"], "-9.81"),
    (["pendulum-damped", "--target", "40", "--q0", "50"], "40"),
    (["pendulum-spring", "--spring-stiffness", "-5"], "-5"),
    (["pendulum-spring", "--target", "nan"], "nan"),
    (["leg-b", "--config", "no/such/file.yaml"], "file.yaml"),
    (["leg-b", "--config", "."], "config"),
]


@pytest.mark.parametrize(("words", "named"), BAD_INPUT, ids=[" ".join(w) for w, _ in BAD_INPUT])
def test_bad_input_is_refused(refused, words, named):
    refused(*words, named=named)


def test_a_folder_under_a_file_is_refused(refused, tmp_path):
    (tmp_path / "file").write_text("mine", encoding="utf-8")
    refused("pendulum", named="file/out", out="file/out")


def test_an_existing_folder_is_refused_without_overwrite_and_kept(refused, tmp_path):
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "summary.json").write_text("old", encoding="utf-8")
    refused("pendulum", named="--overwrite", out="out")
    assert (tmp_path / "out" / "summary.json").read_text(encoding="utf-8") == "old"


def test_a_folder_of_something_else_is_refused_even_with_overwrite(refused, tmp_path):
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "thesis.tex").write_text("mine", encoding="utf-8")
    refused("pendulum", "--overwrite", named="holds thesis.tex, which is not a result", out="out")


def test_results_are_overwritten_on_request(run, tmp_path):
    run("pendulum", "--duration", "0.1")
    status, _, summary = run("leg-b", "--duration", "0.1", "--overwrite")
    assert status == 0
    assert summary["robot"] == "leg_b"
    assert [path.name for path in tmp_path.iterdir()] == ["out"]


@pytest.mark.parametrize("words", [["fly"], ["run"], ["run", "leg-b"], ["list", "x"]])
def test_an_incomplete_or_unknown_command_is_refused_in_a_sentence(capsys, words):
    assert status_of(*words) == 2
    printed = capsys.readouterr()
    assert printed.out == ""
    assert len(printed.err.splitlines()) == 1
    assert "usage" not in printed.err


# --- stops -----------------------------------------------------------------------------------


def test_a_run_into_a_singularity_exits_with_3_and_saves_its_files(no_figures, tmp_path, capsys):
    out = tmp_path / "out"
    assert status_of("run", "leg-b", "--out", out, "--amplitude", "0.1", "--force") == 3
    printed = capsys.readouterr()
    (sentence,) = printed.err.splitlines()
    assert "stopped at" in sentence
    assert "2.65139" in sentence
    assert "singular" in sentence
    assert printed.out.startswith(f"wrote {out}")
    summary = json.loads((out / "summary.json").read_text(encoding="utf-8"))
    recording = Recording.read_csv(out / "recording.csv")
    assert summary["stopped_at_s"] == recording["time"][-1]
    assert summary["stopped_at_s"] == pytest.approx(2.651398, abs=1e-6)
    assert as_options(summary["stop_reason"]) in sentence
    met, foreseen = summary["singularity"], summary["foreseen"]
    assert met["family"] == foreseen["family"] == "stretch"
    assert met["time_s"] == pytest.approx(foreseen["time_s"], abs=1e-6)
    assert met["foot_m"] == pytest.approx(foreseen["foot_m"], abs=1e-8)
    assert met["q_deg"] == pytest.approx(foreseen["q_deg"], abs=0.05)
    assert met["lost_direction"] == pytest.approx(foreseen["lost_direction"], abs=1e-3)
    assert met["greatest_amplitude_m_s"] == pytest.approx(0.0941120543, abs=1e-9)


def test_a_foreseen_singularity_is_refused_with_its_instant_and_nothing_is_written(refused):
    for words, instant in ((["leg-b", "--amplitude", "0.1"], "2.651397687"),
                           (["leg-a", "--amplitude", "-0.1"], "2.651397687"),
                           (["leg-b", "--amplitude", "1", "--gain", "10", "--frequency", "10"],
                            "0.265139769"),
                           (["ellipse", "--amplitude", "0.1"], "2.809364"),
                           (["scara", "--amplitude", "0.2"], "1.885994036")):  # fmt: skip
        refused(*words, named=instant, status=3)
        refused(*words, named="--force", status=3)


def test_a_damped_run_goes_on_and_says_how_far_it_was(run):
    status, recording, summary = run(
        "leg-b", "--amplitude", "0.1", "--inverse", "damped", "--duration", "7"
    )
    assert status == 0
    assert summary["stop_reason"] is None
    assert 0.008 < summary["greatest_distance_from_command_m"] < 0.009
    assert 1.0 < summary["time_off_command_s"] < 4.0
    assert summary["distance_from_command_at_the_end_m"] < 1e-6
    assert np.abs(recording.stack("qdot1", "qdot2", "qdot3")).max() < 10.0
    assert (recording["q3"] < 0.0).all()  # the knee keeps its side


def test_a_singular_start_exits_with_3_and_writes_nothing(refused):
    refused("leg-b", "--q0", "90,-50,0", named="singular", status=3)


def test_an_interrupt_exits_with_130_and_saves_what_was_recorded(
    no_figures, tmp_path, capsys, monkeypatch
):
    def impatient(self, done):
        if done > 0.5:
            raise KeyboardInterrupt

    monkeypatch.setattr(ProgressBar, "__call__", impatient)
    forward = ("--dynamics", "forward")  # kinematics alone are done all at once
    assert status_of("run", "leg-b", *forward, "--out", tmp_path / "out") == 130
    assert "interrupted" in capsys.readouterr().err
    summary = json.loads((tmp_path / "out" / "summary.json").read_text(encoding="utf-8"))
    assert summary["stop_reason"] == "interrupted"
    assert 0.5 < summary["stopped_at_s"] <= 4.0  # it is looked at every hundred steps
    assert (
        Recording.read_csv(tmp_path / "out" / "recording.csv")["time"][-1]
        == summary["stopped_at_s"]
    )


@pytest.mark.parametrize(
    ("error", "status"), [(KeyboardInterrupt, 130), (OSError(28, "No space left on device"), 2)]
)
@pytest.mark.parametrize("existing", [True, False])
def test_a_failure_while_writing_keeps_the_old_folder_and_leaves_nothing_half_written(
    run, tmp_path, capsys, monkeypatch, error, status, existing
):
    if existing:
        run("leg-b", "--duration", "0.1")
    before = {path: path.read_bytes() for path in tmp_path.rglob("*.*") if path.is_file()}

    def broken(*arguments):
        raise error

    monkeypatch.setattr("drake_leg.runs.outcome.Outcome.write", broken)
    words = ["run", "leg-b", "--out", tmp_path / "out", "--duration", "0.2", "--overwrite"]
    assert status_of(*words) == status
    assert len(capsys.readouterr().err.splitlines()) == 1
    assert {p: p.read_bytes() for p in tmp_path.rglob("*.*") if p.is_file()} == before
    assert [path.name for path in tmp_path.iterdir()] == (["out"] if existing else [])


def test_a_path_that_the_terminal_cannot_show_is_no_failure(no_figures, tmp_path, monkeypatch):
    monkeypatch.setattr(sys, "stdout", io.TextIOWrapper(io.BytesIO(), encoding="ascii"))
    assert status_of("run", "pendulum", "--out", tmp_path / "größe", "--duration", "0.01") == 0
    assert (tmp_path / "größe" / "summary.json").exists()


# --- in a process of its own -----------------------------------------------------------------


def process(*words, **keywords):
    command = [sys.executable, "-W", "error", *words]
    return subprocess.run(command, capture_output=True, text=True, check=False, **keywords)


def test_the_module_is_the_program():
    done = process("-m", "drake_leg", "list")
    assert done.returncode == 0
    assert done.stdout.startswith("pendulum ")
    assert done.stderr == ""


def test_help_is_quick_for_it_imports_neither_drake_nor_matplotlib():
    code = (
        "import sys, drake_leg.cli as c\n"
        "for words in ('list', '--help', 'run --help', 'derive --help', '--version'):\n"
        "    try: c.main(words.split())\n"
        "    except SystemExit: pass\n"
        "    for name in ('pydrake', 'matplotlib', 'sympy', 'numpy'):\n"
        "        assert name not in sys.modules, (words, name)"
    )
    done = process("-c", code)
    assert done.returncode == 0, done.stderr


def test_only_the_command_that_is_asked_for_is_imported():
    code = (
        "import sys, drake_leg.cli as c\n"
        "c.main(['list'])\n"
        "sys.exit(any(name in sys.modules for name in ('drake_leg.runs.step', 'tomllib', 'yaml')))"
    )
    assert process("-c", code).returncode == 0


def test_a_command_imports_only_what_it_works_with(tmp_path):
    code = (
        "import sys, drake_leg.cli as c\n"
        "c.main(['doctor', 'leg-b', '--q', '90,-50,-90'])\n"
        "assert not any(name.split('.')[0] == 'scipy' for name in sys.modules)\n"
        "assert 'drake_leg.simulink.listing' not in sys.modules\n"
        "import drake_leg.runs.figures\n"
        "assert 'scipy.spatial' not in sys.modules"
    )
    done = process("-c", code)
    assert done.returncode == 0, done.stderr


def test_bad_input_is_one_sentence_on_the_standard_error(tmp_path):
    done = process("-m", "drake_leg", "run", "leg-b", "--out", tmp_path / "a" / "b", "--l1", "-1")
    assert done.returncode == 2
    assert done.stdout == ""
    (sentence,) = (line for line in done.stderr.splitlines() if ", at work for " not in line)
    assert "-1" in sentence
    assert list(tmp_path.iterdir()) == []


@pytest.mark.slow
def test_a_run_in_a_process_with_warnings_as_errors(tmp_path):
    done = process(
        "-m", "drake_leg", "run", "leg-b", "--out", "out", "--duration", "0.1", cwd=tmp_path
    )
    assert done.returncode == 0
    assert all(", at work for " in line for line in done.stderr.splitlines())
    assert done.stdout.startswith("wrote out: ")
    assert (tmp_path / "out" / "recording.csv").exists()


def test_a_reader_that_goes_away_is_no_traceback():
    pipe = subprocess.Popen(
        [sys.executable, "-m", "drake_leg", "list"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    pipe.stdout.close()
    assert "Traceback" not in pipe.stderr.read()
    pipe.stderr.close()
    pipe.wait(timeout=30)
