"""``drake-leg run`` of Simulink models."""

import json
import re

import numpy as np
import pytest
from mechanism_models import four_bar, pendulum
from moving import falling
from pydrake.systems.analysis import Simulator
from signal_models import charted, oscillator
from slx_writer import ModelBuilder

from drake_leg.cli import main
from drake_leg.simulation.recording import Recording
from drake_leg.simulink.multibody.bodies import mechanism_of
from drake_leg.simulink.multibody.plant import mechanism_plant
from drake_leg.simulink.running.replaying import positions_of
from drake_leg.simulink.running.running import ROWS, run_model, runnable


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def run(here, capsys):
    """Run a model that is written as m.slx: status, what is printed, recording and summary."""

    def carried_out(built, *words, figures="none", out="out"):
        built.write(here / "m.slx")
        status = main(["run", "m.slx", "--out", out, "--figures", figures, *map(str, words)])
        printed = capsys.readouterr()
        if not (here / out).exists():
            return status, printed, None, None
        summary = json.loads((here / out / "summary.json").read_text(encoding="utf-8"))
        return status, printed, Recording.read_csv(here / out / "recording.csv"), summary

    return carried_out


def test_a_model_is_recorded_under_the_names_of_its_signals(run):
    status, printed, recording, summary = run(oscillator())
    assert (status, printed.err) == (0, "")
    assert printed.out.startswith(f"wrote out: 4 columns, {ROWS + 1} rows, ")
    assert [*recording.columns] == ["time[s]", "Scope.theta", "Scope.Speed", "both(1)", "both(2)"]
    time = recording["time"]
    np.testing.assert_allclose(recording["Scope.theta"], np.cos(time), atol=1e-5)
    np.testing.assert_allclose(recording["Scope.Speed"], -np.sin(time), atol=1e-5)
    assert (recording["both(1)"] == recording["Scope.theta"]).all()
    assert summary["rows"] == len(time)
    assert summary["stop_reason"] is None
    assert summary["understood"]["continuous_states"] == 2
    assert summary["columns"][0] == {
        "header": "Scope.theta", "block": "Scope", "kind": "Scope", "port": 1, "signal": "theta",
    }  # fmt: skip


@pytest.mark.slow
def test_each_sink_has_a_figure_as_its_scope(run, here):
    assert run(oscillator(), figures="svg")[0] == 0
    names = {path.name for path in (here / "out").iterdir() if path.name[0] != "."}
    assert names == {"recording.csv", "summary.json", "scope.svg", "to_workspace.svg"}


def test_duration_and_accuracy_are_obeyed(run):
    _, _, recording, summary = run(oscillator(), "--duration", 0.5, "--accuracy", 1e-9)
    assert recording["time"][-1] == pytest.approx(0.5)
    assert summary["solver"]["here"]["accuracy"] == 1e-9
    np.testing.assert_allclose(recording["Scope.theta"], np.cos(recording["time"]), atol=1e-8)


@pytest.mark.parametrize("given", ["--duration 0", "--duration a", "--accuracy -1"])
def test_numbers_that_make_no_sense_are_refused(run, given):
    status, printed, recording, _ = run(oscillator(), *given.split())
    assert (status, recording, printed.out) == (2, None, "")
    assert given.split()[0] in printed.err


def test_a_stop_block_is_a_normal_end(run):
    built = oscillator("9")
    when = built.add_block("RelationalOperator", "Late", {"Operator": ">="}, ports={"in": 2})
    clock = built.add_block("Clock", "Clock")
    limit = built.add_block("Constant", "Limit", {"Value": "0.5"})
    built.connect(clock, f"{when}#in:1")
    built.connect(limit, f"{when}#in:2")
    built.connect(when, built.add_block("Stop", "Enough"))
    status, printed, recording, summary = run(built)
    assert status == 0
    assert "the block 'Enough' stops it" in printed.err
    assert 0.5 <= summary["ended_at_s"] < 1.0
    assert summary["stop_reason"] is None
    assert recording["time"][-1] <= summary["ended_at_s"]


