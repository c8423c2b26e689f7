"""A sweep: its plan, its rows, its journal, its executors; nothing is lost, nothing twice."""

import json
import math
import multiprocessing
import os
import pickle
import re
import signal
import subprocess
import sys
import time
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from itertools import chain
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from drake_leg.cli import main
from drake_leg.errors import DrakeLegError, InvalidValueError, OutputError
from drake_leg.files import LIST
from drake_leg.robot.robot_file import load_robot
from drake_leg.runs.catalogue import RUNS, run_kind
from drake_leg.runs.named import run
from drake_leg.runs.walk_options import BESIDE
from drake_leg.studies import pool, row
from drake_leg.studies.journal import JOURNAL
from drake_leg.studies.plan import Plan, checked_plan, options_of, samples
from drake_leg.studies.pool import Dispatcher
from drake_leg.studies.row import Done, carried_out, flat
from drake_leg.studies.sweep import RUNS as TABLE
from drake_leg.studies.sweep import sweep
from drake_leg.studies.table import Table, read_table
from drake_leg.studies.variation import Variation, variations

SHORT = {"duration": 0.1}


def planned(name="leg-b", **vary):
    kind = run_kind(name)
    return Plan(name=name, kind=kind, fixed={}, vary=variations(kind.options, name, vary, {}))


class Here(Executor):
    """Carries out a task when it is submitted; loses its worker where it is told to."""

    def __init__(self, loses=lambda task, count: False):
        self.submitted, self._loses = [], loses

    def submit(self, function, task):
        self.submitted.append(list(task.places))
        future = Future()
        if self._loses(task, len(self.submitted)):
            future.set_exception(ConnectionError("the worker is gone"))
        else:
            future.set_result(function(task))
        return future


# --- the plan -----------------------------------------------------------------------------------


def test_a_grid_has_every_point_and_the_last_one_varies_fastest():
    plan = planned(femur="0.06:0.14:3", inverse="exact,damped")
    assert len(plan) == 6
    assert plan.values(0) == {"femur": 0.06, "inverse": "exact"}
    assert plan.values(1) == {"femur": 0.06, "inverse": "damped"}
    assert plan.values(5) == {"femur": 0.14, "inverse": "damped"}
    assert plan.options(5) == {"l2": 0.14, "inverse": "damped"}


def test_a_component_leaves_the_others():
    plan = planned(**{"q0[1]": [-60, -40]})
    assert plan.options(1) == {"q0": [90.0, -40, -90.0]}


def test_a_whole_list_is_a_choice():
    for choices in ("90,-50,-90;90,-60,-80", [[90, -50, -90], (90, -60, -80)]):
        assert planned(q0=choices).options(1) == {"q0": [90, -60, -80]}


@pytest.mark.parametrize("sampler", ["sobol", "random"])
def test_samples_are_repeatable_and_fill_the_ranges(sampler):
    points = samples(sampler, 3, 100, seed=7)
    assert points.shape == (100, 3)
    assert ((points >= 0.0) & (points < 1.0)).all()
    np.testing.assert_array_equal(points, samples(sampler, 3, 100, seed=7))
    assert (points != samples(sampler, 3, 100, seed=8)).any()
    assert np.abs(points.mean(axis=0) - 0.5).max() < 0.1


def test_sobol_covers_better_than_chance():
    """Each of 64 equal parts of an axis has one of 64 points."""
    points = samples("sobol", 2, 64, seed=0)
    for column in points.T:
        assert sorted((column * 64).astype(int)) == list(range(64))


def test_a_grid_is_counted_without_its_values(monkeypatch):
    """Its length is asked for after every task."""
    monkeypatch.setattr(Variation, "grid", property(lambda one: pytest.fail("values are made")))
    plan = planned(femur="0.06:0.14:300000", inverse="exact,damped")
    assert len(plan) == 600_000
    with pytest.raises(InvalidValueError, match="these are 30000000000 runs"):
        checked_plan(planned(femur="1:2:300000", tibia="1:2:100000"))


