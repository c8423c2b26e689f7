"""The maps that the doctor leaves; what it says is tested in tests/test_cli.py."""

import json

import pytest

from drake_leg.cli import main
from drake_leg.files import LIST

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
