import errno
import os
import stat
from pathlib import Path

import pytest

from drake_leg.errors import OutputError
from drake_leg.output import check_target, results_folder


def names(folder):
    return sorted(path.name for path in folder.iterdir())


def results(folder, text="old"):
    folder.mkdir(parents=True)
    (folder / "summary.json").write_text(text, encoding="utf-8")
    (folder / "recording.csv").write_text(text, encoding="utf-8")
    return folder


def write_into(target, text="new"):
    with results_folder(target) as folder:
        (folder / "summary.json").write_text(text, encoding="utf-8")


# --- checking the target ---------------------------------------------------------------------


def test_a_folder_that_is_not_there_may_be_made(tmp_path):
    check_target(tmp_path / "out", overwrite=False)
    check_target(tmp_path / "out", overwrite=True)
    assert names(tmp_path) == []


@pytest.mark.parametrize("kind", ["results", "empty", "file", "link", "broken link"])
def test_whatever_exists_is_refused_without_overwrite(tmp_path, kind):
    out = make(tmp_path, kind)
    with pytest.raises(OutputError, match=r"out exists: .*--overwrite"):
        check_target(out, overwrite=False)


def make(tmp_path, kind):
    out = tmp_path / "out"
    if kind == "results":
        results(out)
    elif kind == "empty":
        out.mkdir()
    elif kind == "file":
        out.write_text("mine", encoding="utf-8")
    elif kind == "link":
        results(tmp_path / "elsewhere")
        out.symlink_to(tmp_path / "elsewhere")
    else:
        out.symlink_to(tmp_path / "nowhere")
    return out


@pytest.mark.parametrize("kind", ["results", "empty"])
def test_folders_of_our_results_may_be_replaced(tmp_path, kind):
    check_target(make(tmp_path, kind), overwrite=True)


@pytest.mark.parametrize("kind", ["file", "link", "broken link"])
def test_what_is_no_folder_is_never_replaced(tmp_path, kind):
    with pytest.raises(OutputError, match="something else than results"):
        check_target(make(tmp_path, kind), overwrite=True)


@pytest.mark.parametrize("stranger", ["thesis.docx", "notes.txt", ".hidden", "summary", "Makefile"])
def test_a_folder_with_anything_else_in_it_is_never_replaced(tmp_path, stranger):
    out = results(tmp_path / "out")
    (out / stranger).write_text("mine", encoding="utf-8")
    with pytest.raises(OutputError, match="something else than results"):
        check_target(out, overwrite=True)
    assert (out / stranger).read_text(encoding="utf-8") == "mine"


def test_a_folder_with_a_folder_in_it_is_never_replaced(tmp_path):
    out = results(tmp_path / "out")
    (out / "deeper.csv").mkdir()
    with pytest.raises(OutputError, match="something else than results"):
        check_target(out, overwrite=True)


def test_a_folder_of_pictures_that_are_not_ours_is_never_replaced(tmp_path):
    out = tmp_path / "out"
    out.mkdir()
    (out / "holiday.png").write_bytes(b"")
    with pytest.raises(OutputError, match="something else than results"):
        check_target(out, overwrite=True)


def test_a_path_under_a_file_is_refused(tmp_path):
    (tmp_path / "file").write_text("mine", encoding="utf-8")
    with pytest.raises(OutputError, match=r"file/out cannot be written"):
        check_target(tmp_path / "file" / "out", overwrite=False)


@pytest.mark.parametrize("name", ["x" * 300, "a\0b"], ids=("too long", "with a null byte"))
def test_a_name_that_no_folder_can_have_is_refused(tmp_path, name):
    with pytest.raises(OutputError, match="cannot be written"):
        check_target(tmp_path / name, overwrite=False)


def test_a_name_that_leaves_no_room_for_the_scratch_folder_is_refused_or_works(tmp_path):
    """What the check lets through must be possible to write afterwards."""
    target = tmp_path / ("x" * 250)
    try:
        check_target(target, overwrite=False)
    except OutputError:
        return
    write_into(target)
    assert names(target) == ["summary.json"]


