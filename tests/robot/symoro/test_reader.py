"""SYMORO's files as data: old and new spellings, comments, broken lists, arithmetic, faults."""

import re
from contextlib import suppress
from fractions import Fraction
from math import atan2, pi
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drake_leg.errors import InvalidValueError
from drake_leg.robot.symoro.arithmetic import evaluate, parse_arithmetic
from drake_leg.robot.symoro.as_robot import robot_of_par
from drake_leg.robot.symoro.reader import load_par, read_par

SAMPLES = Path(__file__).parents[3] / "examples" / "symoro"
TREE = (SAMPLES / "two-fingers.par").read_text(encoding="utf-8")
LOOP = (SAMPLES / "parallelogram-arm.par").read_text(encoding="utf-8")

ARM = """(* Robotname = 'Arm' *)
NL = 3
NJ = 3
NF = 3
Type = 0 (* simple *)
ant = {0,1,2}
sigma = {0,1,0}
mu = {1,1,0}
gamma = {0,0,0}
b = {0,0,0}
alpha = {0,-Pi/2,-atan2(H, D3) + pi}
d = {0,0,sqrt(H**2 + D3^2)}
theta = {th1,0,th3 - Pi/2}
r = {H,r2 + 0.1,0}
XX = {XX1,XX2,XX3}
G = {0,0,G3}
"""

OLDER = (
    ARM.replace("ant =", "Ant =")
    .replace("sigma", "Sigma")
    .replace("mu =", "Mu =")
    .replace("b =", "B =")
    .replace("alpha =", "Alpha =")
    .replace("theta =", "Theta =")
    .replace("r = ", "R  = ")
    .replace("Pi", "pi")
    .replace("ant = {0", "ant = {\n\t0")
    .replace("{th1,", "{th1,\r\n    ")
    .replace("NL = 3\n", "(* a comment\nover lines, with NL = 7 *)\r\nNL = 3\r\n")
)


def same(par, other):
    """Whether two files say the same, wherever their lines are."""
    return (par.antecedents, par.sigmas, par.actuated, par.name) == (
        other.antecedents,
        other.sigmas,
        other.actuated,
        other.name,
    ) and all(
        [value.expression for value in par.values[key]]
        == [value.expression for value in other.values[key]]
        for key in par.values
    )


def test_older_spellings_comments_and_broken_lists_say_the_same():
    par = read_par(ARM, "arm.par")
    assert same(par, read_par(OLDER, "arm.par"))
    assert (par.name, par.sigmas, par.actuated) == ("Arm", (0, 1, 0), (True, True, False))
    assert par.value("alpha", 3).names == ("H", "D3")
    assert read_par(OLDER, "arm.par").value("theta", 3).line == 16


def test_a_chain_needs_no_counts_no_antecedents_and_no_name():
    lines = [
        line for line in ARM.splitlines() if line.split(" ")[0] not in ("NL", "NJ", "NF", "ant")
    ]
    par = read_par("\n".join(lines[1:]).replace("Type = 0", "is_floating = False"), "some/desk.par")
    assert (par.links, par.antecedents, par.name) == (3, (0, 1, 2), "desk")


def test_a_floating_base_has_the_first_of_each_list_of_links():
    text = ARM.replace("XX = {", "is_floating = 1\nXX = {XX0,")
    par = read_par(text, "arm.par")
    assert par.floating
    assert par.value("XX", 0).text == "XX0"
    assert par.value("XX", 3).text == "XX3"


def test_accents_in_latin_1_and_a_byte_order_mark_are_read(tmp_path):
    text = ARM.replace("Arm", "Bras à coulisse")
    for name, content in (("a", text.encode("latin-1")), ("b", text.encode("utf-8-sig"))):
        path = tmp_path / f"{name}.par"
        path.write_bytes(content)
        assert load_par(path).name == "Bras à coulisse"


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("-Pi/2", -pi / 2),
        ("2*pi/3", 2 * pi / 3),
        ("-2^2", -4.0),
        ("2**-1", 0.5),
        ("1/3", Fraction(1, 3)),
        ("0.1 + 0.2", Fraction(3, 10)),
        ("-(1 - 2)*3", 3),
        ("8/2/2", 2),
        ("atan2(1, -1)", atan2(1, -1)),
        ("Sqrt(2^2 + (1.5*2)^2/9*12)", 4.0),
        ("1e-3", Fraction(1, 1000)),
        ("-−5", 5),
        ("4^(1/2)", 2.0),
        ("abs(-3)", 3.0),
        ("L + 2*L", 6),
    ],
)
def test_arithmetic_is_exact_while_it_can_be(text, value):
    assert evaluate(parse_arithmetic(text), {"L": Fraction(2)}) == value


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "is empty"),
        ("2 Pi", "no sign between"),
        ("1,2", "comma"),
        ("(1", "not closed"),
        ("1)", "nothing opens"),
        ("1+", r"ends with '\+'"),
        ("*1", "where a number"),
        ("2^3^4", "power of a power"),
        ("2^21", "more than 20"),
        ("((x^20)^20)^20", "together more than 100"),
        ("2^n", "letter in an exponent"),
        ("1e999", "out of the range"),
        ("1e99999999999", "out of the range"),
        ("eval(1)", "not a function"),
        ("sin", "no brackets"),
        ("atan2(1)", "it takes 2"),
        ("__import__('os')", r"is in it; only numbers"),
        ("1/0", "divides by zero"),
        ("0^-1", "divides by zero"),
        ("sqrt(-1)", "not defined"),
        ("(-8)^(1/3)", "not defined"),
        ("1e300*1e300", "too large"),
        ("(" * 31 + "1" + ")" * 31, "more than 30 brackets"),
        ("1" * 501, "more than 500 characters"),
    ],
)
def test_what_is_no_arithmetic_is_said_in_a_few_words(text, said):
    with pytest.raises(InvalidValueError, match=said):
        evaluate(parse_arithmetic(text))


