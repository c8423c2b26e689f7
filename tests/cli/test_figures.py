"""``--figures``: which files a run draws, and that it draws none where none are wanted."""

import subprocess
import sys
from pathlib import Path

import pytest

from drake_leg.cli import main
from drake_leg.files import LIST
from drake_leg.pictures.formats import CHOICES, CHOSEN
from drake_leg.runs.named import run

SHORT = ["run", "pendulum", "--out", "out", "--duration", "0.2"]
NAMES = ("angle", "angle_and_rate", "energy")
DATA = {LIST, "recording.csv", "summary.json"}


@pytest.fixture(autouse=True)
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


@pytest.fixture
def saved(monkeypatch):
    """Write empty files instead of figures."""

    def save(_figure, folder, name, formats):
        for ending in formats:
            (folder / f"{name}.{ending}").touch()

    monkeypatch.setattr("drake_leg.runs.figures.save", save)


def files(formats):
    return DATA | {f"{name}.{ending}" for name in NAMES for ending in formats}


def written():
    return {path.name for path in Path("out").iterdir()}


@pytest.mark.parametrize("figures", CHOICES)
def test_the_figures_have_the_formats_that_are_asked_for(figures, saved):
    assert main([*SHORT, "--figures", figures]) == 0
    assert written() == files(CHOICES[figures])


@pytest.mark.parametrize("figures", CHOICES)
def test_python_writes_the_same_files(figures, saved):
    run("pendulum", duration=0.2, out="out", figures=figures)
    assert written() == files(CHOICES[figures])


def test_what_a_person_looks_at_is_written_by_default(saved):
    assert main(SHORT) == 0
    assert written() == files(["png"]) == files(CHOICES[CHOSEN])


def test_a_config_has_the_key_too_and_the_option_overrides_it(saved):
    Path("run.yaml").write_text("figures: svg\nmax_step: 0.01\n", encoding="utf-8")
    assert main([*SHORT, "--config", "run.yaml"]) == 0
    assert written() == files(["svg"])
    words = [*SHORT, "--config", "run.yaml", "--overwrite"]
    assert main([*words, "--figures", "none"]) == 0
    assert written() == DATA


@pytest.mark.parametrize(
    ("word", "advice"),
    [
        ("pngs", ": did you mean png?"),
        ("PNG", ": did you mean png?"),
        ("no", ": did you mean none?"),
        ("webp", ""),
        ("png,svg", ""),
    ],
)
def test_another_word_is_refused_in_a_sentence_before_the_run(word, advice, monkeypatch, capsys):
    monkeypatch.setattr("drake_leg.runs.pendulum.simulate", None)
    sentence = f"figures is {word!r}; it must be one of none, png, svg, pdf, all"
    assert main([*SHORT, "--figures", word]) == 2
    assert capsys.readouterr().err == f"drake-leg: {sentence}{advice}\n"
    Path("run.yaml").write_text(f"figures: '{word}'\n", encoding="utf-8")
    assert main([*SHORT, "--config", "run.yaml"]) == 2
    said = capsys.readouterr().err
    assert said == f"drake-leg: the config run.yaml is wrong: {sentence}{advice}\n"
    assert not Path("out").exists()


@pytest.mark.slow
def test_without_figures_nothing_that_draws_is_imported():
    code = (
        "import sys; from drake_leg.cli import main; "
        f"status = main({[*SHORT, '--figures', 'none']!r}); "
        "sys.exit(status or any(name in sys.modules for name in ('matplotlib', 'PIL')))"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
    assert written() == DATA


def test_without_figures_matplotlib_may_be_missing(monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    assert main([*SHORT, "--figures", "none"]) == 0
