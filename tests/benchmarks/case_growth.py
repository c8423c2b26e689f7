"""Work that grows: robots with many joints, models and pictures with many blocks, many poses."""

from __future__ import annotations

from .measure import Contest

SIZES = (
    # work, task, arguments by size, sizes, the largest that the older checkout does in time
    ("check, random chain of {} joints", "check", {}, "joints", (6, 12, 20, 30), 12),
    (
        "compare, mechanical chain of {} blocks",
        "compare",
        {"model": "mechanical_chain"},
        "size",
        (500, 1000, 2000),
        500,
    ),
    (
        "compare, {} blocks of parallel signals",
        "compare",
        {"model": "parallel_signals"},
        "size",
        (5000, 20_000),
        5000,
    ),
    ("diagram, {} blocks wired at random", "picture", {"inputs": 2}, "count", (20, 60, 300), 60),
    ("poses and Jacobians of the chain, {}", "poses", {}, "count", (1_000_000, 10_000_000), 10**6),
)


def contests(short, crew):
    """Each size, once; the older checkout takes part as far as it comes."""
    if short:
        return []
    made = []
    for work, task, arguments, parameter, sizes, most in SIZES:
        for size in sizes:
            members = crew.contest_of(task, **arguments, **{parameter: size})
            peers = members["peers"] if size <= most else []
            name = work.format(f"{size:,}".replace(",", " "))
            made.append(Contest(name=name, work=name, repeats=1, ours=members["ours"], peers=peers))
    return made