EXAMPLES = {  # of options without a default
    "q0": [30.0],
    "q0_error": [0.0],
    "direction": [1.0, 0.0, 0.0],
    "push": [0.0, 0.0, 0.1],
    "damping_unit": "N*m*s/rad",
    "spring_unit": "N*m/rad",
    "task": "position",
    "dynamics": "forward",
    "phases": [0.0, 0.5, 0.0, 0.5, 0.0, 0.5],
    "shift": [0.01, 0.0],
    "then": "speed=0.03 at=5",
}
NEEDS_OF_WALK = BESIDE | {"angle": "turn"}


def test_everything_that_a_run_takes_can_vary():
    for name, kind in RUNS.items():
        for option, default in vars(kind.options()).items():
            value = EXAMPLES.get(option, 1.0) if default is None else default
            needs = NEEDS_OF_WALK.get(option) if name == "hexapod" else None
            beside = {needs: [True if needs == "touch_down" else 0.1]} if needs else {}
            plan = checked_plan(planned(name, **{option: [value]}, **beside))
            assert getattr(options_of(plan, 0), option) == value


PLANS = {
    "no option": ({"femor": "1:2:3"}, {}, r"no option 'femor' to vary: did you mean femur\?"),
    "nothing": ({}, {}, "vary is {}; it must say what is varied"),
    "one value": ({"amplitude[0]": [1.0]}, {}, "amplitude is one value, and has no component 0"),
    "no component": ({"q0[7]": [1.0]}, {}, "q0 has no component 7"),
    "twice": ({"femur": [0.1], "l2": [0.1]}, {}, "l2 is given twice"),
    "also fixed": ({"femur": [0.1]}, {"l2": 0.1}, "femur is given twice"),
    "backwards": ({"femur": "2:1:3"}, {}, "ends at or below its start: put the smaller"),
    "no number": ({"femur": "a:b:3"}, {}, "femur has 'a', which is not a number"),
    "no count": ({"femur": "1:2"}, {}, "a range without a count.*or give `sample`"),
    "count": ({"femur": "1:2:2.5"}, {}, "their count must be a whole number"),
    "no choice": ({"inverse": "exact,"}, {}, "a choice is empty"),
    "scalar": ({"femur": 0.1}, {}, "femur is 0.1; it must be a list of its values"),
    "text": ({"femur": ["a"]}, {}, "l2 is 'a'; it must be a finite number"),
    "text in a component": ({"q0[1]": [-50, "a"]}, {}, r"q0\[1\] is 'a'; it must be a finite"),
    "a later text": ({"amplitude": [0.05, "0.06"]}, {}, "amplitude is '0.06'; it must be a finite"),
    "a truth": ({"amplitude": [0.05, True]}, {}, "amplitude is True; it must be a finite number"),
    "a short list": ({"q0": "90,-50,-90;90,-50"}, {}, r"q0 is \[90.0, -50.0\]; it must be three"),
    "option": ({"femur": [0.1]}, {"amplitud": 1}, r"no option 'amplitud': did you mean amplitude"),
    "count and sample": ({"femur": "1:2:3"}, {"sample": 4}, "count, and samples are taken"),
    "sample": ({"femur": "1:2"}, {"sample": 0}, "sample is 0; it must be a whole number"),
    "seed": ({"femur": [0.1]}, {"seed": 3}, "the seed is 3, and nothing is sampled"),
    "no samples": ({"femur": [0.1]}, {"sampler": "random"}, "the sampler is 'random', and nothing"),
    "sampler": ({"femur": "1:2"}, {"sample": 2, "sampler": "x"}, "the sampler is 'x'"),
    "fields": ({"femur": [0.1]}, {"fields": "stroke_m"}, "fields is 'stroke_m'"),
    "workers": ({"femur": [0.1]}, {"workers": 0}, "workers is 0"),
    "executor": ({"femur": [0.1]}, {"executor": 3}, "the executor is 3"),
    "progress": ({"femur": [0.1]}, {"progress": 3}, "progress is 3; it must be a function"),
    "out": ({"femur": [0.1]}, {"out": 3}, "out is 3"),
}


@pytest.mark.parametrize("case", PLANS)
def test_what_makes_no_sense_is_refused(case):
    vary, more, sentence = PLANS[case]
    for fields in ({}, {"fields": ["stroke_m"]}):  # simulated, and in closed form
        with pytest.raises(InvalidValueError, match=sentence):
            sweep("leg-b", vary=vary, **(fields | more))