def test_what_was_recorded_is_kept_where_a_run_stops_before_its_end(run):
    built = oscillator("9")
    left = built.add_block("Sum", "Left", {"Inputs": "+-"}, ports={"in": 2})
    root = built.add_block("Sqrt", "Root")
    built.connect(built.add_block("Constant", "Half", {"Value": "0.5"}), f"{left}#in:1")
    built.connect(built.add_block("Clock", "Clock"), f"{left}#in:2")
    built.connect(left, root)
    built.connect(root, built.add_block("Integrator", "Total"))
    status, printed, recording, summary = run(built)
    assert status == 3
    assert "drake-leg: stopped at 0.5" in printed.err
    assert "finite" in summary["stop_reason"]
    assert summary["stopped_at_s"] == pytest.approx(0.5, abs=0.2)
    assert 0.4 < recording["time"][-1] < 0.7


def test_ctrl_c_saves_what_was_recorded(run, monkeypatch):
    advance = Simulator.AdvanceTo

    def interrupted(simulator, time):
        advance(simulator, time)
        if time >= 0.5:
            raise KeyboardInterrupt

    monkeypatch.setattr(Simulator, "AdvanceTo", interrupted)
    status, printed, recording, summary = run(oscillator())
    assert status == 130
    assert printed.err == "drake-leg: stopped at 0.5 s of 1 s: interrupted\n"
    assert summary["stop_reason"] == "interrupted"
    assert recording["time"][-1] == pytest.approx(0.5, abs=0.01)


@pytest.mark.slow
def test_values_come_from_the_script_that_a_person_would_run(run, here):
    built = oscillator().set("Minus", Gain="-w^2")
    status, printed, _, _ = run(built)
    assert status == 2
    assert printed.err.startswith("drake-leg: m.slx: ")
    assert "'w'" in printed.err
    (here / "values.m").write_text("w = 2;\n", encoding="utf-8")
    status, printed, recording, summary = run(built)
    assert status == 0
    assert "w taken from" in printed.err
    assert any("values.m" in sentence for sentence in summary["remarks"])
    np.testing.assert_allclose(recording["Scope.theta"], np.cos(2 * recording["time"]), atol=1e-5)
    assert run(built, "--set", "w=1", out="other")[1].err == ""


def test_what_callbacks_do_to_the_system_is_skipped_and_listed(run):
    built = oscillator()
    built.callbacks["InitFcn"] = "plot(1);\nplot(2);\nplot(3);\nsystem('ls');"
    status, printed, _, summary = run(built)
    assert status == 0
    assert len(summary["skipped"]) == 4
    assert "skipped in scripts and callbacks: plot" in printed.err
    assert "; and 1 more" in printed.err
    assert "system" in summary["skipped"][-1]


def test_a_block_that_does_not_run_is_replaced_by_a_constant(run):
    status, printed, recording, _ = run(charted())
    assert (status, recording) == (2, None)
    assert "'Chart'" in printed.err
    status, printed, recording, summary = run(charted(), "--replace", "Chart=constant 3")
    assert status == 0
    np.testing.assert_allclose(recording["Scope"], 3.0 * recording["time"], atol=1e-9)
    assert "replaced: Chart puts out constant 3" in summary["remarks"]


def test_a_parameter_has_another_value_than_in_the_file(run):
    model = ModelBuilder(solver={"StopTime": "1"})
    clock, gain, scope = (model.add_block(kind, kind) for kind in ("Clock", "Gain", "Scope"))
    model.connect(clock, gain)
    model.connect(gain, scope)
    status, _, recording, summary = run(model, "--parameter", "Gain:Gain=2.5")
    assert status == 0
    np.testing.assert_allclose(recording["Scope"], 2.5 * recording["time"], atol=1e-9)
    assert "parameters set instead of the file's: Gain:Gain = 2.5" in summary["remarks"]


