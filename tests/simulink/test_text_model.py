"""The text format of older models says the same as the archive of newer ones."""

import base64
from xml.etree.ElementTree import fromstring

import numpy as np
import pytest
from slx_models import published_leg
from slx_writer import ModelBuilder, mask_text, read_understood

from drake_leg.errors import DrakeLegError, InvalidValueError
from drake_leg.simulink.reader import read_model

WHOLE = "simulink/blockdiagram.xml"


def entry(name, text):
    """Write an entry as .mdl does: escaped, a long one as several strings, one a line."""
    pieces = [text[start : start + 40] for start in range(0, len(text), 40)] or [""]
    return f"{name} " + "\n".join(f'"{escaped(piece)}"' for piece in pieces)


def escaped(text):
    return text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n")


def lines_of(element, names):
    """Write an element of a ``blockdiagram.xml`` as a section."""
    if element.tag == "P":
        name, text = element.get("Name"), element.text or ""
        if name in ("Src", "Dst"):
            sid, _, port = text.partition("#")
            kind, _, number = port.partition(":")
            side = {"lconn": "LConn", "rconn": "RConn"}.get(kind)
            where = f"{side}{number}" if side else number or kind
            yield entry(f"{name}Block", names[sid])
            yield f"{name}Port {where}"
        else:
            yield entry(name, text)
        return
    if element.tag == "PortCounts":
        counts = [element.get(kind, "0") for kind in ("in", "out", "e", "t", "s", "lconn", "rconn")]
        yield f"Ports [{', '.join(counts)}]"
        return
    tag = element.get("ClassName", element.tag)
    yield f"{tag} {{"
    for key, text in element.items():
        if key != "ClassName":
            yield entry(key, text)
    for child in element:
        yield from ("  " + line for line in lines_of(child, names))
    yield "}"


def as_text(builder):
    """Write a model as .mdl, from what the writer has for the older archive."""
    root = fromstring(builder.parts(layout="old")[WHOLE])
    names = {block.get("SID"): block.get("Name") for block in root.iter("Block")}
    rows = [line for part in root for line in lines_of(part, names)]
    return "# a comment\n" + "\n".join(rows) + "\n"


def as_package(builder):
    """Write a model as a text of several parts."""
    rows = [
        '# MathWorks OPC Text Package\nModel {\n  Description "none"\n}',
        "__MWOPC_PACKAGE_BEGIN__ R2023a",
    ]
    for number, (name, text) in enumerate(builder.parts().items()):
        if number % 2:
            packed = base64.encodebytes(text.encode()).decode()
            rows += [f"__MWOPC_PART_BEGIN__ /{name} BASE64", packed]
        else:
            rows += [f"__MWOPC_PART_BEGIN__ /{name}", text]
    return "\n".join(rows)


def nested():
    builder = ModelBuilder(solver={"StopTime": "7", "SolverName": "ode45"})
    outer = builder.add_block("SubSystem", "Thigh\nlink")
    builder.blocks[outer].mask = mask_text({"L": "100"}, form="R2013")
    entry_ = builder.add_block("Inport", "u", {"Port": "1"}, system=outer)
    gain = builder.add_block("Gain", 'K "one" \\ 2', {"Gain": "[1 2; 3 4]*L"}, system=outer)
    builder.connect(entry_, gain, name="a long name of a signal, longer than a line of the file")
    return builder


@pytest.mark.parametrize("model", [published_leg, nested])
@pytest.mark.parametrize("written", [as_text, as_package])
def test_both_formats_say_the_same(tmp_path, model, written):
    builder = model()
    path = tmp_path / "m.mdl"
    path.write_text(written(builder), encoding="utf-8")
    found, expected = read_understood(path), read_understood(builder.write(tmp_path / "m.slx"))
    for ours, theirs in zip(found.blocks, expected.blocks, strict=True):
        assert (ours.sid, ours.name, ours.type, ours.source) == (
            theirs.sid,
            theirs.name,
            theirs.type,
            theirs.source,
        )
        assert dict(ours.parameters) == dict(theirs.parameters)
    assert set(found.wires) == set(expected.wires)
    assert set(map(frozenset, found.nodes)) == set(map(frozenset, expected.nodes))
    assert found.solver["StopTime"] == expected.solver["StopTime"]


def test_blocks_without_numbers_get_some(tmp_path):
    path = tmp_path / "m.mdl"
    path.write_text(
        'Model {\nSystem {\nBlock {\nBlockType Clock\nName "C"\n}\nBlock {\nBlockType Scope\n'
        'Name "S"\nPorts [1]\n}\nLine {\nSrcBlock "C"\nSrcPort 1\nPoints [0, 10;\n 20, 0]\n'
        'DstBlock "S"\nDstPort 1\n}\n}\n}\n'
    )
    model = read_understood(path)
    (wire,) = model.wires
    sids = {block.name: block.sid for block in model.blocks}
    assert (wire.source, wire.target) == (f"{sids['C']}#out:1", f"{sids['S']}#in:1")


def test_code_of_functions_is_found(tmp_path):
    path = tmp_path / "m.mdl"
    path.write_text(
        'Model {\nSystem {\nBlock {\nBlockType SubSystem\nName "F"\nSID "3"\n'
        'SFBlockType "MATLAB Function"\nSystem {\n}\n}\n}\n}\nStateflow {\nmachine {\nid 1\n}\n'
        'chart {\nid 2\nname "F"\n}\nstate {\nid 5\nchart 2\neml {\n'
        'script "function y = f(u)\\ny = 2*u;\\n"\n}\n}\ninstance {\nid 9\n'
        'name "F"\nchart 2\n}\n}\n'
    )
    (function,) = read_understood(path).functions
    assert function.script == "function y = f(u)\ny = 2*u;\n"


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("Model {\n  Name 'x'\n", "it ends within a section"),
        ("Model {\n}\n}\n", "a section ends that did not begin"),
        ("Model {\n  {\n}}\n", "a section has no name"),
        ('Model {\n  "x"\n}\n', "a value has no name"),
        ('Model {\n  Name "x\n}\n', "line 2 makes no sense"),
        ("Model {\n" + "S {\n" * 300, "more than 200 deep"),
    ],
)
def test_damaged_text_is_said(tmp_path, text, why):
    path = tmp_path / "m.mdl"
    path.write_text(text)
    with pytest.raises(InvalidValueError, match=f"cut short or damaged .*{why}"):
        read_model(path)


def test_changed_texts_give_a_model_or_a_sentence(tmp_path):
    generator = np.random.default_rng(3)
    text = as_text(nested())
    path = tmp_path / "m.mdl"
    for _ in range(150):
        first, last = sorted(generator.integers(len(text), size=2))
        last = min(last, first + int(generator.integers(1, 40)))
        path.unlink(missing_ok=True)
        path.write_text(text[:first] + text[last:])
        try:
            read_model(path)
        except DrakeLegError as error:
            assert "\n" not in str(error)  # noqa: PT017
