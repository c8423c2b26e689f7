"""Files are read up to a size limit, and written whole or not at all."""

import errno
import os
import stat
import threading
from pathlib import Path

import pytest

from drake_leg import files
from drake_leg.errors import InvalidValueError, OutputError, UnreadableFileError
from drake_leg.files import (
    HEADING,
    LIST,
    ResultsFolder,
    check_target,
    opened,
    read_bytes,
    read_text,
    whole_file,
    write_text,
)

# --- reading ---------------------------------------------------------------------------------


def test_a_text_is_read_whatever_its_line_ends_and_its_byte_order_mark(tmp_path):
    path = tmp_path / "a.txt"
    path.write_bytes("\ufeffσ\r\nb\rc\n".encode())
    assert read_text(path) == "σ\nb\nc\n"


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda path: None, "No such file or directory"),
        (lambda path: path.mkdir(), "it is a folder; give a file"),
        (lambda path: os.mkfifo(path), "it is a pipe; give a file"),
        (lambda path: path.symlink_to("/dev/zero"), "it is not a regular file; give a file"),
        (lambda path: path.symlink_to("/dev/null"), "it is not a regular file; give a file"),
        (lambda path: path.symlink_to(path), "Too many levels of symbolic links"),
        (lambda path: path.write_bytes(b"x" * 101), "it has 101 bytes or more, and at most 100"),
        (lambda path: path.symlink_to("/proc/self/maps"), "and at most 100 are read"),
        (lambda path: path.write_bytes(b"a\xff"), "not text in UTF-8 (byte 1 is 0xff); save it as"),
    ],
    ids=["none", "folder", "pipe", "zero", "null", "loop", "large", "proc", "bytes"],
)
def test_what_is_no_file_of_a_sensible_size_is_refused_in_a_sentence(tmp_path, make, said):
    path = tmp_path / "a.txt"
    make(path)
    with pytest.raises(UnreadableFileError) as caught:
        read_text(path, most=100)
    assert str(caught.value).startswith(f"{path} cannot be read: ")
    assert said in caught.value.reason
    assert isinstance(caught.value, InvalidValueError)
    assert isinstance(caught.value, OutputError)


def test_a_name_that_no_file_can_have_is_refused(tmp_path):
    with pytest.raises(UnreadableFileError, match="null byte"):
        read_bytes(tmp_path / "a\0b")


def test_a_fault_while_reading_is_a_sentence(tmp_path):
    path = tmp_path / "a.txt"
    path.touch()
    with pytest.raises(UnreadableFileError, match="Input/output error"), opened(path):
        raise OSError(5, "Input/output error")


# --- one file --------------------------------------------------------------------------------


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
    with pytest.raises(OutputError, match="overwrite=True"):
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


def test_what_came_to_the_place_meanwhile_stays_and_the_new_file_is_beside_it(tmp_path):
    path = tmp_path / "arm.sdf"

    def make():
        with whole_file(path, endings=(".sdf",), overwrite=False) as scratch:
            scratch.write_text("new")
            path.write_text("mine")

    with pytest.raises(OutputError, match=r"left alone: the new file is .*arm-2\.sdf"):
        make()
    assert path.read_text() == "mine"
    assert (tmp_path / "arm-2.sdf").read_text() == "new"
    assert len(list(tmp_path.iterdir())) == 2


