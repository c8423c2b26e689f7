"""The maps that the doctor leaves; what it says is tested in tests/test_cli.py."""

import json
from pathlib import Path

import pytest

from drake_leg.cli import main
from drake_leg.files import LIST

MODEL = str(Path(__file__).parents[2] / "notebooks" / "leg.slx")
LEG = ["doctor", "leg-b", "--q", "90,-50,-90"]
MAPS = ("determinant", "sigma_min", "singular_feet", "singular_postures")


@pytest.mark.slow
def test_a_scaras_map_is_left_in_a_folder(tmp_path, capsys):
    target = tmp_path / "maps"
    scara = ["doctor", "scara", "--q", "30,90,-120", "--json", "--out", str(target)]
    assert main(scara) == 0
    expected = {f"sigma_min.{ending}" for ending in ("png", "svg", "pdf")}
    assert {path.name for path in target.iterdir()} == expected | {LIST, "summary.json"}
    json.loads(capsys.readouterr().out)
    assert main(scara) == 2
    assert "exists" in capsys.readouterr().err


@pytest.mark.slow
def test_maps_are_left_in_a_folder(tmp_path, capsys):
    target = tmp_path / "maps"
    assert main([*LEG, "--out", str(target)]) == 0
    expected = {f"{name}.{ending}" for name in MAPS for ending in ("png", "svg", "pdf")}
    assert {path.name for path in target.iterdir()} == expected | {LIST, "summary.json"}
    assert json.loads((target / "summary.json").read_text(encoding="utf-8"))["rank"] == 3
    assert f"wrote {target}" in capsys.readouterr().out
    assert main([*LEG, "--out", str(target)]) == 2
    assert "exists" in capsys.readouterr().err
    scara = ["doctor", "scara", "--q", "30,90,-120", "--json"]
    assert main([*scara, "--out", str(target), "--overwrite"]) == 0
    json.loads(capsys.readouterr().out)
    assert not (target / "determinant.png").exists()


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["doctor", "pendulum", "--q", "30", "--out", "maps"], "maps are drawn of a hexabot leg"),
        ([*LEG, "--overwrite"], "--overwrite goes with --out"),
        ([*LEG, "--out", "file/maps"], "cannot be written"),
    ],
)
def test_what_cannot_be_drawn_is_said_before_anything_is_printed(
    words, said, tmp_path, monkeypatch, capsys
):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "file").write_text("")
    assert main(words) == 2
    printed = capsys.readouterr()
    assert printed.out == ""
    assert said in printed.err
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


# --- Simulink models --------------------------------------------------------------------------


def test_a_simulink_models_leg_is_examined_as_the_leg_is(capsys):
    words = ["--q", "90,-50,-90", "--direction", "1,0,0", "--frequency", "1"]
    assert main(["doctor", "leg-b", *words]) == 0
    leg = capsys.readouterr().out
    assert main(["doctor", MODEL, *words]) == 0
    chain, tip, *lines = capsys.readouterr().out.splitlines()
    assert chain.startswith("chain           Revolute_Joint, Revolute_Joint1, Revolute_Joint2 to ")
    assert tip.startswith("tip             the follower of 'Rigid Transform5'")
    assert lines == leg.splitlines()


def test_a_simulink_model_is_examined_at_its_state_targets(capsys):
    assert main(["doctor", MODEL, "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["tip"].startswith("the follower of 'Rigid Transform5'")
    assert found["rank"] == 2
    assert found["foot_m"] == pytest.approx([0.25, 0.0, 0.0])


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--tip", "foot"], "there is no tip 'foot': the tips are Spherical_Solid"),
        (["--q", "1,2"], "--q has 2 numbers; leg has 3 joint positions"),
        (["--speed", "0.1"], "means nothing for leg, which does not walk"),
    ],
)
def test_what_makes_no_sense_to_a_simulink_model_is_refused(words, said, capsys):
    assert main(["doctor", MODEL, *words]) == 2
    assert said in capsys.readouterr().err