def test_what_a_run_takes_of_numpy_a_sweep_takes(tmp_path):
    vary = {"duration": [np.float32(0.5), np.int64(1)], "direction": [np.eye(3)[0]]}
    call = {"vary": vary, "q0": np.array([90, -50, -90.0]), "fields": ["stroke_m"]}
    result = sweep("leg-b", **call, out=tmp_path / "s")
    np.testing.assert_array_equal(result["stroke_m"], sweep("leg-b", **call)["stroke_m"])
    assert result["duration"].tolist() == [0.5, 1.0]


# --- the rows -----------------------------------------------------------------------------------


def test_a_row_is_the_summary_of_the_run():
    result = sweep("leg-b", vary={"amplitude": [0.02, 0.05]}, **SHORT)
    for place, amplitude in enumerate((0.02, 0.05)):
        summary = flat(run("leg-b", amplitude=amplitude, **SHORT).summary)
        for key in set(summary) - {"real_time_factor", "stop_reason"}:
            found = result[key][place]
            assert found == summary[key] or (summary[key] is None and found != found), key
    assert result["status"].tolist() == ["done", "done"]
    assert "run" in result.table


def test_stops_refusals_and_failures_are_rows(monkeypatch):
    vary = {"amplitude": [0.05, 0.2], "force": [False, True]}
    result = sweep("leg-b", vary=vary, duration=2.0, workers=1)
    assert result["status"].tolist() == ["done", "done", "singular", "singular"]
    foreseen, met = result["stopped_at_s"][2:]
    assert foreseen == pytest.approx(met, abs=1e-6)
    assert "would become singular" in result["message"][2]
    assert np.isnan(result["stroke_m"][2])
    assert result["stroke_m"][3] > 0.1
    refused = sweep("leg-b", vary={"l2": [-1.0]}, **SHORT)
    assert refused["status"][0] == "refused"
    assert "the length l2 is -1.0 m" in refused["message"][0]

    def fails(self, options):
        raise ZeroDivisionError("by nothing")

    monkeypatch.setattr("drake_leg.runs.catalogue.RunKind.run", fails)
    failed = sweep("leg-b", vary={"l2": [0.1]}, **SHORT)
    assert failed["status"][0] == "failed"
    assert failed["message"][0] == "ZeroDivisionError: by nothing"


def test_an_interrupted_run_is_no_row(monkeypatch):
    outcome = SimpleNamespace(summary={"stop_reason": "interrupted", "stopped_at_s": 0.1})
    monkeypatch.setattr("drake_leg.runs.catalogue.RunKind.run", lambda self, options: outcome)
    with pytest.raises(KeyboardInterrupt):
        sweep("leg-b", vary={"l2": [0.1]})


def test_fields_choose_columns():
    result = sweep("leg-b", vary={"l2": [0.1]}, fields=["q0_deg", "sigma_min_m"], **SHORT)
    assert list(result.table)[-4:] == ["q0_deg[0]", "q0_deg[1]", "q0_deg[2]", "sigma_min_m"]
    assert result.unknown_fields == ()


def test_a_field_that_no_summary_has_is_named(tmp_path, capsys):
    words = "sweep leg-b --vary l2=0.1 --duration 0.1 --fields sigma_min_m,sigma"
    assert main([*words.split(), "--out", str(tmp_path / "s")]) == 1
    assert "no summary of leg-b has a field sigma: see" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "sentence"),
    {
        "--pareto stroke_m,min:sigma_min_m": "write it as max:stroke_m",
        "--over tibia": "over one or two of femur, and not over tibia",
        "--plot stroke_n --fields stroke_m": "stroke_n is to be plotted.*did you mean stroke_m",
        "--pareto max:stroke_m,min:sigma_min_m --fields stroke_m": "sigma_min_m is to be plotted",
        "--sampler random": "nothing is sampled",
    }.items(),
)
def test_a_plot_that_makes_no_sense_is_refused_before_the_sweep(words, sentence, tmp_path, capsys):
    command = f"sweep leg-b --vary femur=0.08:0.12:3 {words} --out"
    assert main([*command.split(), str(tmp_path / "s")]) == 2
    assert re.search(sentence, capsys.readouterr().err)
    assert not (tmp_path / "s").exists()


