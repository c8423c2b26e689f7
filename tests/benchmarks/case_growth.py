"""Work that grows: robots with many joints, models and pictures with many blocks, many poses."""

from __future__ import annotations

from .measure import Contest, scaled

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


# Work whose time grows no faster than its size, and a size of each.
QUARTER = 4
GROWING = (
    ("compare, mechanical chain", "compare", {"model": "mechanical_chain"}, "size", 1000),
    ("compare, parallel signals", "compare", {"model": "parallel_signals"}, "size", 4000),
    ("diagram, wired at random", "picture", {"inputs": 2}, "count", 80),
    ("check, random chain", "check", {}, "joints", 12),
    ("poses and Jacobians", "poses", {}, "count", 200_000),
)
MOST_MEMORY = 2e9 / 2**20  # [MiB], of ten million poses
RUNS, FEW_RUNS = 2000, 300  # in one process
MOST_GROWN = 1.0  # [MiB], over all but the first tenth of them


def contests(short, crew):
    """How work and memory grow; then each size once, the older checkout as far as it comes."""
    made = [_growth(crew, *kind) for kind in GROWING]
    made.append(_memory_of_runs(crew, FEW_RUNS if short else RUNS))
    return made if short else made + list(_sizes(crew))


def _growth(crew, work, task, arguments, parameter, size):
    """A size against a quarter of it, whose time is multiplied by four."""

    def whole():
        return crew.ours.contender("drake-leg", task, **arguments, **{parameter: size})

    def quarter():
        least = {parameter: size // QUARTER}
        part = crew.ours.contender("a quarter of it, four times", task, **arguments, **least)
        return scaled(part, QUARTER)

    name = f"growth: {work}"
    return Contest(name=name, work=work, ours=whole, peers=[quarter])


def _memory_of_runs(crew, count):
    """Many runs in one process, whose memory may not grow."""
    return Contest(
        name=f"memory: {count} runs",
        work="runs of leg B in one process",
        unit="MiB",
        allowed=MOST_GROWN,
        repeats=1,
        ours=lambda: crew.ours.contender(
            "drake-leg", "memory", error=lambda answer: answer["grown"], count=count
        ),
        peers=[],
    )


def _sizes(crew):
    """Each size of each kind of work."""
    for work, task, arguments, parameter, sizes, most in SIZES:
        for size in sizes:
            name = work.format(f"{size:,}".replace(",", " "))
            members = crew.contest_of(task, error=_memory, **arguments, **{parameter: size})
            peers = members["peers"] if size <= most else []
            limits = MEMORY if task == "poses" else {}
            yield Contest(
                name=name, work=name, repeats=1, ours=members["ours"], peers=peers, **limits
            )


MEMORY = {"unit": "MiB", "allowed": MOST_MEMORY, "enough": MOST_MEMORY}


def _memory(answer):
    """Greatest memory of the process [MiB], where it is told."""
    return answer.get("megabytes", 0.0)
