"""Blocks that are replaced by a constant or by a table of time and values."""

from __future__ import annotations

import numpy as np

from drake_leg.simulink.running.code import Writer
from drake_leg.simulink.running.kinds import kind, no_inputs
from drake_leg.simulink.running.replacing import REPLACED
from drake_leg.simulink.running.settings import as_signal

MOST_BREAKS = 10_000


@kind(REPLACED, direct=no_inputs, continuous=True, sample_time="")
def replaced(w: Writer) -> None:
    """Put out a constant at all outputs, or a table, linear between its rows."""
    table = w.settings.block.parameters.get("Table")
    if table is None:
        value = as_signal(w.settings.matrix("Value"))
        for place in range(len(w.node.outputs)):
            w.out(w.constant(value), place)
        return
    rows = np.array(table)
    times, values = rows[:, 0], rows[:, 1:]
    outputs = len(w.node.outputs)
    if outputs not in (0, 1, values.shape[1]):
        raise w.fault(
            f"has {outputs} outputs, and the table that replaces it has {values.shape[1]} columns "
            "of values: give it as many"
        )
    if times.size <= MOST_BREAKS:
        w.pen.breaks |= set(times.tolist())
    at = w.constant(times, "times")
    columns = [f"float(np.interp(t, {at}, {w.constant(column, 'column')}))" for column in values.T]
    if outputs == 1 and len(columns) > 1:
        w.out(f"array([{', '.join(columns)}])")
        return
    for place, column in enumerate(columns[:outputs]):
        w.out(column, place)