def test_a_table_survives_parquet(tmp_path):
    columns = {
        "run": [0, 1, 2],
        "text": ["a", None, "b"],
        "number": [1, 2.5, None],
        "nothing": [None, None, None],
        "mixed": [1, "a", None],
    }
    Table(columns).write(tmp_path / "t.parquet", "digest")
    again = read_table(tmp_path / "t.parquet")
    assert list(again) == list(columns)
    assert again["text"].tolist() == ["a", None, "b"]
    assert again["number"].tolist()[:2] == [1.0, 2.5]
    assert again["mixed"].tolist() == ["1", "a", None]
    assert np.isnan(again["nothing"]).all()
    with pytest.raises(InvalidValueError, match=r"no column 'numer': did you mean number\?"):
        again["numer"]


# --- the journal --------------------------------------------------------------------------------


def test_an_interrupted_sweep_goes_on_where_it_was(tmp_path):
    where, done = tmp_path / "s", []

    def interrupt(count, total):
        assert total == 5
        done.append(count)
        if count == 3:
            raise KeyboardInterrupt

    call = {"vary": {"amplitude": "0.02:0.06:5"}, "workers": 1, "out": where, **SHORT}
    with pytest.raises(KeyboardInterrupt):
        sweep("leg-b", **call, progress=interrupt)
    assert len((where / JOURNAL).read_text().splitlines()) == 3
    with (where / JOURNAL).open("a") as file:
        file.write('{"place": 3, "row": {"sta')  # as if killed here
    counts = []
    result = sweep("leg-b", **call, progress=lambda count, total: counts.append(count))
    assert counts == [3, 4, 5]
    assert result["run"].tolist() == [0, 1, 2, 3, 4]
    assert result.counts == {"done": 5}
    whole = sweep("leg-b", **{**call, "out": None})
    np.testing.assert_array_equal(result["sigma_min_m"], whole["sigma_min_m"])
    assert not (where / JOURNAL).exists()
    before = (where / TABLE).read_bytes()
    sweep("leg-b", **call, progress=lambda *_: pytest.fail("there is nothing to do"))
    assert (where / TABLE).read_bytes() == before


def test_another_plan_is_refused_and_replaced_where_that_is_asked_for(tmp_path):
    where = tmp_path / "s"
    sweep("leg-b", vary={"amplitude": [0.02]}, out=where, **SHORT)
    with pytest.raises(OutputError, match=r"holds a sweep with another plan.*`overwrite=True`"):
        sweep("leg-b", vary={"amplitude": [0.03]}, out=where, **SHORT)
    result = sweep("leg-b", vary={"amplitude": [0.03]}, out=where, overwrite=True, **SHORT)
    assert result["amplitude"].tolist() == [0.03]
    (where / "mine.txt").write_text("x")
    with pytest.raises(OutputError, match=r"holds mine.txt"):
        sweep("leg-b", vary={"amplitude": [0.02]}, out=where, overwrite=True, **SHORT)


def test_a_table_of_another_plan_is_not_shown_as_this_ones(tmp_path):
    call = {"vary": {"femur": [0.1, 0.11]}, "fields": ["stroke_m"], "out": tmp_path / "s"}
    sweep("leg-b", **call)
    sweep("leg-b", **call | {"vary": {"femur": [0.2]}, "out": tmp_path / "other"})
    (tmp_path / "other" / TABLE).replace(tmp_path / "s" / TABLE)
    with pytest.raises(OutputError, match=r"not the table of the plan beside it.*`overwrite=True`"):
        sweep("leg-b", **call)
    assert len(sweep("leg-b", **call, overwrite=True)) == 2


def test_another_version_of_the_package_makes_another_plan(tmp_path, monkeypatch):
    call = {"vary": {"femur": [0.1]}, "fields": ["stroke_m"], "out": tmp_path / "s"}
    sweep("leg-b", **call)
    sweep("leg-b", **call)
    monkeypatch.setattr("drake_leg.studies.plan.version", lambda package: "99.0")
    with pytest.raises(OutputError, match=r"of another version.*`overwrite=True`"):
        sweep("leg-b", **call)


def test_a_folder_of_something_else_is_left_alone(tmp_path):
    (tmp_path / "mine").mkdir()
    with pytest.raises(OutputError, match="exists"):
        sweep("leg-b", vary={"amplitude": [0.02]}, out=tmp_path / "mine", **SHORT)