def test_the_parent_of_an_impossible_run_is_not_left_behind(tmp_path):
    check_target(tmp_path / "a" / "b" / "out", overwrite=False)
    assert names(tmp_path) == []


def test_the_parent_of_a_folder_that_is_not_there_is_refused_before_any_work(tmp_path):
    with pytest.raises(OutputError):
        check_target(tmp_path / "not there" / "..", overwrite=False)
    assert names(tmp_path) == []


@pytest.mark.parametrize("target", [".", "here/.."])
def test_the_working_directory_itself_is_never_replaced(tmp_path, monkeypatch, target):
    (tmp_path / "here").mkdir()
    folder = tmp_path / "here" if target == "." else tmp_path
    monkeypatch.chdir(folder)
    before = names(folder)
    with pytest.raises(OutputError):
        check_target(Path(target), overwrite=True)
    assert names(folder) == before


def test_a_folder_without_permission_is_refused(tmp_path, monkeypatch):
    def denied(*arguments, **keywords):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))

    monkeypatch.setattr("drake_leg.output.tempfile.TemporaryDirectory", denied)
    with pytest.raises(OutputError, match=r"out cannot be written \(Permission denied\)"):
        check_target(tmp_path / "out", overwrite=False)


# --- writing ---------------------------------------------------------------------------------


def test_a_folder_appears_whole_and_alone(tmp_path):
    out = tmp_path / "out"
    with results_folder(out) as folder:
        assert folder.parent == tmp_path
        assert names(folder) == []
        (folder / "summary.json").write_text("new", encoding="utf-8")
        assert not out.exists()
    assert names(tmp_path) == ["out"]
    assert names(out) == ["summary.json"]


def test_it_has_the_permissions_of_any_new_folder(tmp_path):
    write_into(tmp_path / "out")
    (tmp_path / "plain").mkdir()
    modes = [stat.S_IMODE((tmp_path / name).stat().st_mode) for name in ("out", "plain")]
    assert modes[0] == modes[1]


def test_old_results_are_replaced_and_nothing_of_them_stays(tmp_path):
    out = results(tmp_path / "out")
    write_into(out)
    assert names(tmp_path) == ["out"]
    assert names(out) == ["summary.json"]
    assert (out / "summary.json").read_text(encoding="utf-8") == "new"


@pytest.mark.parametrize("error", [ValueError, KeyboardInterrupt, OSError])
@pytest.mark.parametrize("existing", [True, False])
def test_a_failure_while_writing_leaves_everything_as_it_was(tmp_path, error, existing):
    out = tmp_path / "out"
    if existing:
        results(out)
    before = names(tmp_path)

    def fail_half_way():
        with results_folder(out) as folder:
            (folder / "summary.json").write_text("half", encoding="utf-8")
            raise error

    with pytest.raises(OutputError if error is OSError else error):
        fail_half_way()
    assert names(tmp_path) == before
    if existing:
        assert (out / "summary.json").read_text(encoding="utf-8") == "old"
        assert names(out) == ["recording.csv", "summary.json"]


def test_a_full_disk_is_said_in_a_sentence(tmp_path):
    def write():
        with results_folder(tmp_path / "out"):
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    with pytest.raises(OutputError, match=r"out cannot be written \(No space left on device\)"):
        write()
    assert names(tmp_path) == []


@pytest.mark.parametrize("which", [1, 2])
def test_a_failure_while_exchanging_the_folders_keeps_the_old_one(tmp_path, monkeypatch, which):
    out = results(tmp_path / "out")
    rename, calls = Path.rename, []

    def failing(self, target):
        calls.append(self)
        if len(calls) == which:
            raise OSError(errno.EIO, os.strerror(errno.EIO))
        return rename(self, target)

    monkeypatch.setattr(Path, "rename", failing)
    with pytest.raises(OutputError, match="Input/output error"):
        write_into(out)
    assert names(tmp_path) == ["out"]
    assert (out / "summary.json").read_text(encoding="utf-8") == "old"
