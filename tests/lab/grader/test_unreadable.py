"""What cannot be read is answered with what to write, and never called wrong."""

import tomllib
from pathlib import Path

import numpy as np
import pytest
from work import calls

from drake_leg.errors import InvalidValueError
from drake_leg.lab.grader.grade import grade
from drake_leg.lab.grader.printed import printed_of_document
from drake_leg.robot.robots import LEG_B

HERE = Path(__file__).parent
TEXTS = tomllib.loads((HERE / "unreadable.toml").read_text(encoding="utf-8"))
UNITS = {"lengths": "mm", "angles": "deg"}
TABLE = "i|σ|d|α|r|θ\n1|0|0|0|0|θ1\n2|0|{}|90|0|θ2\n3|0|100|0|0|θ3\n4|~|100|0|0|0"
T12 = [["c2", "-s2", "0", "50"], ["0", "0", "-1", "0"], ["s2", "c2", "0", "0"]]


def graded(**parts):
    return grade(LEG_B, printed_of_document({**UNITS, **parts}, "print.toml"))


def in_place_of(kind, text):
    """Put a text where it cannot be read."""
    if kind == "cell":
        return graded(table=TABLE.format(text))
    if kind == "name":
        return graded(matrix=[{"name": text, "entries": T12}])
    return graded(matrix=[{"name": "P12", "entries": [[text], ["0"], ["0"]]}])


@pytest.mark.parametrize(
    ("kind", "text", "said"),
    [
        pytest.param(kind, text, said, id=f"{kind}: {text}")
        for kind, texts in TEXTS.items()
        for text, said in texts.items()
    ],
)
def test_what_cannot_be_read_is_not_called_wrong(kind, text, said):
    (finding,) = in_place_of(kind, text)
    assert not finding.understood
    assert said in finding.sentence()
    assert "\\\\" not in finding.sentence()


PIECES = (  # noqa: SIM905 - read best as they are typed
    r"\frac \dfrac { } ( ) _ ^ c s cos sin θ q 1 2 23 . , + - * / \theta \left( \right) \mathrm{ "
    r"\sqrt √ ½ ² ₁ L l1 ° \circ ... [ ] = | \ $ e 1e9 ^{ _{ t (t) 9 0 \operatorname np. deg \\ & "
    r"\begin{bmatrix} \end{bmatrix} ; Matrix( ⎡ ⎦ k or and π"
).split()


def seeded_texts(count):
    rng = np.random.default_rng(5)
    lengths = rng.choice([3, 10, 40, 300], count)
    return ["".join(rng.choice(PIECES, length)) for length in lengths]


def answered(parts):
    """Return the sentences about a print, also where it is refused as a whole."""
    try:
        return [finding.sentence() for finding in graded(**parts)]
    except InvalidValueError as error:
        return [str(error)]


@pytest.mark.slow
def test_any_text_is_answered_in_a_sentence():
    for text in seeded_texts(100):
        for parts in (
            {"matrix": [{"name": "P12", "entries": [[text], ["0"], ["0"]]}]},
            {"matrix": [{"name": "T12", "entries": text}]},
        ):
            assert all("\n" not in sentence for sentence in answered(parts))


@pytest.mark.parametrize(
    "piece", ["(", "{", "_{", r"\frac{", "^{", "1+", "-", "c1", "½", "²", "^2_1"]
)
def test_long_nonsense_is_refused_at_once(piece):
    def grade():
        (finding,) = in_place_of("entry", piece * (4000 // len(piece)))
        assert not finding.understood
        assert len(finding.fault) < 300

    assert calls(grade) < 100_000