# --- executors ----------------------------------------------------------------------------------


def test_any_executor_goes_in():
    vary = {"amplitude": "0.02:0.06:5"}
    here = Here()
    result = sweep("leg-b", vary=vary, executor=here, **SHORT)
    assert sorted(chain.from_iterable(here.submitted)) == [0, 1, 2, 3, 4]
    with ThreadPoolExecutor(2) as threads:
        other = sweep("leg-b", vary=vary, executor=threads, **SHORT)
    for name in ("amplitude", "sigma_min_m", "stroke_m"):
        np.testing.assert_array_equal(result[name], other[name])


def test_a_lost_worker_costs_no_row_and_makes_none_twice():
    here = Here(loses=lambda task, count: count == 2)
    result = sweep("leg-b", vary={"amplitude": "0.02:0.06:5"}, executor=here, **SHORT)
    assert result.counts == {"done": 5}
    assert result["run"].tolist() == [0, 1, 2, 3, 4]


def test_a_run_that_kills_its_workers_is_given_up_and_the_others_are_not():
    here = Here(loses=lambda task, count: 3 in task.places)
    result = sweep("leg-b", vary={"amplitude": "0.02:0.06:5"}, executor=here, **SHORT)
    assert result["status"].tolist() == ["done", "done", "done", "lost", "done"]
    assert "its worker was lost 3 times (ConnectionError" in result["message"][3]


def test_tasks_grow_until_they_take_half_a_second(monkeypatch):
    def quick(task):
        return Done({place: {} for place in task.places}, 1e-3 * len(task.places), 0)

    monkeypatch.setattr(pool, "carried_out", quick)
    here = Here()
    done = [*Dispatcher(lambda places: row.Task(None, places, (), None), here, 1).rows(range(500))]
    sizes = [len(places) for places in here.submitted]
    assert max(sizes) == pool.MOST_AT_ONCE
    assert sizes[0] == 1
    assert sorted(place for rows in done for place in rows) == list(range(500))


def test_an_executor_that_broke_is_the_callers(monkeypatch):
    from concurrent.futures.process import BrokenProcessPool

    class Broken(Here):
        def submit(self, function, task):
            raise BrokenProcessPool("gone")

    with pytest.raises(DrakeLegError, match="the executor has lost its workers: what was done"):
        sweep("leg-b", vary={"l2": [0.1]}, executor=Broken())


def test_an_executor_that_is_shut_down_is_refused():
    executor = ThreadPoolExecutor(1)
    executor.shutdown()
    sentence = r"the executor takes no runs \(.*shutdown\): what was done is kept in `out`"
    with pytest.raises(DrakeLegError, match=sentence):
        sweep("leg-b", vary={"l2": [0.1]}, executor=executor, **SHORT)


def test_processes_with_too_much_memory_are_replaced(monkeypatch):
    """Even if a smaller one of them answers after the one that grew."""
    begun = []

    def start(workers):
        begun.append(workers)
        return Here()

    def grown(task):
        memory = 2 * pool.MOST_MEMORY if task.places == [1] else 0
        return Done({place: {} for place in task.places}, 1.0, memory)

    monkeypatch.setattr(pool, "new_processes", start)
    monkeypatch.setattr(pool, "carried_out", grown)
    monkeypatch.setattr(pool, "wait", first_of_all)
    rows = Dispatcher(lambda places: row.Task(None, places, (), None), None, 2).rows(range(12))
    assert sorted(place for done in rows for place in done) == list(range(12))
    assert begun == [2, 2]


def first_of_all(running, return_when):
    """Of the tasks that run, the one that was handed out first is done first."""
    return SimpleNamespace(done=[next(iter(running))])


def test_what_goes_to_a_worker_and_comes_back_can_be_pickled():
    plan = planned(amplitude=[0.05, 0.2])
    task = row.Task(plan.kind, [0, 1], [plan.options(0), plan.options(1)], None)
    again = pickle.loads(pickle.dumps(task))
    assert [*pickle.loads(pickle.dumps(carried_out(again))).rows] == [0, 1]