def test_of_many_files_at_one_place_exactly_one_gets_it_and_none_is_lost(tmp_path):
    for trial in range(20):
        path = tmp_path / str(trial) / "arm.sdf"
        path.parent.mkdir()
        barrier, refused = threading.Barrier(4), []

        def work(index, path=path, barrier=barrier, refused=refused):
            try:
                with whole_file(path, endings=(".sdf",), overwrite=False) as scratch:
                    scratch.write_text(str(index))
                    barrier.wait()
            except OutputError as error:
                refused.append(str(error))

        threads = [threading.Thread(target=work, args=(index,)) for index in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        assert len(refused) == 3
        assert {file.read_text() for file in path.parent.iterdir()} == {"0", "1", "2", "3"}
        assert len(list(path.parent.iterdir())) == 4


def test_a_failure_leaves_nothing_of_the_folders_that_were_made(tmp_path):
    def make():
        with whole_file(tmp_path / "a" / "arm.sdf", endings=(".sdf",), overwrite=False):
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        make()
    assert list(tmp_path.iterdir()) == []


# --- a folder of results ---------------------------------------------------------------------


def names(folder):
    return sorted(path.name for path in folder.iterdir())


def results(folder, text="old"):
    with ResultsFolder(folder, overwrite=False).begun() as scratch:
        (scratch / "summary.json").write_text(text, encoding="utf-8")
        (scratch / "recording.csv").write_text(text, encoding="utf-8")
    return folder


def write_into(target, text="new", *, overwrite=True):
    folder = ResultsFolder(target, overwrite=overwrite)
    with folder.begun() as scratch:
        (scratch / "summary.json").write_text(text, encoding="utf-8")
    return folder


def add(folder, *names, text="picture"):
    with folder.more() as scratch:
        for name in names:
            (scratch / name).write_text(text, encoding="utf-8")


def whole(folder, text):
    """See that a folder has one set of results and nothing else."""
    assert names(folder) == [LIST, "summary.json"]
    assert (folder / "summary.json").read_text(encoding="utf-8") == text


# --- checking the target ---------------------------------------------------------------------


def test_a_folder_that_is_not_there_may_be_made(tmp_path):
    check_target(tmp_path / "out", overwrite=False)
    check_target(tmp_path / "out", overwrite=True)
    assert names(tmp_path) == []


@pytest.mark.parametrize("kind", ["results", "empty", "file", "link", "broken link"])
def test_whatever_exists_is_refused_without_overwrite(tmp_path, kind):
    out = make(tmp_path, kind)
    with pytest.raises(OutputError, match=r"out exists: .*overwrite=True"):
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
    with pytest.raises(OutputError, match="is not a folder of results"):
        check_target(make(tmp_path, kind), overwrite=True)


STRANGERS = ["thesis.docx", "notes.txt", "notes.csv", "photo.png", ".hidden", "summary", "Makefile"]


@pytest.mark.parametrize("stranger", STRANGERS)
def test_a_folder_with_anything_else_in_it_is_never_replaced(tmp_path, stranger):
    out = results(tmp_path / "out")
    (out / stranger).write_text("mine", encoding="utf-8")
    with pytest.raises(OutputError, match=f"holds {stranger}, which is not a result of .*, and"):
        check_target(out, overwrite=True)
    assert (out / stranger).read_text(encoding="utf-8") == "mine"


def test_a_link_in_place_of_our_file_is_anothers(tmp_path):
    out = results(tmp_path / "out")
    (out / "recording.csv").unlink()
    (out / "recording.csv").symlink_to(tmp_path / "mine.csv")
    with pytest.raises(OutputError, match=r"recording\.csv"):
        check_target(out, overwrite=True)


@pytest.mark.parametrize("line", ["../mine", "/etc/passwd", ".hidden", ".."])
def test_a_list_that_names_what_is_elsewhere_or_hidden_makes_nothing_ours(tmp_path, line):
    out = results(tmp_path / "out")
    (tmp_path / "mine").touch()
    (out / ".hidden").touch()
    (out / LIST).write_text(f"{HEADING}\nsummary.json\nrecording.csv\n{line}\n", encoding="utf-8")
    with pytest.raises(OutputError, match=r"\.hidden"):
        check_target(out, overwrite=True)
    (out / ".hidden").unlink()
    write_into(out)
    assert names(tmp_path) == ["mine", "out"]


def test_what_a_file_manager_leaves_is_no_hindrance(tmp_path):
    out = results(tmp_path / "out")
    (out / ".DS_Store").touch()
    write_into(out)
    whole(out, "new")


def test_a_folder_with_a_folder_in_it_is_never_replaced(tmp_path):
    out = results(tmp_path / "out")
    (out / "deeper.csv").mkdir()
    with pytest.raises(OutputError, match="which is not a result of"):
        check_target(out, overwrite=True)


def test_a_folder_of_pictures_that_are_not_ours_is_never_replaced(tmp_path):
    out = tmp_path / "out"
    out.mkdir()
    (out / "holiday.png").write_bytes(b"")
    with pytest.raises(OutputError, match="which is not a result of"):
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
    whole(target, "new")


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

    monkeypatch.setattr("drake_leg.files.tempfile.TemporaryDirectory", denied)
    with pytest.raises(OutputError, match=r"out cannot be written \(Permission denied\)"):
        check_target(tmp_path / "out", overwrite=False)


# --- data ------------------------------------------------------------------------------------


def test_a_folder_appears_whole_and_alone(tmp_path):
    out = tmp_path / "out"
    folder = ResultsFolder(out, overwrite=False)
    with folder.begun() as scratch:
        assert names(scratch) == []
        (scratch / "summary.json").write_text("new", encoding="utf-8")
        assert not out.exists()
    assert names(tmp_path) == ["out"]
    whole(out, "new")
    assert (folder.path, folder.remark) == (out, None)


def test_it_has_the_permissions_of_any_new_folder(tmp_path):
    write_into(tmp_path / "out")
    (tmp_path / "plain").mkdir()
    modes = [stat.S_IMODE((tmp_path / name).stat().st_mode) for name in ("out", "plain")]
    assert modes[0] == modes[1]


def test_old_results_are_replaced_and_nothing_of_them_stays(tmp_path):
    out = results(tmp_path / "out")
    write_into(out)
    assert names(tmp_path) == ["out"]
    whole(out, "new")


@pytest.mark.parametrize("error", [ValueError, KeyboardInterrupt, OSError])
@pytest.mark.parametrize("existing", [True, False])
def test_a_failure_while_writing_leaves_everything_as_it_was(tmp_path, error, existing):
    out = tmp_path / "out"
    if existing:
        results(out)
    before = names(tmp_path)

    def fail_half_way():
        with ResultsFolder(out, overwrite=True).begun() as scratch:
            (scratch / "summary.json").write_text("half", encoding="utf-8")
            raise error

    with pytest.raises(OutputError if error is OSError else error):
        fail_half_way()
    assert names(tmp_path) == before
    if existing:
        assert (out / "summary.json").read_text(encoding="utf-8") == "old"
        assert names(out) == [LIST, "recording.csv", "summary.json"]


def test_folders_that_were_made_above_go_with_a_failure(tmp_path):
    def fail():
        with ResultsFolder(tmp_path / "a" / "b" / "out", overwrite=False).begun():
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        fail()
    assert names(tmp_path) == []


def test_a_full_disk_is_said_in_a_sentence(tmp_path):
    def write():
        with ResultsFolder(tmp_path / "out", overwrite=False).begun():
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


# --- what comes meanwhile --------------------------------------------------------------------


def anothers(out, kind):
    if kind == "file":
        out.write_text("mine", encoding="utf-8")
    elif kind == "broken link":
        out.symlink_to(out.with_name("nowhere"))
    else:
        out.mkdir()
        if kind == "folder":
            (out / "thesis.tex").write_text("mine", encoding="utf-8")


@pytest.mark.parametrize("kind", ["file", "folder", "empty", "broken link"])
@pytest.mark.parametrize("overwrite", [False, True])
def test_what_came_to_the_place_meanwhile_stays_and_the_results_are_beside_it(
    tmp_path, kind, overwrite
):
    out = tmp_path / "out"
    folder = ResultsFolder(out, overwrite=overwrite)
    with folder.begun() as scratch:
        (scratch / "summary.json").write_text("new", encoding="utf-8")
        anothers(out, kind)
    assert folder.path == tmp_path / "out-2"
    assert folder.remark == (
        f"{out} appeared in the meantime and was left alone: the results are in {out}-2"
    )
    whole(tmp_path / "out-2", "new")
    assert names(tmp_path) == ["out", "out-2"]
    assert out.is_symlink() or out.is_file() or names(out) == ["thesis.tex"] * (kind == "folder")
    add(folder, "step.png")
    assert names(tmp_path / "out-2") == [LIST, "step.png", "summary.json"]


def test_a_point_in_a_folders_name_is_no_ending(tmp_path):
    folder = ResultsFolder(tmp_path / "run-0.05", overwrite=False)
    with folder.begun() as scratch:
        (scratch / "summary.json").write_text("new", encoding="utf-8")
        (tmp_path / "run-0.05").mkdir()
    assert folder.path == tmp_path / "run-0.05-2"


def test_a_file_that_came_into_old_results_meanwhile_keeps_them(tmp_path):
    out = results(tmp_path / "out")
    folder = ResultsFolder(out, overwrite=True)
    with folder.begun() as scratch:
        (scratch / "summary.json").write_text("new", encoding="utf-8")
        (out / "notes.csv").write_text("mine", encoding="utf-8")
    assert folder.path == tmp_path / "out-2"
    assert names(out) == [LIST, "notes.csv", "recording.csv", "summary.json"]
    assert names(tmp_path) == ["out", "out-2"]


def test_a_file_that_came_into_old_results_at_the_last_moment_is_kept_beside(tmp_path, monkeypatch):
    out = results(tmp_path / "out")
    monkeypatch.setattr("drake_leg.files._place", late_note(out.parent))
    folder = write_into(out)
    whole(out, "new")
    assert folder.remark == f"what appeared in {out} in the meantime is now in {out}-2"
    assert names(tmp_path / "out-2") == ["notes.txt"]
    assert names(tmp_path) == ["out", "out-2"]


def late_note(parent):
    """Put a note into older results that have been moved aside already."""
    calls = []

    place = files._place

    def late(folder, wanted, *rest):
        if not calls:
            (aside,) = parent.glob(".out.*/results/recording.csv")
            aside.with_name("notes.txt").write_text("mine", encoding="utf-8")
        calls.append(folder)
        return place(folder, wanted, *rest)

    return late


def test_older_results_that_another_run_has_replaced_meanwhile_are_the_others(tmp_path):
    out = results(tmp_path / "out")
    slow = ResultsFolder(out, overwrite=True)
    with slow.begun() as scratch:
        (scratch / "summary.json").write_text("slow", encoding="utf-8")
        write_into(out, "quick")
    whole(out, "quick")
    whole(tmp_path / "out-2", "slow")
    assert names(tmp_path) == ["out", "out-2"]


def at_once(count, work):
    barrier, failures = threading.Barrier(count), []

    def start(index):
        barrier.wait()
        try:
            work(index)
        except Exception as error:
            failures.append(error)

    threads = [threading.Thread(target=start, args=(index,)) for index in range(count)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert failures == []


@pytest.mark.parametrize("existing", [False, True])
def test_of_many_at_one_place_exactly_one_gets_it_and_none_is_lost(tmp_path, existing):
    for trial in range(20):
        out = tmp_path / str(trial) / "out"
        if existing:
            results(out)
        made = [ResultsFolder(out, overwrite=existing) for _ in range(4)]

        def work(index, made=made):
            with made[index].begun() as scratch:
                (scratch / "summary.json").write_text(str(index), encoding="utf-8")
            add(made[index], "step.png", "step.svg", text=str(index))

        at_once(4, work)
        assert [folder.path for folder in made].count(out) == 1
        assert sum(folder.remark is None for folder in made) == 1
        assert len({folder.path for folder in made}) == 4
        for index, folder in enumerate(made):
            assert names(folder.path) == [LIST, "step.png", "step.svg", "summary.json"]
            texts = {path.read_text(encoding="utf-8") for path in folder.path.glob("s*")}
            assert texts == {str(index)}
        assert names(out.parent) == ["out", "out-2", "out-3", "out-4"]


# --- more ------------------------------------------------------------------------------------


def test_more_files_are_put_in_whole_and_known_as_ours(tmp_path):
    folder = write_into(tmp_path / "out")
    add(folder, "step.png", "step.svg")
    assert names(tmp_path / "out") == [LIST, "step.png", "step.svg", "summary.json"]
    assert names(tmp_path) == ["out"]
    write_into(tmp_path / "out")
    whole(tmp_path / "out", "new")


@pytest.mark.parametrize("error", [ValueError, KeyboardInterrupt, OSError])
def test_a_failure_while_adding_leaves_the_data_alone(tmp_path, error):
    folder = write_into(tmp_path / "out")

    def fail():
        with folder.more() as scratch:
            (scratch / "step.png").write_text("half", encoding="utf-8")
            raise error

    with pytest.raises(OutputError if error is OSError else error):
        fail()
    whole(tmp_path / "out", "new")
    assert names(tmp_path) == ["out"]


def test_a_file_that_is_there_already_is_anothers(tmp_path):
    folder = write_into(tmp_path / "out")
    (tmp_path / "out" / "step.png").write_text("mine", encoding="utf-8")
    with pytest.raises(OutputError, match=r"step\.png appeared in the meantime and was left alone"):
        add(folder, "step.png")
    assert (tmp_path / "out" / "step.png").read_text(encoding="utf-8") == "mine"
    with pytest.raises(OutputError, match=r"step\.png"):
        check_target(tmp_path / "out", overwrite=True)


@pytest.mark.parametrize("by", ["moved", "replaced"])
def test_a_folder_that_is_another_by_now_gets_nothing_more(tmp_path, by):
    folder = write_into(tmp_path / "out")
    (tmp_path / "out").rename(tmp_path / "away")
    if by == "replaced":
        write_into(tmp_path / "out", "other")
    with pytest.raises(OutputError, match="out"):
        add(folder, "step.png")
    assert "step.png" not in names(tmp_path / "away")
    assert names(tmp_path) == (["away", "out"] if by == "replaced" else ["away"])


def test_a_file_system_without_links_does_as_well(tmp_path, monkeypatch):
    def unable(*arguments, **keywords):
        raise PermissionError(errno.EPERM, os.strerror(errno.EPERM))

    monkeypatch.setattr(os, "link", unable)
    folder = write_into(tmp_path / "out")
    add(folder, "step.png")
    assert (tmp_path / "out" / "step.png").read_text(encoding="utf-8") == "picture"
    with pytest.raises(OutputError, match="left alone"):
        add(folder, "step.png")
