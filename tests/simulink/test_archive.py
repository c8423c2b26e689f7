import os
import stat
import struct
import zipfile

import pytest
from slx_models import published_pendulum
from slx_writer import ModelBuilder, write_parts

from drake_leg.errors import InvalidValueError
from drake_leg.simulink import archive
from drake_leg.simulink.reader import read_model

ROOT = "simulink/systems/system_root.xml"


@pytest.fixture
def pendulum(tmp_path):
    return published_pendulum().write(tmp_path / "pendulum.slx")


def refused(path, sentence):
    with pytest.raises(InvalidValueError, match=sentence) as caught:
        read_model(path)
    assert str(caught.value).startswith(f"{path}: ")
    assert "\n" not in str(caught.value)


def test_no_zip(tmp_path):
    path = tmp_path / "m.slx"
    for content in (b"", b"\x00" * 100, b"%PDF-1.7", "Modell".encode("utf-16")):
        path.write_bytes(content)
        refused(path, "it is not a ZIP archive")


def test_missing_file_folder_and_pipe(tmp_path):
    refused(tmp_path / "none.slx", "it cannot be read .No such file")
    refused(tmp_path, "it is a folder; give a file")
    os.mkfifo(tmp_path / "pipe.slx")
    refused(tmp_path / "pipe.slx", "it is a pipe; give a file")


def test_protected_model(tmp_path, pendulum):
    path = pendulum.rename(tmp_path / "secret.slxp")
    refused(path, "it is a protected model, whose diagram is encrypted")


@pytest.mark.parametrize("share", [0.02, 0.3, 0.7, 0.99])
def test_truncated(pendulum, share):
    content = pendulum.read_bytes()
    pendulum.write_bytes(content[: int(share * len(content))])
    refused(pendulum, "it is cut short or damaged")


def test_damaged_part(tmp_path):
    path = write_parts(tmp_path / "m.slx", ModelBuilder().parts())
    content = bytearray(path.read_bytes())
    with zipfile.ZipFile(path) as opened:
        start = opened.getinfo(ROOT).header_offset + 30 + len(ROOT)
    content[start + 3 : start + 40] = b"\xff" * 37
    path.write_bytes(content)
    refused(path, f"its part {ROOT} is damaged")


def test_another_archive(tmp_path):
    refused(write_parts(tmp_path / "m.slx", {"word/document.xml": "<a/>"}), "it has no part")


def test_a_diagram_that_is_not_there(tmp_path):
    parts = {"simulink/blockdiagram.xml": "<ModelInformation><Model/></ModelInformation>"}
    refused(write_parts(tmp_path / "m.slx", parts), "blockdiagram.xml has no diagram")


@pytest.mark.parametrize(
    "name", ["../../outside.xml", "/etc/passwd", "a/../../b", "C:/b.xml", "..\\..\\b.xml"]
)
def test_paths_of_other_parts_do_not_matter(tmp_path, name):
    inside = tmp_path / "inside"
    inside.mkdir()
    read_model(write_parts(inside / "m.slx", {**ModelBuilder().parts(), name: "<a/>"}))
    assert [found.name for found in tmp_path.rglob("*")] == ["inside", "m.slx"]


def test_a_symbolic_link_beside_the_model_does_not_matter(pendulum):
    link = zipfile.ZipInfo("simulink/link.xml")
    link.external_attr = (stat.S_IFLNK | 0o777) << 16
    with zipfile.ZipFile(pendulum, "a") as written:
        written.writestr(link, "/etc/passwd")
    assert read_model(pendulum).blocks


def test_encrypted(pendulum):
    content = bytearray(pendulum.read_bytes())
    at = content.find(b"PK\x01\x02")
    while at >= 0:
        content[at + 8] |= 1
        at = content.find(b"PK\x01\x02", at + 4)
    pendulum.write_bytes(content)
    refused(pendulum, "is encrypted")


def test_another_packing(tmp_path):
    with zipfile.ZipFile(tmp_path / "m.slx", "w", zipfile.ZIP_LZMA) as written:
        written.writestr(ROOT, "<System/>")
    refused(tmp_path / "m.slx", "is packed in a way that Simulink does not use")


def test_two_parts_of_one_name(tmp_path):
    with zipfile.ZipFile(tmp_path / "m.slx", "w") as written:
        written.writestr(ROOT, "<System/>")
        with pytest.warns(UserWarning, match="Duplicate name"):
            written.writestr(ROOT, "<System/>")
    refused(tmp_path / "m.slx", "it has two parts named")