@pytest.mark.slow
def test_a_worker_draws_nothing():
    """It does not even load what draws."""
    script = (
        "import sys\n"
        "from drake_leg.runs.catalogue import RUNS\n"
        "from drake_leg.studies.row import row_of\n"
        "assert row_of(RUNS['leg-b'], {'duration': 0.1})['status'] == 'done'\n"
        "assert row_of(RUNS['pendulum'], {'duration': 0.1})['status'] == 'done'\n"
        "assert not {'matplotlib', 'PIL', 'sympy'} & set(sys.modules), 'drawing'\n"
    )
    subprocess.run([sys.executable, "-c", script], check=True)


KILLED = """
import sys, time
from drake_leg.studies.sweep import sweep

def stand_still(count, total):
    if count > 2 and "stand-still" in sys.argv:
        time.sleep(600)

if __name__ == "__main__":
    sweep("leg-b", vary={"amplitude": "0.02:0.06:40"}, duration=2.0, workers=2, out=sys.argv[1],
          progress=stand_still)
"""


@pytest.mark.slow
def test_a_killed_sweep_leaves_no_process_and_goes_on(tmp_path):
    script, where = tmp_path / "killed.py", tmp_path / "s"
    script.write_text(KILLED)
    parent = subprocess.Popen([sys.executable, str(script), str(where), "stand-still"])
    journal = where / JOURNAL
    wait_for(lambda: journal.exists() and len(journal.read_text().splitlines()) > 2)
    children = descendants_of(parent.pid)
    assert len(children) >= 3  # two workers, and what starts them
    parent.send_signal(signal.SIGKILL)
    parent.wait()
    wait_for(lambda: not any(Path(f"/proc/{child}").exists() for child in children))
    left = len(journal.read_text().splitlines())
    subprocess.run([sys.executable, str(script), str(where)], check=True)
    table = read_table(where / TABLE)
    assert 2 < left < 40
    assert table["run"].tolist() == list(range(40))
    assert set(table["status"]) == {"done"}


@pytest.mark.slow
def test_a_killed_worker_is_replaced(tmp_path):
    """Of the two processes of this machine one is killed midway: no row lost, none twice."""
    killed = []

    def kill_one(count, total):
        if count > 5 and not killed:
            worker = multiprocessing.active_children()[0].pid
            os.kill(worker, signal.SIGKILL)
            killed.append(worker)

    result = sweep(
        "leg-b", vary={"amplitude": "0.02:0.06:40"}, workers=2, progress=kill_one, **SHORT
    )
    assert killed
    assert result["run"].tolist() == list(range(40))
    assert result.counts == {"done": 40}


@pytest.mark.slow
def test_a_cluster_of_two_workers_of_which_one_is_killed_midway(tmp_path):
    distributed = pytest.importorskip("distributed", reason="the extra cluster is not installed")
    killed = []
    with (
        distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, dashboard_address=None, silence_logs=50
        ) as cluster,
        distributed.Client(cluster) as client,
    ):

        def kill_one(count, total):
            if count > 5 and not killed:
                pid = next(iter(client.run(os.getpid).values()))
                os.kill(pid, signal.SIGKILL)
                killed.append(pid)

        result = sweep(
            "leg-b",
            vary={"amplitude": "0.02:0.06:60"},
            executor=client.get_executor(pure=False),
            progress=kill_one,
            out=tmp_path / "s",
            duration=1.0,
        )
    assert killed
    assert result["run"].tolist() == list(range(60))
    assert result.counts == {"done": 60}
    assert math.isfinite(result["sigma_min_m"].sum())
    assert (tmp_path / "s" / LIST).exists()
    assert json.loads((tmp_path / "s" / "plan.json").read_text())["runs"] == 60


def wait_for(condition):
    end = time.monotonic() + 120.0
    while not condition():
        assert time.monotonic() < end, "in vain"
        time.sleep(0.05)


def descendants_of(pid):
    children = children_of(pid)
    return children + [each for child in children for each in descendants_of(child)]


def children_of(pid):
    found = []
    for status in Path("/proc").glob("[0-9]*/stat"):
        try:
            parent = int(status.read_text().rpartition(")")[2].split()[1])
        except OSError:
            continue
        if parent == pid:
            found.append(int(status.parent.name))
    return found


# --- letters of a .par file ---------------------------------------------------------------------

RX90 = Path(__file__).parents[2] / "examples" / "symoro" / "rx90.par"
POSTURE = {"q0": [0, 30, 40, 0, 50, 0], "dynamics": "none", "duration": 0.05}


