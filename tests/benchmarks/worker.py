"""A process that carries out work of this checkout or of another one, when it is asked to.

Started with the checkout on ``PYTHONPATH``. Each line of the standard input is a task in JSON, each
line of the standard output its answer. It uses only what both checkouts have.
"""

import contextlib
import io
import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

AXES = ("x", "y", "z")
FIGURE = "b09"  # of the report: positions of the foot
DIFFERENT = 1  # status of a comparison that was carried out, of a model that is not the leg's


def run_of(robot, options):
    """Carry out a run from its options to its summary; also the motion of the foot."""
    from drake_leg import run

    began = time.process_time()
    done = run(robot, **options)
    seconds = time.process_time() - began
    recording = done.recording
    return {
        "seconds": seconds,
        "disturbance": done.summary["disturbance"],
        "time": recording["time"].tolist(),
        "foot": [recording[name].tolist() for name in AXES],
        "speed": [recording[f"v{name}"].tolist() for name in AXES],
    }


def command(words):
    """Carry out a command of the program in a process of its own; its time by the wall."""
    with tempfile.TemporaryDirectory() as folder:
        began = time.perf_counter()
        done = subprocess.run(
            [sys.executable, "-P", "-m", "drake_leg", *words],
            cwd=folder,
            capture_output=True,
            text=True,
        )
        seconds = time.perf_counter() - began
    return {"seconds": seconds, "status": done.returncode, "said": done.stderr[-500:]}


def imports_of(modules):
    """Import modules in a process of its own; its time by the wall."""
    began = time.perf_counter()
    subprocess.run([sys.executable, "-P", "-c", f"import {', '.join(modules)}"], check=True)
    return {"seconds": time.perf_counter() - began}


def figure_of():
    """Make one figure of the report, in all its files and for its page."""
    from drake_leg.lab.page.contents import RUNS
    from drake_leg.lab.page.items import ItemMaker, ShownItem
    from drake_leg.lab.page.page import ITEMS

    (item,) = (item for item in ITEMS if item.id == FIGURE)
    with tempfile.TemporaryDirectory() as folder:
        outcomes = {item.subject: RUNS[item.subject].carry_out()}
        maker = ItemMaker(folder=Path(folder), outcomes=outcomes)
        return _took(lambda: maker.make(item), lambda made: isinstance(made, ShownItem))


def check_of(joints):
    """Prove a random chain of so many joints."""
    import numpy as np
    from chains import random_chain

    from drake_leg import prove

    robot, _ = random_chain(np.random.default_rng(joints), joints)
    return _took(lambda: prove(robot), lambda proof: proof.holds)


def compare_of(model, size):
    """Compare a drawn Simulink model of a size with leg B."""
    import large_models

    from drake_leg.cli import main

    with tempfile.TemporaryDirectory() as folder:
        file = getattr(large_models, model)(size).write(Path(folder, "model.slx"))
        words = ["compare", str(file), "leg-b"]
        return _took(lambda: main(words), lambda status: status == DIFFERENT)


def picture_of(count, inputs):
    """Draw so many adders whose inputs come from blocks chosen at random."""
    import numpy as np
    from pydrake.systems.framework import DiagramBuilder
    from pydrake.systems.primitives import Adder, Integrator

    from drake_leg import block_diagram

    chance, builder = np.random.default_rng(count), DiagramBuilder()
    source = builder.AddNamedSystem("Source", Integrator([0.0]))
    outputs = [source.get_output_port()]
    for index in range(count - 1):
        adder = builder.AddNamedSystem(f"Sum {index}", Adder(inputs, 1))
        for place in range(inputs):
            origin = outputs[int(chance.integers(len(outputs)))]
            builder.Connect(origin, adder.get_input_port(place))
        outputs.append(adder.get_output_port())
    builder.Connect(outputs[-1], source.get_input_port())
    diagram = builder.Build()
    return _took(lambda: block_diagram(diagram), lambda drawn: f"Sum {count - 2}" in drawn.svg)


def poses_of(count):
    """Compute so many poses and Jacobians of leg B's chain; greatest memory of the process."""
    import resource

    import numpy as np

    from drake_leg.kinematics.khalil import foot_pose, jacobian
    from drake_leg.robot.robots import LEG_B

    q = np.random.default_rng(0).uniform(-3.0, 3.0, (count, 3))

    def both():
        foot_pose(LEG_B.rows, q)
        jacobian(LEG_B.rows, q)

    took = _took(both)
    return {**took, "megabytes": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0}


def memory_of(count):
    """Carry out so many runs, and tell by how much they have grown after the first tenth [MiB]."""
    from benchmarks.memory import megabytes

    from drake_leg import run

    def repeat(times):
        for _ in range(times):
            run("leg-b", dynamics="none", duration=0.5)

    repeat(count // 10)
    first = megabytes()
    took = _took(lambda: repeat(count - count // 10))
    return {**took, "grown": megabytes() - first}


def _took(work, is_right=lambda answer: True):
    """Time some work, and refuse a wrong answer."""
    began = time.process_time()
    answer = work()
    seconds = time.process_time() - began
    if not is_right(answer):
        raise RuntimeError(f"the answer is wrong: {answer!r}")
    return {"seconds": seconds}


TASKS = {
    "run": run_of,
    "command": command,
    "check": check_of,
    "compare": compare_of,
    "picture": picture_of,
    "poses": poses_of,
    "memory": memory_of,
    "figure": figure_of,
    "imports": imports_of,
}


def main():
    """Answer until the input ends."""
    for line in sys.stdin:
        task = json.loads(line)
        with contextlib.redirect_stdout(io.StringIO()):
            try:
                answer = TASKS[task["task"]](**task["arguments"])
            except Exception as error:  # an older checkout may not know the option
                answer = {"failed": f"{type(error).__name__}: {error}"}
        print(json.dumps(answer), flush=True)


if __name__ == "__main__":
    os.environ.setdefault("MPLBACKEND", "agg")
    main()