@pytest.mark.parametrize(
    ("given", "said"),
    [
        (["Gain=2"], "--parameter Gain=2 names no parameter of a block, or gives it no value"),
        (["Gain:Gain="], "gives it no value: write 'BLOCK:NAME=VALUE'"),
        (["Gain:Gain=1", "Gain:Gain=2"], "--parameter sets 'Gain:Gain' twice: keep one"),
        (["Gain:gian=2"], "has no parameter 'gian': did you mean Gain?"),
    ],
)
def test_a_parameter_that_is_not_there_is_told(run, given, said):
    model = ModelBuilder(solver={"StopTime": "1"})
    model.connect(model.add_block("Gain", "Gain"), model.add_block("Scope", "Scope"))
    status, printed, recording, _ = run(
        model, *(word for text in given for word in ("--parameter", text))
    )
    assert (status, recording) == (2, None)
    assert said in printed.err


def test_a_block_is_replaced_by_a_table(run, here):
    (here / "table.csv").write_text("time,value\n0,0\n1,2\n2,2\n", encoding="utf-8")
    status, _, recording, _ = run(charted(), "--replace", "Chart=table.csv")
    assert status == 0
    time = recording["time"]
    exact = np.where(time < 1.0, time**2, 2.0 * time - 1.0)
    np.testing.assert_allclose(recording["Scope"], exact, atol=1e-6)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ("Chrt=constant 1", "there is no block 'Chrt' to replace: did you mean Chart?"),
        ("Chart=banana", "cannot put out 'banana'"),
        ("Chart=", "names no block, or nothing"),
        ("Chart=none.csv", "none.csv"),
        ("Chart=constant huh", "huh"),
        ("Chart=late.csv", "late.csv, line 3: the times must rise"),
        ("Chart=words.csv", "words.csv, line 2: not all are numbers"),
        ("Chart=names.csv", "names.csv has no rows"),
    ],
)
def test_replacements_that_make_no_sense_are_refused(run, here, given, said):
    (here / "late.csv").write_text("0,0\n1,2\n1,2\n", encoding="utf-8")
    (here / "words.csv").write_text("0,0\none,2\n", encoding="utf-8")
    (here / "names.csv").write_text("time,value\n", encoding="utf-8")
    status, printed, recording, _ = run(charted(), "--replace", given)
    assert (status, recording, printed.out) == (2, None, "")
    assert said in printed.err


@pytest.mark.slow
def test_a_mechanism_is_replayed_as_it_moved(run, here):
    built = pendulum(PositionTargetSpecify="on", PositionTargetValue="30")
    built.solver["StopTime"] = "0.3"
    status, printed, recording, summary = run(built, "--replay", "m.html")
    assert status == 0
    assert "wrote m.html" in printed.out
    assert "<html" in (here / "m.html").read_text(encoding="utf-8")
    assert summary["understood"]["mechanism"]["positions"] == 1
    assert summary["remarks"][0].endswith("shows a signal, so the joints alone are recorded")
    assert [*recording.columns] == ["time[s]", "Pivot.q[rad]"]
    assert recording["Pivot.q"][0] == pytest.approx(np.pi / 6)


@pytest.mark.parametrize(
    ("contact", "law"),
    [
        pytest.param("smooth", "the blocks' law, which never pulls", marks=pytest.mark.slow),
        pytest.param("pulling", "the blocks' law, whose damper may pull", marks=pytest.mark.slow),
        ("drake", "Drake's point contact"),
    ],
)
def test_the_law_of_contact_is_named(run, contact, law):
    built = falling(0.101)
    built.solver["StopTime"] = "0.01"
    status, printed, _, summary = run(built, "--contact", contact)
    assert status == 0
    assert summary["understood"]["mechanism"]["contact"] == law
    assert ("Drake's point contacts" in printed.err) is (contact == "drake")