def test_letters_of_a_file_vary_as_options_do():
    result = sweep(
        RX90, vary={"D3": "0.3:0.5:2", "amplitude": [0.02]}, numbers={"RL4": 0.4}, **POSTURE
    )
    assert result["D3"].tolist() == [0.3, 0.5]
    assert result.counts == {"done": 2}
    for value, least in zip((0.3, 0.5), result["sigma_min_m"], strict=True):
        robot = load_robot(RX90, {"D3": value, "RL4": 0.4})
        alone = run(robot, amplitude=0.02, **POSTURE).summary
        assert alone["sigma_min_m"] == least
    assert result["sigma_min_m"][0] != result["sigma_min_m"][1]


def test_a_robot_that_letters_do_not_make_is_a_refused_row():
    result = sweep(RX90, vary={"D3": [0.4, 1e12]}, numbers={"RL4": 0.4}, workers=1, **POSTURE)
    assert result["status"].tolist() == ["done", "refused"]
    assert "it must be at most 1e+09" in result["message"][1]


@pytest.mark.parametrize(
    ("vary", "numbers", "said"),
    [
        ({"D3": "0.3:0.5:2"}, {"D3": 1, "RL4": 1}, "D3 is varied and has a number, too"),
        ({"D3": "0.3:0.5:2"}, {}, "RL4 .* has no number"),
        ({"D3": "a,b"}, {"RL4": 1}, "D3 has 'a', which is not a number"),
        (
            {"D9": "1,2"},
            {"D3": 1, "RL4": 1},
            "no option 'D9' to vary: it has .*the letters of its file",
        ),
    ],
)
def test_letters_that_make_no_sense_are_refused(vary, numbers, said):
    with pytest.raises(InvalidValueError, match=said):
        sweep(RX90, vary=vary, numbers=numbers)


def test_numbers_are_for_files_with_letters():
    with pytest.raises(InvalidValueError, match="has no letters"):
        sweep("leg-b", vary={"amplitude": [0.02]}, numbers={"D3": 1})


@pytest.mark.slow
def test_a_sweep_of_a_files_letters_has_the_file_in_its_plan(tmp_path, capsys):
    out = tmp_path / "lengths"
    words = [str(RX90), "--set", "RL4=0.4", "--vary", "D3=0.3:0.5:2", "--out", str(out)]
    words += ["--q0", "0,30,40,0,50,0", "--dynamics", "none", "--duration", "0.05"]
    assert main(["sweep", *words, "--fields", "sigma_min_m"]) == 0
    assert "2 runs (2 done)" in capsys.readouterr().out
    plan = json.loads((out / "plan.json").read_text())
    assert (plan["file"], plan["numbers"]) == (RX90.read_text(), {"RL4": "0.4"})


def test_a_sweep_of_which_all_runs_are_refused_fails(tmp_path, capsys):
    words = ["leg-b", "--vary", "gravity=-1,-2", "--out", str(tmp_path / "none")]
    assert main(["sweep", *words]) == 2
    said = capsys.readouterr()
    assert "2 runs (2 refused)" in said.out
    assert "all runs were refused, the first one because gravity is -1.0" in said.err


def test_what_was_varied_stays_in_the_row_of_a_refused_run():
    """A summary that has an entry of the same name does not replace it."""
    rows = {0: {"status": "done", "gait": "tripod", "cost": 2.0}, 1: {"status": "refused"}}
    table = Table.from_rows({"gait": ["tripod", "wave"]}, rows)
    assert table["gait"].tolist() == ["tripod", "wave"]
    assert list(table) == ["run", "gait", "status", "message", "stopped_at_s", "cost"]
    assert table["cost"][0] == 2.0


def test_values_are_looked_at_before_what_writes_them(tmp_path, capsys, monkeypatch):
    monkeypatch.setitem(sys.modules, "pyarrow.parquet", None)
    words = ["leg-b", "--out", str(tmp_path / "none"), "--vary"]
    assert main(["sweep", *words, "amplitude=a,b"]) == 2
    assert "amplitude has 'a', which is not a number" in capsys.readouterr().err
    assert main(["sweep", *words, "amplitude=0.02,0.03"]) == 2
    assert "pyarrow" in capsys.readouterr().err
