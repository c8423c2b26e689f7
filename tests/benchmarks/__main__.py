"""``python tests/benchmarks``: measure this package against its peers."""

import os
import sys
from pathlib import Path

for threads in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ.setdefault(threads, "1")  # before NumPy is imported

TESTS = Path(__file__).resolve().parents[1]
sys.path[0] = str(TESTS)

from benchmarks.command import main  # noqa: E402 - after the path and the environment are set

if __name__ == "__main__":
    sys.exit(main())