@pytest.mark.parametrize(
    ("printed", "part", "noted"),
    [
        ("1.57079632679000", pi / 2, True),
        ("-1.5708", -pi / 2, True),
        ("3.14159", pi, True),
        ("2.0944", 2 * pi / 3, True),
        ("1.5707963267948966", pi / 2, False),
        ("1.57", 1.57, False),
        ("1.5707", pi / 2, True),
        ("1.5709", 1.5709, False),
        ("0.45", 0.45, False),
    ],
)
def test_decimals_that_round_a_part_of_pi_are_taken_as_it(printed, part, noted):
    par = read_par(ARM.replace("-Pi/2,", f"{printed},", 1), "arm.par")
    assert evaluate(par.expression("alpha", 2)) == pytest.approx(part, rel=1e-16)
    assert [f"line 11: alpha of row 2 is {printed!r}" in note for note in par.notes] == [
        True
    ] * noted


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("Pi/2", "Pi/", "line 11: alpha of row 2 is '-Pi/'; it ends with '/'"),
        ("D3^2)}", "D3^2)", "line 12: the list of d is not closed"),
        ("sigma", "sigmma", "line 7: there is no key 'sigmma'; did you mean sigma"),
        ("mu = {1,1,0}", "mu = {1,1,0}\nMu = {1,1,1}", "line 9: mu is given a second time, .* 8"),
        ("{0,1,2}", "{0,1,3}", "line 6: ant of row 3 is 3; the rows 3 - 3 form a ring"),
        ("{0,1,2}", "{0,3,2}", "line 6: ant of row 2 is 3; the rows 2 - 3 - 2 form a ring"),
        ("{0,1,2}", "{2,0,1}", "line 6: ant of row 1 is 2, which comes later"),
        ("{0,1,2}", "{0,1,9}", "line 6: ant of row 3 is '9'; it must be a row's number"),
        ("{0,1,0}", "{0,1,3}", "line 7: sigma of row 3 is '3'; it must be 0 or 1 or 2"),
        ("{0,1,0}", "{0,1,s}", "line 7: sigma of row 3 is 's'"),
        ("{0,1,0}", "{2,2,2}", "line 7: sigma is 2 at every link"),
        ("d = {0,0,", "d = {0,0,0,", "line 12: d has 4 values; it must have 3"),
        ("d = {0,0,", "d = {0,,", "line 12: d of row 2 is ''; it is empty"),
        ("NF = 3", "NF = 4", "line 4: NF is 4, but NL is 3 and NJ is 3; the frames .* = 3"),
        ("NJ = 3", "NJ = 2", "NL is 3 and NJ is 2"),
        ("NJ = 3", "NJ = three", "line 3: NJ is 'three'; it must be a whole number"),
        ("NL = 3\nNJ = 3", "NL = 300\nNJ = 300", "NF is 3, but NL is 300"),
        ("Type = 0", "Type = 4", "line 5: Type is 4; it must be 0 .simple., 1 .tree. or 2"),
        ("Type = 0", "is_mobile = True\nType = 0", "line 5: is_mobile is True; a base on wheels"),
        ("Type = 0", "is_floating = maybe\nType = 0", "line 5: is_floating is 'maybe'"),
        ("NL = 3", "NL = {3}", "line 2: NL is a list"),
        ("mu = {1,1,0}", "mu = 1 ", "line 8: mu is '1'; it must be a list in braces"),
        ("(* simple *)", "(* simple", r"line 5: the comment's \(\* opens and is never closed"),
        ("(* simple *)", "simple *)", r"line 5: the comment's \*\) closes nothing"),
        ("ant = {0,1,2}", "hello", "line 6: 'hello' is not KEY = value"),
        ("H**2", "H**2 + system(1)", "line 12: d of row 3 is .*; system is not a function"),
        ("r = {H,r2 + 0.1,0}\n", "", "r is missing"),
        (
            "{H,",
            f"{{{'H' * 41},",
            "line 14: r of row 1 is .*; a symbol has more than 40",
        ),
    ],
)
def test_every_fault_is_one_sentence_with_file_line_row_and_key(old, new, said):
    assert old in ARM
    with pytest.raises(InvalidValueError, match=f"^arm.par.*{said}") as caught:
        read_par(ARM.replace(old, new), "arm.par")
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("1,7,8,3}", "1,7,8,8}", "line 13: rows 9 and 10 .* both have the antecedent 8"),
        ("1,7,8,3}", "1,7,9,3}", "line 13: ant of row 9 is 9"),
        ("1,7,8,3}", "1,7,8,9}", "line 13: ant of row 10 is 9, a cut joint's own frame"),
        ("0,0,2}", "0,0,0}", "line 14: rows 9 and 10 .* 2 in row 10"),
        ("0,0,2}", "0,2,2}", "line 14: rows 9 and 10 .* 0 or 1 in row 9"),
        ("NL = 8", "NL = 7", "line 7: NF is 10, but NL is 7 and NJ is 9"),
    ],
)
def test_faults_of_loops_name_both_frames(old, new, said):
    assert old in LOOP
    with pytest.raises(InvalidValueError, match=said):
        read_par(LOOP.replace(old, new), "loop.par")


