"""Report B's matrices as printed, and as they are, in the report's symbols and millimetres.

Only those that are wrong stand here, and those that are needed to multiply them through.
"""

from __future__ import annotations

from drake_leg.errata.formulas import BOTTOM, Formula

SCARA_PRINTED: dict[str, Formula] = {
    "T01": (
        ("cos(θ1)", "-sin(θ1)", "0", "0"),
        ("sin(θ1)", "cos(θ1)", "0", "0"),
        ("0", "0", "1", "0"),
        BOTTOM,
    ),
    "T12": (
        ("cos(θ2)", "-sin(θ2)", "0", "220"),
        ("sin(θ2)", "cos(θ2)", "0", "0"),
        ("0", "1", "0", "0"),
        BOTTOM,
    ),
    "T34": (
        ("1", "0", "1", "0"),
        ("0", "1", "0", "1"),
        ("0", "0", "-1", "452.4 - 340 - R"),
        BOTTOM,
    ),
    "T03": (
        ("cos(θ123)", "-sin(θ123)", "0", "220*cos(θ1) + 240*cos(θ12)"),
        ("sin(θ123)", "cos(θ123)", "0", "220*sin(θ1) + 240*sin(θ12)"),
        ("0", "0", "1", "0"),
        BOTTOM,
    ),
}

SCARA_RIGHT: dict[str, Formula] = {
    "T01": (
        ("cos(θ1)", "-sin(θ1)", "0", "0"),
        ("sin(θ1)", "cos(θ1)", "0", "0"),
        ("0", "0", "1", "452.4"),
        BOTTOM,
    ),
    "T12": (
        ("cos(θ2)", "-sin(θ2)", "0", "220"),
        ("sin(θ2)", "cos(θ2)", "0", "0"),
        ("0", "0", "1", "0"),
        BOTTOM,
    ),
    "T23": (
        ("cos(θ3)", "-sin(θ3)", "0", "240"),
        ("sin(θ3)", "cos(θ3)", "0", "0"),
        ("0", "0", "1", "0"),
        BOTTOM,
    ),
    "T34": (
        ("1", "0", "0", "0"),
        ("0", "-1", "0", "0"),
        ("0", "0", "-1", "R - 112.4"),
        BOTTOM,
    ),
    "T03": (
        ("cos(θ123)", "-sin(θ123)", "0", "220*cos(θ1) + 240*cos(θ12)"),
        ("sin(θ123)", "cos(θ123)", "0", "220*sin(θ1) + 240*sin(θ12)"),
        ("0", "0", "1", "452.4"),
        BOTTOM,
    ),
}

# Table 2.2: number, σ, d, α, r, θ. The number's column is right, the others' headings are not.
LEG_B_TABLE_PRINTED: Formula = (
    ("1", "0", "0", "0", "0", "θ1"),
    ("2", "L1", "90°", "0", "0", "θ2"),
    ("3", "L2", "0", "0", "0", "θ3"),
    ("4", "L3", "0", "0", "0", "0"),
)
LEG_B_TABLE_RIGHT: Formula = (
    ("1", "0", "0", "0", "0", "θ1"),
    ("2", "0", "L1", "90°", "0", "θ2"),
    ("3", "0", "L2", "0", "0", "θ3"),
    ("4", "~", "L3", "0", "0", "0"),
)

LEG_B_PRINTED: dict[str, Formula] = {
    "T12": (
        ("cos(θ2)", "0", "sin(θ2)", "L1"),
        ("0", "0", "-1", "0"),
        ("sin(θ2)", "0", "-cos(θ2)", "0"),
        BOTTOM,
    ),
    "T34": (
        ("1", "0", "1", "L3"),
        ("0", "1", "0", "1"),
        ("0", "0", "1", "0"),
        BOTTOM,
    ),
    "T04": (
        ("cos(θ2 - θ3)*cos(θ1)", "sin(θ2 - θ3)*cos(θ1)", "sin(θ1)", "50*cos(θ1)*σ1"),
        ("cos(θ2 - θ3)*sin(θ1)", "sin(θ2 - θ3)*sin(θ1)", "-cos(θ1)", "50*sin(θ1)*σ1"),
        ("sin(θ2 + θ3)", "cos(θ2 + θ3)", "0", "100*sin(θ2 + θ3) + 100*sin(θ2)"),
        BOTTOM,
    ),
    "J": (
        ("-50*sin(θ1)*σ1", "-50*cos(θ1)*σ2", "100*sin(θ2 - θ3)*cos(θ1)"),
        ("50*cos(θ1)*σ1", "-50*sin(θ1)*σ2", "100*sin(θ2 - θ3)*sin(θ1)"),
        ("0", "100*cos(θ2 + θ3) + 100*cos(θ2)", "100*cos(θ2 + θ3)"),
    ),
}

LEG_B_RIGHT: dict[str, Formula] = {
    "T01": (
        ("cos(θ1)", "-sin(θ1)", "0", "0"),
        ("sin(θ1)", "cos(θ1)", "0", "0"),
        ("0", "0", "1", "0"),
        BOTTOM,
    ),
    "T12": (
        ("cos(θ2)", "-sin(θ2)", "0", "L1"),
        ("0", "0", "-1", "0"),
        ("sin(θ2)", "cos(θ2)", "0", "0"),
        BOTTOM,
    ),
    "T23": (
        ("cos(θ3)", "-sin(θ3)", "0", "L2"),
        ("sin(θ3)", "cos(θ3)", "0", "0"),
        ("0", "0", "1", "0"),
        BOTTOM,
    ),
    "T34": (
        ("1", "0", "0", "L3"),
        ("0", "1", "0", "0"),
        ("0", "0", "1", "0"),
        BOTTOM,
    ),
    "T04": (
        ("cos(θ2 + θ3)*cos(θ1)", "-sin(θ2 + θ3)*cos(θ1)", "sin(θ1)", "50*cos(θ1)*σ1"),
        ("cos(θ2 + θ3)*sin(θ1)", "-sin(θ2 + θ3)*sin(θ1)", "-cos(θ1)", "50*sin(θ1)*σ1"),
        ("sin(θ2 + θ3)", "cos(θ2 + θ3)", "0", "100*sin(θ2 + θ3) + 100*sin(θ2)"),
        BOTTOM,
    ),
    "J": (
        ("-50*sin(θ1)*σ1", "-50*cos(θ1)*σ2", "-100*sin(θ2 + θ3)*cos(θ1)"),
        ("50*cos(θ1)*σ1", "-50*sin(θ1)*σ2", "-100*sin(θ2 + θ3)*sin(θ1)"),
        ("0", "100*cos(θ2 + θ3) + 100*cos(θ2)", "100*cos(θ2 + θ3)"),
    ),
}

# The abbreviations σ1 and σ2 of T04 and J.
LEG_B_SIGMAS_PRINTED = {
    "σ1": "2*cos(θ2 - θ3) + 2*cos(θ2) + 1",
    "σ2": "2*sin(θ2 - θ3) + 2*sin(θ2)",
}
LEG_B_SIGMAS_RIGHT = {
    "σ1": "2*cos(θ2 + θ3) + 2*cos(θ2) + 1",
    "σ2": "2*sin(θ2 + θ3) + 2*sin(θ2)",
}

# j12 in the list of entries before J; the list's other entries are those of the matrix.
LEG_B_J12_PRINTED = "-50*cos(θ1)*(2*sin(θ2 - θ3) + 2*sin(θ2) + 1)"
LEG_B_J12_RIGHT = "-50*cos(θ1)*(2*sin(θ2 + θ3) + 2*sin(θ2))"
