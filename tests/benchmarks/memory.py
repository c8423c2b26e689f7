"""``python tests/benchmarks/memory.py [RUNS [DYNAMICS]]``: memory over many runs of leg B."""

import sys
from pathlib import Path

from drake_leg import run

RUNS = 10_000
PRINTED = (10, 100, 1_000, 5_000, RUNS)


def megabytes():
    """Resident memory of this process [MiB]; Linux."""
    lines = Path("/proc/self/status").read_text(encoding="ascii").splitlines()
    (resident,) = (line.split()[1] for line in lines if line.startswith("VmRSS"))
    return int(resident) / 1024.0


def main(runs=RUNS, dynamics="none"):
    for number in range(1, runs + 1):
        run("leg-b", dynamics=dynamics, duration=0.5)
        if number in PRINTED or number == runs:
            print(f"{number} runs: {megabytes():.1f} MiB", flush=True)


if __name__ == "__main__":
    main(*map(int, sys.argv[1:2]), *sys.argv[2:3])
