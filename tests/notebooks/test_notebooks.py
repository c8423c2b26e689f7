"""The notebooks as they are kept: no outputs, nothing of one machine, exercises with answers.

That they run is tested by ``pytest --nbmake notebooks``.
"""

from __future__ import annotations

import json
import re
import zipfile
from pathlib import Path, PurePosixPath

import pytest
from slx_models import published_leg

from drake_leg.lab.errata.catalogue import texts_by_number
from drake_leg.simulink.listing import as_lines
from drake_leg.simulink.reader import read_model

FOLDER = Path(__file__).parents[2] / "notebooks"
NOTEBOOKS = sorted(FOLDER.glob("*.ipynb"))
KERNEL = {"display_name": "Python 3", "language": "python", "name": "python3"}
PATHS = re.compile(r"""["'(\s](/(?:home|root|tmp|usr|work|opt|mnt|Users)\b|[A-Za-z]:\\)""")

WRITE_AGAIN = (
    'PYTHONPATH=tests/simulink python -c "from pathlib import Path; from slx_models import '
    "published_leg; from slx_writer import write_parts; "
    "write_parts(Path('notebooks/leg.slx'), published_leg().package())\""
)


@pytest.fixture(params=NOTEBOOKS, ids=lambda path: path.stem)
def notebook(request):
    return json.loads(request.param.read_text(encoding="utf-8"))


def code(notebook):
    return [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]


def tagged(notebook, tag):
    return [cell for cell in code(notebook) if tag in cell["metadata"].get("tags", [])]


def test_there_is_one_for_each_chapter():
    assert [path.stem for path in NOTEBOOKS] == [
        "01_pendulum",
        "02_leg_kinematics",
        "03_leg_step",
        "04_scara",
        "05_from_simulink",
        "06_hexapod",
    ]


def test_is_of_format_4_5_and_every_cell_has_an_id_of_its_own(notebook):
    assert (notebook["nbformat"], notebook["nbformat_minor"]) == (4, 5)
    ids = [cell["id"] for cell in notebook["cells"]]
    assert len(set(ids)) == len(ids)


def test_holds_no_outputs(notebook):
    for cell in code(notebook):
        assert cell["outputs"] == []
        assert cell["execution_count"] is None
        assert "execution" not in cell["metadata"]


def test_names_no_kernel_and_no_version_of_one_machine(notebook):
    assert notebook["metadata"] == {"kernelspec": KERNEL, "language_info": {"name": "python"}}


def test_has_no_absolute_paths(notebook):
    for cell in notebook["cells"]:
        assert not PATHS.search("".join(cell["source"]))


def test_says_first_what_one_learns_and_which_errata_it_touches(notebook):
    first = "".join(notebook["cells"][0]["source"])
    assert first.startswith("# ")
    assert "**You will learn**" in first
    assert "**Errata on the way**" in first


def test_every_erratum_is_shown_by_one_of_them():
    calls = [
        re.search(r"^errata\((.*)\)$", "".join(cell["source"]), flags=re.MULTILINE)
        for path in NOTEBOOKS
        for cell in code(json.loads(path.read_text(encoding="utf-8")))
    ]
    shown = [number for call in calls if call for number in eval(f"[{call[1]}]")]
    assert sorted(shown) == sorted(texts_by_number())


def test_exercises_are_open_and_have_a_check_and_a_hidden_answer(notebook):
    exercises, checks, answers = (tagged(notebook, t) for t in ("exercise", "check", "answer"))
    assert 1 <= len(exercises) == len(checks) == len(answers)
    for exercise, check, answer in zip(exercises, checks, answers, strict=True):
        assert re.match(r"\w+ = None\b", "".join(exercise["source"]))
        assert "check(" in "".join(check["source"])
        assert "assert" in "".join(answer["source"])
        assert answer["metadata"]["jupyter"] == {"outputs_hidden": True, "source_hidden": True}


def test_the_simulink_model_is_the_one_that_the_writer_writes():
    with zipfile.ZipFile(FOLDER / "leg.slx") as archive:
        kept = {name: archive.read(name).decode() for name in archive.namelist()}
    assert kept == published_leg().package(), f"write it again: {WRITE_AGAIN}"


def test_the_simulink_model_is_a_package_as_simulink_saves_it():
    """Every part has a content type, and is reached from the root by relationships."""
    with zipfile.ZipFile(FOLDER / "leg.slx") as archive:
        parts = {name: archive.read(name).decode() for name in archive.namelist()}
    assert next(iter(parts)) == "[Content_Types].xml"
    named = set(re.findall(r'PartName="/([^"]+)"', parts["[Content_Types].xml"]))
    assert named <= set(parts)
    reached, waiting = set(), ["_rels/.rels"]
    while waiting:
        rels = PurePosixPath(waiting.pop())
        for target in re.findall(r'Target="([^"]+)"', parts.get(str(rels), "")):
            part = rels.parent.parent / target
            reached.add(str(part))
            waiting.append(str(part.parent / "_rels" / f"{part.name}.rels"))
    packing = {name for name in parts if name == "[Content_Types].xml" or name.endswith(".rels")}
    assert reached == set(parts) - packing


def test_the_package_holds_the_same_model_as_its_bare_parts(tmp_path):
    packed = read_model(FOLDER / "leg.slx")
    bare = read_model(published_leg().write(tmp_path / "leg.slx"))
    assert as_lines(packed) == as_lines(bare)
