"""Live scripts: their code runs as that of other scripts does."""

import zipfile

import pytest
from slx_writer import ModelBuilder

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.lacks import lacks_of
from drake_leg.simulink.matlab.live import code_of
from drake_leg.simulink.reader import read_model
from drake_leg.simulink.suggestions import suggested_init

W = "http://schemas.openxmlformats.org/wordprocessingml/2006/main"


def paragraph(text, style):
    content = f"<![CDATA[{text}]]>" if style == "code" else text
    return (
        f'<w:p><w:pPr><w:pStyle w:val="{style}"/></w:pPr><w:r><w:t>{content}</w:t></w:r></w:p>'
        "<w:p><w:pPr><w:sectPr/></w:pPr></w:p>"
    )


def live(path, *paragraphs, part="matlab/document.xml"):
    body = "".join(paragraph(text, style) for style, text in paragraphs)
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr(part, f'<w:document xmlns:w="{W}"><w:body>{body}</w:body></w:document>')
    return path


def value(path, **given):
    (block,) = (each for each in read_model(path, **given).blocks if each.type == "Gain")
    return block.parameters["Gain"]


def model(folder, text):
    builder = ModelBuilder()
    builder.add_block("Gain", "K", {"Gain": text})
    return builder.write(folder / "m.slx")


def test_only_the_code_is_read(tmp_path):
    path = live(
        tmp_path / "s.mlx", ("title", "L = 1"), ("code", "a = 2 < 3;\nb = 4;"), ("code", "c = 5;")
    )
    assert code_of(path) == "a = 2 < 3;\nb = 4;\nc = 5;"


def test_a_live_script_is_given_called_and_suggested(tmp_path):
    live(
        tmp_path / "setup.mlx",
        ("text", "The length."),
        ("code", "L = 2;"),
        ("code", "L = twice(L);"),
    )
    live(tmp_path / "twice.mlx", ("code", "function y = twice(x)\ny = 2*x;\nend"))
    (tmp_path / "main.m").write_text("setup;\nrun('setup.mlx');\nrun setup")
    path = model(tmp_path, "L")
    assert value(path, init=[tmp_path / "setup.mlx"]) == 4.0
    assert value(path, init=[tmp_path / "main.m"]) == 4.0
    read = read_model(path)
    assert suggested_init(read, lacks_of(read)).path.name == "setup.mlx"


def test_a_live_script_comes_before_a_script_of_its_name_in_its_folder(tmp_path):
    (tmp_path / "deeper").mkdir()
    (tmp_path / "main.m").write_text("setup;")
    (tmp_path / "setup.m").write_text("L = 1;")
    live(tmp_path / "deeper" / "setup.mlx", ("code", "L = 3;"))
    path = model(tmp_path, "L")
    assert value(path, init=[tmp_path / "main.m"], paths=[tmp_path]) == 1.0
    live(tmp_path / "setup.mlx", ("code", "L = 2;"))
    assert value(path, init=[tmp_path / "main.m"]) == 2.0


@pytest.mark.parametrize("damage", ["text", "empty"])
def test_what_is_no_live_script_is_refused(tmp_path, damage):
    path = tmp_path / "s.mlx"
    if damage == "text":
        path.write_text("L = 1;")
    else:
        live(path, part="other.xml")
    with pytest.raises(InvalidValueError, match=r"s\.mlx"):
        value(model(tmp_path, "L"), init=[path])
