"""The reports' formulas, corrected, as text that is both shown and evaluated.

``s`` is -1 for leg A and +1 for leg B; angles are q1 ... q3, their cosines and sines c1, s1,
c2, s2, c23 = cos(q2 + q3) and so on.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from html import escape

from drake_leg.errata.formulas import BOTTOM, Formula
from drake_leg.kinematics.leg import LegGeometry
from drake_leg.kinematics.scara import ScaraGeometry

LEG_TRANSFORMS: dict[str, Formula] = {
    "T01": (("c1", "-s1", "0", "0"), ("s1", "c1", "0", "0"), ("0", "0", "1", "0"), BOTTOM),
    "T12": (("c2", "-s2", "0", "l1"), ("0", "0", "-s", "0"), ("s*s2", "s*c2", "0", "0"), BOTTOM),
    "T23": (("c3", "-s3", "0", "l2"), ("s3", "c3", "0", "0"), ("0", "0", "1", "0"), BOTTOM),
    "T34": (("1", "0", "0", "l3"), ("0", "1", "0", "0"), ("0", "0", "1", "0"), BOTTOM),
    "T02": (
        ("c1*c2", "-c1*s2", "s*s1", "c1*l1"),
        ("s1*c2", "-s1*s2", "-s*c1", "s1*l1"),
        ("s*s2", "s*c2", "0", "0"),
        BOTTOM,
    ),
    "T03": (
        ("c1*c23", "-c1*s23", "s*s1", "c1*(l1 + l2*c2)"),
        ("s1*c23", "-s1*s23", "-s*c1", "s1*(l1 + l2*c2)"),
        ("s*s23", "s*c23", "0", "s*l2*s2"),
        BOTTOM,
    ),
    "T04": (
        ("c1*c23", "-c1*s23", "s*s1", "c1*(l1 + l2*c2 + l3*c23)"),
        ("s1*c23", "-s1*s23", "-s*c1", "s1*(l1 + l2*c2 + l3*c23)"),
        ("s*s23", "s*c23", "0", "s*(l2*s2 + l3*s23)"),
        BOTTOM,
    ),
}

LEG_JACOBIAN: Formula = (
    ("-s1*(l1 + l2*c2 + l3*c23)", "-c1*(l2*s2 + l3*s23)", "-c1*l3*s23"),
    ("c1*(l1 + l2*c2 + l3*c23)", "-s1*(l2*s2 + l3*s23)", "-s1*l3*s23"),
    ("0", "s*(l2*c2 + l3*c23)", "s*l3*c23"),
)

LEG_DETERMINANT = "-s*l2*l3*s3*(l1 + l2*c2 + l3*c23)"

SCARA_TRANSFORMS: dict[str, Formula] = {
    "T01": (("c1", "-s1", "0", "0"), ("s1", "c1", "0", "0"), ("0", "0", "1", "h"), BOTTOM),
    "T12": (("c2", "-s2", "0", "l1"), ("s2", "c2", "0", "0"), ("0", "0", "1", "0"), BOTTOM),
    "T23": (("c3", "-s3", "0", "l2"), ("s3", "c3", "0", "0"), ("0", "0", "1", "0"), BOTTOM),
    "T34": (("1", "0", "0", "0"), ("0", "-1", "0", "0"), ("0", "0", "-1", "-q4"), BOTTOM),
    "T03": (
        ("c123", "-s123", "0", "l1*c1 + l2*c12"),
        ("s123", "c123", "0", "l1*s1 + l2*s12"),
        ("0", "0", "1", "h"),
        BOTTOM,
    ),
}

SCARA_JACOBIAN: Formula = (
    ("-l1*s1 - l2*s12", "-l2*s12", "0"),
    ("l1*c1 + l2*c12", "l2*c12", "0"),
    ("1", "1", "1"),
)

SCARA_DETERMINANT = "l1*l2*s2"


def leg_symbols(leg: LegGeometry, q: Sequence[float]) -> dict[str, float]:
    """Give the leg's symbols their values.

    Parameters
    ----------
    leg : LegGeometry
        Lengths and variant.
    q : (3,) sequence of float
        Angles [rad].

    Returns
    -------
    dict
        Symbol to value; lengths in m.
    """
    q1, q2, q3 = q
    lengths = {"s": float(leg.sign), "l1": leg.l1, "l2": leg.l2, "l3": leg.l3}
    return lengths | _trigonometry({"1": q1, "2": q2, "3": q3, "23": q2 + q3})


def scara_symbols(arm: ScaraGeometry, q: Sequence[float]) -> dict[str, float]:
    """Give the SCARA's symbols their values.

    Parameters
    ----------
    arm : ScaraGeometry
        Lengths.
    q : (4,) sequence of float
        Three angles [rad] and the lift [m].

    Returns
    -------
    dict
        Symbol to value; lengths in m.
    """
    q1, q2, q3, q4 = q
    lengths = {"l1": arm.l1, "l2": arm.l2, "h": arm.height, "q4": q4}
    angles = {"1": q1, "2": q2, "3": q3, "12": q1 + q2, "123": q1 + q2 + q3}
    return lengths | _trigonometry(angles)


def _trigonometry(angles: Mapping[str, float]) -> dict[str, float]:
    cosines = {f"c{name}": math.cos(angle) for name, angle in angles.items()}
    return cosines | {f"s{name}": math.sin(angle) for name, angle in angles.items()}


def as_html(entry: str) -> str:
    """Show a formula: products without a sign, digits as subscripts.

    Parameters
    ----------
    entry : str
        Sums and products of the symbols.

    Returns
    -------
    str
        HTML.
    """
    text = re.sub(r"([a-z])(\d+)", r"<i>\1</i><sub>\2</sub>", escape(entry))
    text = re.sub(r"\b([sh])\b(?!<)", r"<i>\1</i>", text.replace("<i>", "\0").replace("</i>", "\1"))
    text = text.replace("\0", "<i>").replace("\1", "</i>")
    return text.replace("*", "&#8201;").replace("-", "&minus;")
