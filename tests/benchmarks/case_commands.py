"""Commands of the program, each in a process of its own; a figure of the report."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from .measure import Contest, timed

FEW = 3  # repeats of what takes long
LOADED = ("numpy", "pydrake.multibody.plant", "pydrake.systems.analysis")
WIDE, NARROW = (6.4, 3.6), (4.6, 3.1)  # [inch]


def contests(short, crew):
    """What commands add to what they load; then each against the older checkout, if there is one.

    A figure of the report is made beside one of plain Matplotlib with as many curves and files.
    """
    figure = Contest(
        name="report: a figure",
        work="a figure as SVG for wide and narrow pages, as PDF and as PNG",
        ours=lambda: crew.ours.contender("drake-leg", "figure"),
        peers=[plain_figure],
    )
    run = ["run", "leg-b", "--out", "step", "--figures", "none"]
    doctor = ["doctor", "leg-b", "--q", "90,-50,-90"]
    quick = [figure, _beside(crew, "run", run, LOADED), _beside(crew, "doctor", doctor, ["numpy"])]
    return quick if short else quick + _each(crew)


def _beside(crew, name, words, modules):
    """A command beside the import of modules that it cannot do without."""

    def ours():
        return crew.ours.contender("drake-leg", "command", error=status, words=words)

    def loading():
        return crew.ours.contender("Python, which loads what it needs", "imports", modules=modules)

    work = f"drake-leg {' '.join(words)}"
    return Contest(name=f"start: {name}", work=work, ours=ours, peers=[loading])


def plain_figure():
    """Three curves by Matplotlib: laid out and drawn for each file."""
    time = np.linspace(0.0, 10.0, 300)

    def draw(_):
        figure = Figure(figsize=WIDE, layout="constrained")
        axes = figure.subplots()
        for phase, name in enumerate(("$v_x$", "$v_y$", "$v_z$")):
            axes.plot(time, np.sin(time + phase), label=name)
        axes.set(xlabel="time t [s]", ylabel="velocity of the foot [m/s]")
        axes.grid()
        axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=3)
        figure.suptitle("A figure")
        with tempfile.TemporaryDirectory() as folder:
            for ending in ("svg", "pdf", "png"):
                figure.savefig(Path(folder, f"wide.{ending}"), dpi=150)
            figure.set_size_inches(NARROW)
            figure.savefig(Path(folder, "narrow.svg"))

    return timed("plain Matplotlib", draw, error=lambda _: 0.0)


def _each(crew):
    run = ["run", "leg-b", "--out", "step"]
    commands = [
        ("run, no figures", [*run, "--figures", "none"], run, None),
        ("run, PNG", [*run, "--figures", "png"], run, None),
        ("doctor", ["doctor", "leg-b", "--q", "90,-50,-90"], None, None),
        ("report", ["report", "--out", "report"], None, FEW),
    ]
    return [
        Contest(
            name=f"command: {name}",
            work=f"drake-leg {' '.join(words)}",
            repeats=repeats,
            **crew.contest_of("command", error=status, words=words, old={"words": old or words}),
        )
        for name, words, old, repeats in commands
    ]


def status(answer):
    """Refuse a command that failed."""
    if answer["status"]:
        raise RuntimeError(f"a command failed: {answer['said']}")
    return 0.0
