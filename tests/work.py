"""Work that is counted, for a clock says more of the machine than of the program."""

import sys


def calls(task):
    """Return how many functions Python calls, its own and those in C, while a task is done."""
    count = 0

    def note(frame, event, argument):
        nonlocal count
        count += event in ("call", "c_call")

    before = sys.getprofile()
    sys.setprofile(note)
    try:
        task()
    finally:
        sys.setprofile(before)
    return count
