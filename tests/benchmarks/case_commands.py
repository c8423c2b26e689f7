"""Commands of the program, each in a process of its own."""

from __future__ import annotations

from .measure import Contest

FEW = 3  # repeats of what takes long


def contests(short, crew):
    """Each command against the older checkout; without one, against nothing."""
    if short:
        return []
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
