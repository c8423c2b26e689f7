"""Advice in the words of a text print, which has lines and no TOML tables."""

from __future__ import annotations

import re
from dataclasses import replace

from drake_leg.check.findings import Finding

_WORDS = {
    r"a number under \[symbols\], a formula under \[where\]": "a number or a formula in a line of "
    "its own, as a = 50",
    r"under \[symbols\]": "in a line of its own, as L1 = 50",
    r"under \[where\]": "in a line of its own, as a = c1 + c2",
    r"cells = \{ (\S+) = \"(\w+)\" \}": r"cells,\1,\2",
    r"under rows(?![\w,])": "in a line as rows,J,x y z",
}


def in_words_of_text(finding: Finding) -> Finding:
    """Say what a line of text says, for what a table of TOML would.

    Parameters
    ----------
    finding : Finding
        With advice for TOML.
    """
    fault, remedy = finding.fault, finding.remedy
    for words, instead in _WORDS.items():
        fault, remedy = re.sub(words, instead, fault), re.sub(words, instead, remedy)
    return replace(finding, fault=fault, remedy=remedy)
