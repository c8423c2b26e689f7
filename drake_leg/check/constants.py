"""Lengths that a print declares among its definitions: L2 = 100, or L2 = 2*L1."""

from __future__ import annotations

import re
from collections.abc import Collection
from dataclasses import replace

from drake_leg.check.expressions import evaluate, names_in
from drake_leg.check.notation import plain
from drake_leg.check.printed_file import Printed
from drake_leg.check.reader import Reader
from drake_leg.robot import Robot


def with_lengths_as_symbols(printed: Printed, robot: Robot) -> Printed:
    """Move numbers, and lengths given by others, from the definitions to the symbols.

    Parameters
    ----------
    robot : Robot
        Whose print it is.

    Returns
    -------
    Printed
        In which a definition such as sigma1 stays one.

    Raises
    ------
    InvalidValueError
        If a definition is no formula.
    """
    reader = Reader(printed, robot)
    symbols = dict(printed.symbols)
    for name, text in printed.where.items():
        tree = reader.formula(text)
        names = names_in(tree)
        if names <= set(reader.symbols) and (not names or _is_sibling(plain(name), names)):
            symbols[name] = float(evaluate(tree, reader.symbols))
    where = {name: text for name, text in printed.where.items() if name not in symbols}
    return replace(printed, symbols=symbols, where=where)


def _is_sibling(name: str, others: Collection[str]) -> bool:
    """Whether a name differs from another by its number only: L2 and L1."""
    letters = {re.sub(r"\d+$", "", other) for other in others}
    return bool(re.search(r"\d$", name)) and re.sub(r"\d+$", "", name) in letters
