"""What README shows works as it stands."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

from drake_leg.cli import main
from drake_leg.errata import errata

ROOT = Path(__file__).resolve().parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")


def blocks(language):
    return re.findall(rf"```{language}\n(.*?)```", README, flags=re.DOTALL)


def test_ci_calls_the_readmes_test_command():
    (command,) = (block.strip() for block in blocks("sh") if block.strip().endswith("pytest"))
    assert command in (ROOT / ".ci" / "run").read_text(encoding="utf-8").splitlines()


@pytest.mark.parametrize("snippet", blocks("python"), ids=("sensor", "run", "sdf"))
def test_a_snippet_runs(snippet):
    subprocess.run([sys.executable, "-W", "error", "-c", snippet], check=True, cwd=ROOT)


def test_the_robot_of_ones_own_is_proved(tmp_path, monkeypatch, capsys):
    (robot,) = blocks("toml")
    monkeypatch.chdir(tmp_path)
    Path("arm.toml").write_text(robot, encoding="utf-8")
    assert main(["check", "arm.toml"]) == 0
    assert "proved" in capsys.readouterr().out
    assert main(["sdf", "arm.toml", "--out", "arm.sdf"]) == 0
    assert main(["doctor", "arm.toml", "--q", "0,80,-90"]) == 0
    words = [
        "run",
        "arm.toml",
        "--out",
        "arm",
        "--q0",
        "0,80,-90",
        "--amplitude",
        "0.05",
        "--duration",
        "0.2",
    ]
    assert main(words) == 0


@pytest.mark.parametrize("text", blocks("yaml"))
def test_the_config_is_taken(tmp_path, text):
    config = tmp_path / "step.yaml"
    config.write_text(text, encoding="utf-8")
    words = ["run", "leg-b", "--config", str(config), "--out", str(tmp_path / "step")]
    assert main([*words, "--duration", "0.2"]) == 0


def test_the_errata_are_counted():
    assert re.findall(r"(\d+) errata", README) == [str(len(errata()))]


def test_every_command_of_the_readme_is_taken(monkeypatch):
    """Each is parsed as written; the runs themselves are other tests' business."""
    from drake_leg.cli import entry

    lines = [line for block in blocks("sh") for line in block.splitlines()]
    commands = [line.partition("#")[0] for line in lines if line.startswith("drake-leg")]
    assert len(commands) > 10
    for command in commands:
        words = [word.strip("'") for word in command.split()[1:]]
        entry._build_parser().parse_args(entry._join_negative_values(words))
