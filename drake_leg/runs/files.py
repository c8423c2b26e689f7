"""A run's outcome as files: recording, summary, figures."""

from __future__ import annotations

import json
from pathlib import Path

from drake_leg.figures.of_runs import figures_of_run
from drake_leg.figures.style import save
from drake_leg.runs.outcome import Outcome


def write_outcome(folder: Path, name: str, title: str, outcome: Outcome) -> None:
    """Write ``recording.csv``, ``summary.json`` and the run's figures.

    Parameters
    ----------
    folder : Path
        Existing, to be written into.
    name : str
        Of the run, as on the command line.
    title : str
        Of the run, for the figures.
    outcome : Outcome
        What it left.

    Raises
    ------
    OutputError
        If the recording cannot be written.
    OSError
        If the summary or a figure cannot be written.
    """
    outcome.recording.write_csv(folder / "recording.csv")
    summary = json.dumps({"run": name, **outcome.summary}, indent=2, allow_nan=False)
    (folder / "summary.json").write_text(summary + "\n", encoding="utf-8")
    for file_name, draw in figures_of_run(
        outcome.subject, title, outcome.robot, outcome.recording, outcome.summary
    ):
        save(draw(), folder, file_name)