@pytest.mark.slow
def test_a_loop_is_shown_by_its_tree(here):
    built = four_bar(PositionTargetSpecify="on", PositionTargetValue="60")
    model = built.model(here)
    ready = runnable(model, duration=0.05)
    run = run_model(ready)
    shown = mechanism_plant(mechanism_of(model))
    time, q = positions_of(run, ready.diagram.mechanism.plant, shown)
    assert q.shape == (time.size, 3)
    np.testing.assert_allclose(q[0], shown.GetDefaultPositions(), atol=1e-8)


def test_a_folder_of_a_models_run_is_not_taken_for_a_robots(run, capsys):
    assert run(oscillator())[0] == 0
    assert main(["replay", "out", "--out", "m.html"]) == 2
    assert "is a run of the Simulink model 'm': run the model again" in capsys.readouterr().err


def test_showing_a_model_without_a_mechanism_is_refused(run):
    for option in ("--stills", "--contact=smooth", "--replay=m.html"):
        status, printed, recording, _ = run(oscillator(), option)
        assert (status, recording) == (2, None)
        assert "this model has none" in printed.err


# --- its page ---------------------------------------------------------------------------------


def page_of(here):
    text = (here / "m.html").read_text(encoding="utf-8")
    links = re.findall(r"""(?:src|href)=["']([^"']{0,20})""", text)
    assert links
    assert all(link.startswith(("data:image/", "#")) for link in links)  # it needs no other file
    return text


@pytest.mark.slow
def test_a_page_shows_the_model_its_mechanism_and_its_plots(run, here):
    built = pendulum(PositionTargetSpecify="on", PositionTargetValue="turn")
    built.solver["StopTime"] = "0.1"
    built.callbacks["PreLoadFcn"] = "turn = 30;"
    status, printed, _, _ = run(built, "--page", "m.html")
    assert status == 0
    assert "wrote m.html" in printed.out
    page = page_of(here)
    assert "It ran to its end at 0.1 s" in page
    assert "1 body, 1 joint" in page
    assert page.count("data:image/webp") == 2  # for light and dark
    assert page.count("data:image/svg+xml") == 2  # the mechanism, and the joint's angle
    assert "<td>turn</td><td>30</td><td>PreLoadFcn" in page
    assert "drake-leg run m.slx --out out --page m.html" in page


def test_a_page_of_a_model_that_does_not_run_says_what_is_missing(run, here):
    built = charted().set("Total", InitialCondition="where_it_starts")
    status, printed, recording, _ = run(built, "--page", "m.html")
    assert (status, recording, printed.out) == (2, None, "wrote m.html\n")
    page = page_of(here)
    assert "It does not run" in page
    assert "Chart" in page
    assert "<td>where_it_starts</td>" in page
    assert "data:image/svg+xml" in page


def test_a_page_says_what_was_replaced(run, here):
    assert run(charted(), "--replace", "Chart=constant 3", "--page", "m.html")[0] == 0
    assert "replaced: Chart puts out constant 3" in page_of(here)


@pytest.mark.slow
def test_names_of_blocks_are_text_on_a_page(run, here):
    built = oscillator()
    built.add_block("Constant", "<script>alert(1)</script>", {"Value": "1"})
    assert run(built, "--page", "m.html")[0] == 0
    assert "<script" not in page_of(here)


@pytest.mark.parametrize("page", ["m.txt", "m.html"])
def test_a_page_that_cannot_be_written_is_refused_before_the_run(run, here, page):
    (here / "m.html").write_text("mine", encoding="utf-8")
    status, printed, recording, _ = run(oscillator(), "--page", page)
    assert (status, recording, printed.out) == (2, None, "")
    assert "--page" in printed.err
    assert (here / "m.html").read_text(encoding="utf-8") == "mine"
