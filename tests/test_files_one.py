"""One file, written whole or not at all."""

import threading

import pytest

from drake_leg.errors import OutputError
from drake_leg.files import whole_file, write_text


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


def test_of_many_at_one_place_exactly_one_gets_it_and_none_is_lost(tmp_path):
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
