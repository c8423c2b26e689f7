"""One file, written whole or not at all."""

import pytest

from drake_leg.errors import OutputError
from drake_leg.text_file import write_text


def write(path, text="new", *, overwrite=False):
    write_text(path, text, ending=".sdf", overwrite=overwrite)


def test_a_file_is_made_with_its_folder(tmp_path):
    path = tmp_path / "deep" / "arm.sdf"
    write(path, "é\n")
    assert path.read_bytes() == "é\n".encode()
    assert [file.name for file in path.parent.iterdir()] == ["arm.sdf"]


def test_a_new_file_has_the_modes_that_any_new_file_has(tmp_path):
    write(tmp_path / "arm.sdf")
    (tmp_path / "other").touch()
    assert (tmp_path / "arm.sdf").stat().st_mode == (tmp_path / "other").stat().st_mode


def test_a_file_that_is_there_is_replaced_only_on_request(tmp_path):
    path = tmp_path / "arm.sdf"
    path.write_text("old")
    with pytest.raises(OutputError, match="--overwrite"):
        write(path)
    assert path.read_text() == "old"
    write(path, overwrite=True)
    assert path.read_text() == "new"


@pytest.mark.parametrize("name", ["arm", "arm.txt", "arm.sdf.bak"])
def test_another_ending_is_refused(name, tmp_path):
    with pytest.raises(OutputError, match=r"does not end in \.sdf"):
        write(tmp_path / name)
    assert not list(tmp_path.iterdir())


def test_a_folder_is_never_replaced(tmp_path):
    (tmp_path / "arm.sdf").mkdir()
    with pytest.raises(OutputError, match="is a folder"):
        write(tmp_path / "arm.sdf", overwrite=True)


def test_where_writing_fails_nothing_is_left_and_the_old_file_stays(tmp_path):
    path = tmp_path / "arm.sdf"
    path.write_text("old")
    with pytest.raises(OutputError, match="cannot be written"):
        write(path, "half \ud800", overwrite=True)
    assert path.read_text() == "old"
    assert [file.name for file in tmp_path.iterdir()] == ["arm.sdf"]


@pytest.mark.parametrize("name", ["file/arm.sdf", "a\0b.sdf", "x" * 300 + ".sdf"])
def test_a_place_that_cannot_be_written_is_named(name, tmp_path):
    (tmp_path / "file").touch()
    with pytest.raises(OutputError, match="cannot be written"):
        write(tmp_path / name)
