"""``drake-leg check``, in process."""

import json
import re
from pathlib import Path

import pytest

from drake_leg.cli import main
from drake_leg.models.proof import DrakeWitness

CHECK = Path(__file__).parents[1] / "lab" / "grader"
RX90 = str(CHECK / "robots" / "rx90.toml")
LEG_PRINT = str(CHECK / "printed" / "report_b_leg.toml")
LEG_TABLE = str(CHECK / "printed" / "report_b_leg_table.txt")
SCARA_CSV = str(CHECK / "printed" / "report_b_scara.csv")


def checked(capsys, *words):
    """Return the status and what is printed."""
    status = main(["check", *words])
    out, err = capsys.readouterr()
    assert err == "" or status == 2
    return status, out or err


@pytest.mark.parametrize("name", ["pendulum", "leg-a", "leg-b", "scara", RX90])
def test_a_right_robot_is_proved(name, capsys):
    status, out = checked(capsys, name, "--samples", "4")
    assert status == 0
    assert out.startswith(f"{name}: no slip in the table\n")
    assert out.endswith("proved: none is above 1e-12\n")
    assert "on 4 random configurations" in out


def test_the_proof_as_json(capsys):
    status, out = checked(capsys, "scara", "--samples", "2", "--seed", "7", "--json")
    content = json.loads(out)
    assert (status, content["ok"], content["findings"]) == (0, True, [])
    assert (content["proof"]["samples"], content["proof"]["seed"]) == (2, 7)


def test_a_witness_that_differs_ends_in_status_1_and_is_named(capsys, monkeypatch):
    honest = DrakeWitness.foot
    monkeypatch.setattr(DrakeWitness, "foot", lambda self, q, row: honest(self, q) * 1.001)
    status, out = checked(capsys, "leg-b")
    assert status == 1
    assert "Drake" in out.splitlines()[-2]
    assert "deg" in out.splitlines()[-2]
    assert out.endswith("NOT proved: at least one is above 1e-12\n")
    status, out = checked(capsys, "leg-b", "--json")
    assert (status, json.loads(out)["ok"]) == (1, False)


def chain_of(joints, path):
    rows = (
        f"[[row]]\nsigma = 0\nd = 0.1\nalpha = {(0, 90, -90)[i % 3]}\nr = 0.05\ntheta = 0\n"
        for i in range(joints)
    )
    path.write_text('name = "chain"\nangles = "deg"\n' + "".join(rows), encoding="utf-8")
    return str(path)


def test_what_is_not_compared_in_time_is_said_and_the_status_is_3(
    tmp_path, capsys, monkeypatch, for_ever
):
    monkeypatch.setattr("drake_leg.symbolic.derivation.jacobian_function", for_ever)
    many = chain_of(16, tmp_path / "many.toml")
    status, out = checked(capsys, many, "--samples", "2", "--budget", "2")
    assert status == 3
    assert (
        "  Jacobian   SymPy                not done within 2 s: give it more with --budget\n" in out
    )
    assert out.endswith("proved in part: none of these is above 1e-12\n")
    status, out = checked(capsys, many, "--samples", "2", "--budget", "2", "--json")
    content = json.loads(out)
    assert (status, content["ok"], content["proof"]["complete"]) == (3, False, False)
    assert content["proof"]["missing"][-1]["witness"] == "SymPy"


@pytest.mark.slow
def test_two_hundred_joints_are_proved(tmp_path, capsys):
    many = chain_of(200, tmp_path / "many.toml")
    status, out = checked(capsys, many, "--samples", "1", "--budget", "100")
    assert status == 0
    assert "Jacobian   SymPy - differences" in out
    assert out.endswith("proved: none is above 1e-12\n")


def test_nothing_compared_proves_nothing(capsys):
    status, out = checked(capsys, "leg-b", "--budget", "1e-9")
    assert status == 3
    assert out.endswith("NOT proved: nothing was compared within the budget\n")


def test_slips_in_a_robots_table_are_all_named_before_any_proof(tmp_path, capsys):
    path = tmp_path / "arm.toml"
    path.write_text(
        'name = "arm"\nangles = "deg"\n'
        "[[row]]\nd = 0\nalpha = 0\nr = 0\ntheta = 0\n"
        "[[row]]\nsigma = 0.1\nd = 90\nalpha = 0\nr = 0\ntheta = 0\n",
        encoding="utf-8",
    )
    status, out = checked(capsys, str(path))
    assert status == 1
    assert "arm.toml: 2 wrong\n" in out
    assert "row 1: sigma is missing" in out
    assert "row 2: sigma is '0.1'" in out
    assert "proved" not in out


