"""Version 7.3 of .mat files: files as MATLAB writes them, damaged ones, and those that lead out."""

import sys

import numpy as np
import pytest
from campaigns import cases
from signal_models import oscillator

from drake_leg.simulink.matlab import hdf5files
from drake_leg.simulink.matlab.data import Cell, LackError, Struct, Structs
from drake_leg.simulink.matlab.matfiles import names_of_mat, read_mat
from drake_leg.simulink.reader import read_model

h5py = pytest.importorskip("h5py", reason="the extra hdf5 is not installed")

HEADER = b"MATLAB 7.3 MAT-file, Platform: GLNXA64, Created on: Mon Nov 30 12:00:00 2026 HDF5"


class Writer:
    """Writes values as MATLAB does: dimensions reversed, classes as attributes, references."""

    def __init__(self, path):
        self.path, self._count = path, 0
        self.file = h5py.File(path, "w", userblock_size=512)

    def close(self):
        self.file.close()
        with self.path.open("r+b") as file:
            file.write(HEADER.ljust(124) + b"\x00\x02IM")
        return self.path

    def array(self, name, values, kind="double", *, dtype=None, group=None):
        values = np.atleast_2d(np.asarray(values, dtype=dtype))
        return self._kept(group, name, values.T, kind)

    def text(self, name, text, *, group=None):
        letters = np.array([[ord(sign)] for sign in text], dtype=np.uint16)
        return self._kept(group, name, letters, "char")

    def empty(self, name, shape, kind, *, group=None):
        made = self._kept(group, name, np.array(shape, dtype=np.uint64), kind)
        made.attrs["MATLAB_empty"] = np.uint8(1)
        return made

    def cell(self, name, shape, write):
        """Write a cell; ``write`` is called with the place of each element, column after column."""
        return self._kept(None, name, self.references(shape, write), "cell")

    def references(self, shape, write):
        kept = self.file.require_group("#refs#")
        found = np.empty(shape[::-1], dtype=h5py.ref_dtype)
        for place in range(found.size):
            self._count += 1
            found.flat[place] = write(place, f"item{self._count}", kept).ref
        return found

    def group(self, name, kind="struct"):
        made = self.file.create_group(name)
        made.attrs["MATLAB_class"] = np.bytes_(kind)
        return made

    def _kept(self, group, name, values, kind):
        made = (group or self.file).create_dataset(name, data=values)
        made.attrs["MATLAB_class"] = np.bytes_(kind)
        return made


@pytest.fixture
def written(tmp_path):
    return Writer(tmp_path / "data.mat")


def test_numbers_texts_and_truths_are_read(written):
    written.array("m", [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]])
    written.array("one", 7.5)
    written.array("small", [[1, 2]], "int8", dtype=np.int8)
    written.array("truth", [[1, 0]], "logical", dtype=np.uint8)
    written.text("words", "knee joint")
    parts = np.array([[(1.0, 2.0)], [(3.0, -1.0)]], dtype=[("real", "f8"), ("imag", "f8")])
    written._kept(None, "z", parts, "double")
    deep = np.arange(24.0).reshape(2, 3, 4)
    written._kept(None, "deep", deep.T, "double")
    path = written.close()
    found = read_mat(path)
    np.testing.assert_array_equal(found["m"], [[1, 2, 3], [4, 5, 6]])
    assert found["one"] == 7.5
    np.testing.assert_array_equal(found["small"], [[1, 2]])
    assert found["truth"].dtype == bool
    np.testing.assert_array_equal(found["truth"], [[True, False]])
    assert found["words"] == "knee joint"
    np.testing.assert_array_equal(found["z"], [[1 + 2j, 3 - 1j]])
    np.testing.assert_array_equal(found["deep"], deep)
    assert names_of_mat(path) == set(found)


def test_structures_and_cells_are_read(written):
    leg = written.group("leg")
    written.array("mass", 2.0, group=leg)
    inner = leg.create_group("joint")
    inner.attrs["MATLAB_class"] = np.bytes_("struct")
    written.text("name", "hip", group=inner)
    many = written.group("bodies")
    for field, values in (("m", (1.0, 2.0, 3.0)), ("r", (0.1, 0.2, 0.3))):
        many.create_dataset(
            field,
            data=written.references(
                (1, 3),
                lambda n, name, group, values=values: written.array(name, values[n], group=group),
            ),
        )

    def element(place, name, group):
        if place == 1:
            return written.text(name, "two", group=group)
        return written.array(name, place + 1.0, group=group)

    written.cell("list", (2, 2), element)
    found = read_mat(written.close())
    assert isinstance(found["leg"], Struct)
    assert found["leg"] == {"mass": 2.0, "joint": {"name": "hip"}}
    bodies = found["bodies"]
    assert isinstance(bodies, Structs)
    assert [dict(each) for each in bodies.items.flat] == [
        {"m": 1.0, "r": 0.1}, {"m": 2.0, "r": 0.2}, {"m": 3.0, "r": 0.3}
    ]  # fmt: skip
    assert bodies.items.shape == (1, 3)
    assert isinstance(found["list"], Cell)
    assert found["list"].items.tolist() == [[1.0, 3.0], ["two", 4.0]]  # column after column