def test_a_loop_is_cut_at_the_joint_after_the_links():
    par = read_par(LOOP, "loop.par")
    assert (par.links, par.joints, par.loops) == (8, 9, ((9, 10),))


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (ARM.replace("gamma = {0,", "gamma = {0.1,"), "line 9: gamma of row 1 is '0.1', which no"),
        (ARM.replace("b = {0,0", "b = {0,H"), "line 10: b of row 2 is 'H', which no branch needs"),
        (TREE.replace("Type = 1", "Type = 0"), "line 8: Type is 0 .simple., but .* 1 .tree."),
        (ARM.replace("Type = 0", "Type = 2"), "line 5: Type is 2 .closed loop., but .* 0 .simple."),
        (ARM.replace("{1,1,0}", "{0,0,0}"), "line 8: mu is 0 at every joint"),
    ],
)
def test_what_is_allowed_but_doubtful_is_noted(text, said):
    (note,) = read_par(text, "arm.par").notes
    assert note.startswith("arm.par, line")
    assert re.search(said, note)


def test_a_branch_may_have_gamma_and_b_without_a_note():
    assert not read_par(TREE, "tree.par").notes


EDITS = st.lists(
    st.tuples(
        st.integers(0, len(ARM)),
        st.integers(0, 6),
        st.text("{}(),=*^/+-.0123456789eE \n'thPiGMNXant_\x00é", max_size=4),
    ),
    min_size=1,
    max_size=3,
)


def edited(text, edits):
    for at, length, new in edits:
        text = text[:at] + new + text[at + length :]
    return text


@pytest.mark.slow
@settings(max_examples=100)
@given(edits=EDITS, base=st.sampled_from([ARM, TREE, LOOP]))
def test_whatever_is_done_to_a_file_it_is_read_or_refused_in_one_sentence(edits, base):
    said = "x.par"
    with suppress(InvalidValueError):
        try:
            robot_of_par(read_par(edited(base, edits), "x.par"))
        except InvalidValueError as error:
            said = str(error)
            raise
    assert said.startswith("x.par")
    assert "\n" not in said
    assert len(said) < 2000


@settings(max_examples=30)
@given(content=st.binary(max_size=300))
def test_whatever_is_in_a_file_it_is_refused_in_one_sentence(content, tmp_path_factory):
    path = tmp_path_factory.mktemp("par") / "x.par"
    path.write_bytes(content)
    with pytest.raises(InvalidValueError) as caught:
        load_par(path)
    assert "\n" not in str(caught.value)


def test_a_huge_file_is_refused(tmp_path):
    path = tmp_path / "x.par"
    path.write_bytes(b"(" * (1 << 20) + b"()")
    with pytest.raises(InvalidValueError, match="it has 1048578 bytes or more"):
        load_par(path)
    path.write_text(f"NL = 1\nalpha = {{{'0,' * 500_000}}}", encoding="ascii")
    with pytest.raises(InvalidValueError, match="line 2: alpha has more than 400 values"):
        load_par(path)