def test_bomb_of_one_part(tmp_path):
    parts = {**ModelBuilder().parts(), "bomb": b"\0" * (20 << 20)}
    refused(write_parts(tmp_path / "m.slx", parts), "unpacks to more than 200 times its size")


def test_bomb_by_its_claim(tmp_path):
    path = write_parts(tmp_path / "m.slx", ModelBuilder().parts())
    content = bytearray(path.read_bytes())
    at = content.find(b"PK\x01\x02")
    content[at + 24 : at + 28] = struct.pack("<L", 0xFFFF_0000)
    path.write_bytes(content)
    refused(path, "unpack to more than 256 MiB")


def test_bomb_of_many_parts(tmp_path, monkeypatch):
    monkeypatch.setattr(archive, "MOST_PARTS", 50)
    parts = ModelBuilder().parts() | {f"part{place}": "" for place in range(60)}
    refused(write_parts(tmp_path / "m.slx", parts), "it has 63 parts, more than any model")
    monkeypatch.setattr(archive, "LARGEST_DIRECTORY", 1000)
    refused(tmp_path / "m.slx", "it lists more parts than any model has")
    monkeypatch.setattr(archive, "LARGEST_FILE", 1000)
    refused(tmp_path / "m.slx", r"it has \d+ bytes or more, and at most 1000 are read")


@pytest.mark.parametrize(("claim", "sentence"), [(5, "is damaged"), (90_000, "is cut short")])
def test_a_false_claim(tmp_path, claim, sentence):
    path = write_parts(tmp_path / "m.slx", published_pendulum().parts())
    content = bytearray(path.read_bytes())
    at = content.find(b"PK\x01\x02")
    while content[at + 46 : at + 46 + len(ROOT)] != ROOT.encode():
        at = content.find(b"PK\x01\x02", at + 4)
    content[at + 24 : at + 28] = struct.pack("<L", claim)
    path.write_bytes(content)
    refused(path, f"its part {ROOT} {sentence}")


ENTITY_BOMB = (
    '<!DOCTYPE a [<!ENTITY a "ha"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;&a;&a;">'
    '<!ENTITY c "&b;&b;&b;&b;&b;&b;&b;&b;&b;&b;">]><System><P Name="x">&c;</P></System>'
)
OUTSIDE = '<!DOCTYPE a [<!ENTITY a SYSTEM "file:///etc/passwd">]><System><P>&a;</P></System>'


@pytest.mark.parametrize("content", [ENTITY_BOMB, OUTSIDE, "<!DOCTYPE a><System/>"])
def test_entities_and_document_types(tmp_path, content):
    parts = ModelBuilder().parts() | {ROOT: content}
    refused(write_parts(tmp_path / "m.slx", parts), "declares a document type or an entity")


@pytest.mark.parametrize(
    ("content", "sentence"),
    [
        ("", "is not XML .no element found, line 1"),
        ("<System>", "is not XML .no element found"),
        ("<System></Block>", "is not XML .mismatched tag"),
        ("<System>&a;</System>", "is not XML .undefined entity"),
        (b"<System>\xff\xfe</System>", "is not XML .not well-formed"),
        ("<?xml version='1.0' encoding='klingon'?><System/>", "is in an encoding"),
        ("<a>" * 300, "deeper than 200 levels"),
    ],
)
def test_what_is_no_xml(tmp_path, content, sentence):
    parts = ModelBuilder().parts() | {ROOT: content}
    refused(write_parts(tmp_path / "m.slx", parts), sentence)


def test_other_encodings_are_read(tmp_path):
    builder = ModelBuilder()
    builder.add_block("Gain", "Größe")
    parts = builder.parts()
    for encoding in ("utf-16", "iso-8859-1", "windows-1252"):
        text = parts[ROOT].replace("utf-8", encoding)
        model = read_model(
            write_parts(tmp_path / f"{encoding}.slx", parts | {ROOT: text.encode(encoding)})
        )
        assert model.blocks[0].name == "Größe"


def test_nothing_is_unpacked(pendulum):
    before = sorted(pendulum.parent.rglob("*"))
    read_model(pendulum)
    assert sorted(pendulum.parent.rglob("*")) == before