def test_what_is_empty_or_sparse_is_read(written):
    written.empty("none", (0, 3), "double")
    written.empty("silence", (0, 0), "char")
    written.empty("no_cell", (1, 0), "cell")
    written.empty("no_struct", (0, 1), "struct")
    thin = written.group("thin", "double")
    thin.attrs["MATLAB_sparse"] = np.uint64(3)
    thin.create_dataset("data", data=np.array([5.0, 6.0]))
    thin.create_dataset("ir", data=np.array([2, 0], dtype=np.uint64))
    thin.create_dataset("jc", data=np.array([0, 1, 1, 2], dtype=np.uint64))
    found = read_mat(written.close())
    assert found["none"].shape == (0, 3)
    assert found["silence"] == ""
    assert found["no_cell"].items.shape == (1, 0)
    assert found["no_struct"].items.shape == (0, 1)
    np.testing.assert_array_equal(found["thin"], [[0, 0, 6], [0, 0, 0], [5, 0, 0]])


def test_values_of_a_model_come_from_such_a_file(written, tmp_path):
    written.array("w", 3.0)
    written._kept(None, "later", np.zeros((1, 1)), "timeseries")  # of a class that is not read
    path = written.close()
    built = oscillator().set("Minus", Gain="-w^2")
    model = read_model(built.write(tmp_path / "m.slx"), init=[path])
    (gain,) = [block for block in model.blocks if block.name == "Minus"]
    assert gain.parameters["Gain"] == -9.0
    assert model.variables.used == {"w": "data.mat"}
    assert set(read_mat(path)) == {"w"}


def test_what_leads_out_of_the_file_is_not_followed(written, tmp_path):
    other = Writer(tmp_path / "other.mat")
    other.array("secret", 1.0)
    other.close()
    written.array("mine", 2.0)
    written.file["theirs"] = h5py.ExternalLink("other.mat", "/secret")
    written.file["soft"] = h5py.SoftLink("/mine")
    assert read_mat(written.close()) == {"mine": 2.0}
    written = Writer(tmp_path / "raw.mat")
    (tmp_path / "raw.bin").write_bytes(np.ones(4).tobytes())
    outside = written.file.create_dataset(
        "raw", (1, 4), "f8", external=[(str(tmp_path / "raw.bin"), 0, 32)]
    )
    outside.attrs["MATLAB_class"] = np.bytes_("double")
    with pytest.raises(LackError, match="data in other files"):
        read_mat(written.close())


def test_what_is_too_much_is_refused_before_it_is_read(written, monkeypatch):
    huge = written.file.create_dataset("huge", (1 << 20, 1 << 20), "f8", compression="gzip")
    huge.attrs["MATLAB_class"] = np.bytes_("double")
    with pytest.raises(LackError, match="unpacks to more than 100,000,000 bytes"):
        read_mat(written.close())


def test_a_cell_that_holds_itself_ends(written):
    cell = written.cell("round", (1, 1), lambda n, name, group: written.array(name, 0, group=group))
    cell[0, 0] = cell.ref
    with pytest.raises(LackError, match="deeper than 40"):
        read_mat(written.close())


@pytest.mark.parametrize("kept", [600, 1000, 2000])
def test_a_damaged_file_is_refused_in_a_sentence(written, kept):
    written.array("m", np.ones((30, 30)))
    path = written.close()
    path.write_bytes(path.read_bytes()[:kept])
    with pytest.raises(LackError, match=r"data\.mat is no \.mat file"):
        read_mat(path)
    assert names_of_mat(path) == set()


@pytest.mark.slow
def test_changed_files_are_read_or_refused(written):
    written.array("m", np.eye(3))
    written.text("words", "knee")
    written.array("mass", 2.0, group=written.group("leg"))
    written.cell("list", (2, 2), lambda n, name, group: written.array(name, n, group=group))
    path = written.close()
    whole, generator = path.read_bytes(), np.random.default_rng(0)
    sentences, count = [], cases(300)
    for _ in range(count):
        content = bytearray(whole)
        for _ in range(generator.integers(1, 6)):
            content[generator.integers(512, len(content))] = generator.integers(256)
        path.unlink()
        path.write_bytes(content)
        try:
            read_mat(path)
        except LackError as error:
            sentences.append(str(error))
        names_of_mat(path)
    assert 0.1 * count < len(sentences) < 0.8 * count
    assert not any("\n" in sentence for sentence in sentences)


def test_without_h5py_the_extra_is_named(written, monkeypatch):
    written.array("m", 1.0)
    path = written.close()
    monkeypatch.setitem(sys.modules, "h5py", None)
    with pytest.raises(LackError, match=r"7\.3, which h5py reads: .*drake-leg\[hdf5\].*'-v7'"):
        read_mat(path)
    assert names_of_mat(path) == set()
    assert hdf5files.REMEDY.startswith("pip install")
