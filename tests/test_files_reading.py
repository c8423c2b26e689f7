import os

import pytest

from drake_leg.errors import InvalidValueError, OutputError, UnreadableFileError
from drake_leg.files import opened, read_bytes, read_text


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