def test_guesses_do_not_stop_the_proof(tmp_path, capsys):
    path = tmp_path / "arm.toml"
    text = Path(RX90).read_text(encoding="utf-8").replace('"deg"', '"rad"')
    path.write_text(text, encoding="utf-8")
    status, out = checked(capsys, str(path), "--samples", "2")
    assert status == 0
    assert "(a guess): alpha is 90 rad" in out
    assert "proved" in out


@pytest.mark.parametrize(
    ("words", "status", "counts"),
    [
        (["leg-b", "--printed", LEG_PRINT], 1, "24 wrong"),
        (["leg-b", "--printed", LEG_TABLE], 1, "3 wrong, 3 not understood"),
        (["scara", "--printed", SCARA_CSV], 1, "10 wrong"),
        (["leg-a", "--printed", str(CHECK / "printed" / "report_a_leg.toml")], 1,
         "1 wrong, 1 not understood"),
        ([LEG_PRINT], 1, "3 wrong"),
        ([LEG_TABLE], 1, "3 wrong"),
        ([str(CHECK / "printed" / "report_b_scara_table.txt")], 0, "nothing is wrong, 2 guesses"),
        ([str(CHECK / "printed" / "report_b_scara.toml")], 0, "nothing is wrong"),
    ],
)  # fmt: skip
def test_a_print_is_graded(words, status, counts, capsys):
    assert checked(capsys, *words, "--json")[0] == status
    status_of_text, out = checked(capsys, *words)
    assert status_of_text == status
    summary, *findings = out.splitlines()
    assert summary.endswith(f": {counts}")
    assert len(findings) == sum(map(int, re.findall(r"\d+", counts)))


def test_what_is_not_understood_is_no_fault_and_ends_in_status_2(tmp_path, capsys):
    path = tmp_path / "print.csv"
    path.write_text("lengths,mm\nP04,c1 +\nP04,s1 ?\nP04,100 s2 + 100 s23\n", encoding="utf-8")
    status, out = checked(capsys, "leg-b", "--printed", str(path))
    assert (status, out.splitlines()[0]) == (2, f"{path} against leg-b: nothing is wrong, "
                                                "2 not understood")  # fmt: skip
    _, out = checked(capsys, "leg-b", "--printed", str(path), "--json")
    content = json.loads(out)
    assert (content["ok"], content["wrong"], content["not_understood"]) == (False, 0, 2)
    path.write_text(path.read_text(encoding="utf-8").replace("100 s2", "s2"), encoding="utf-8")
    assert checked(capsys, "leg-b", "--printed", str(path))[0] == 1


@pytest.mark.slow
def test_a_graded_print_as_json(capsys):
    _, out = checked(capsys, "leg-b", "--printed", LEG_PRINT, "--json")
    content = json.loads(out)
    assert content["ok"] is False
    assert content["proof"] is None
    keys = {"place", "fault", "remedy", "severity", "understood", "kind", "matrix", "entries"}
    assert keys == set(content["findings"][0])
    sums = [f for f in content["findings"] if f["kind"] == "sum of angles"]
    assert ("P04", [[1, 1], [2, 1]]) in [(f["matrix"], f["entries"]) for f in sums]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["leg-x"], "there is no robot 'leg-x'"),
        (["leg-b", "--printed", "nowhere.csv"], "nowhere.csv cannot be read"),
        (["nowhere.csv"], "nowhere.csv cannot be read"),
        (["leg-a", "--printed", SCARA_CSV], "has no joint 'lift'"),
        ([SCARA_CSV], "say of which robot they are"),
        (["leg-b", "--samples", "0"], "samples is 0"),
        (["leg-b", "--seed", "-1"], "seed is -1"),
        (["leg-b", "--budget", "0"], "--budget is 0.0 s"),
        (["leg-b", "--budget", "soon"], "--budget is 'soon'"),
        (["leg-b", "--printed", LEG_PRINT, "--seed", "-1"], "seed is -1"),
        (["leg-b", "--printed", RX90], "there is no key 'name'"),
    ],
)
def test_bad_input_is_one_sentence(words, said, capsys):
    status, err = checked(capsys, *words)
    assert status == 2
    assert said in err
    assert err.count("\n") == 1


def test_help_says_what_status_1_is(capsys):
    with pytest.raises(SystemExit, match="0"):
        main(["check", "--help"])
    assert "1 something is wrong" in capsys.readouterr().out
