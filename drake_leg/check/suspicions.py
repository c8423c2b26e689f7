"""Everything that is possible in a robot file and seldom meant."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from drake_leg.check.findings import Finding
from drake_leg.check.rows import table_of_document
from drake_leg.check.sizes import lint_sizes
from drake_leg.check.table import lint_table
from drake_leg.robot import Robot


def suspicions(document: Mapping[str, Any], robot: Robot) -> list[Finding]:
    """Look a robot file through.

    Parameters
    ----------
    document : mapping
        The file as nested tables.
    robot : Robot
        What was read from it.

    Returns
    -------
    list of Finding
        Of the table as it stands, then of the solids.
    """
    return [*lint_table(table_of_document(document)), *lint_sizes(robot)]
