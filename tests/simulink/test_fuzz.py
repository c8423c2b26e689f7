"""Files that somebody or something has changed: a model or one sentence, never anything else."""

import io
import json
import re
import zipfile
from functools import cache

import numpy as np
import pytest
from campaigns import cases
from mechanism_models import four_bar, pendulum
from slx_models import published_leg, published_pendulum
from slx_writer import ModelBuilder, mask_text

from drake_leg.errors import DrakeLegError
from drake_leg.simulink.listing import as_json, as_lines, as_summary
from drake_leg.simulink.multibody.bodies import mechanism_of
from drake_leg.simulink.multibody.plant import mechanism_plant, prove_mechanism
from drake_leg.simulink.reader import read_model
from drake_leg.simulink.wiring import flatten

WORDS = (
    "",
    "-1",
    "0",
    "1e999",
    "nan",
    "[",
    "((((((((((",
    "9" * 400,
    "1;2,3",
    "[1 2;3]",
    "9^9^9^9^9",
    "zeros(1e9)",
    "ones(99999,99999)",
    "1:1e12",
    "__import__('os').system('touch owned')",
    "system('touch owned')",
    "\u202e\U0001f600",
    "&#10;",
    "&bomb;",
    "1#out:1",
    "1#lconn:999999",
    "1::2#in:1",
    "../../../../owned",
    "system_1",
    "on",
    "Right",
    "global",
    "through",
    "Stateflow",
    "L",
    "L=@1;w=&2;",
    "MATLAB Function",
    "SubSystem",
    "PMIOPort",
    "Reference",
    "From",
    "sm_lib/Joints/6-DOF Joint",
    "N*m/(deg/s)",
    "mm",
)


def nested_model():
    """Draw every kind of boundary that there is."""
    builder = published_pendulum({"LowerLimitSpecify": "on", "PositionTargetValue": "30"})
    thigh = builder.add_block("SubSystem", "Thigh", ports={"in": 1, "out": 1, "lconn": 1})
    entry = builder.add_block("Inport", "In", system=thigh)
    exit_ = builder.add_block("Outport", "Out", system=thigh)
    function = builder.add_function("f", "function y = f(u)\ny = u;\n", system=thigh)
    base = builder.add_block("PMIOPort", "Base", {"Side": "Left", "Port": "1"}, system=thigh)
    builder.connect(entry, function)
    builder.connect(function, exit_)
    builder.physical(f"{base}#rconn:1", f"{base}#lconn:1")
    builder.connect(builder.add_block("From", "F"), thigh)
    builder.connect(
        thigh, builder.add_block("Scope", "S"), builder.add_block("Goto", "G", {"GotoTag": "B"})
    )
    builder.connect(builder.add_block("Sin", "Sine"), builder.add_block("Goto", "H"))
    builder.physical(f"{thigh}#lconn:1", "1#rconn:1")
    builder.blocks[thigh].mask = mask_text({"L": "30", "w": "L/2"}, "h = L/2;")
    gain = builder.add_block("Gain", "K", {"Gain": "L", "Commented": "through"}, system=thigh)
    builder.connect(entry, gain)
    builder.connect(gain, builder.add_block("Gain", "M", {"Gain": "[L 1]"}, system=thigh))
    return builder


@cache
def spans(text, pattern):
    return [found.span() for found in re.finditer(pattern, text)]


def changed_text(text, generator):
    """Change a part as text, mostly so that it stays XML: values, names, tags, pieces."""
    pattern = (r'(?<=")[^"]*(?=")', r"(?<=>)[^<>]+(?=</P>)", r"<P .*?</P>", r"</?\w+")[
        generator.choice(4, p=[0.35, 0.35, 0.2, 0.1])
    ]
    places = spans(text, pattern)
    if not places:
        return text[: generator.integers(len(text) + 1)]
    (first, last), (other, end) = (places[generator.integers(len(places))] for _ in range(2))
    match generator.integers(12):
        case 0:
            return text[:last] + text[other:end] * 3 + text[last:]
        case 1:
            return text[:first]
        case 2 | 3 | 4:
            return text[:first] + text[last:]
        case 5 | 6 | 7:
            return text[:first] + text[other:end] + text[last:]
        case _:
            return text[:first] + WORDS[generator.integers(len(WORDS))] + text[last:]


def changed_bytes(content, generator):
    """Change some bytes, or cut the end off."""
    content = bytearray(content)
    if generator.integers(4) == 0:
        return bytes(content[: generator.integers(len(content))])
    for _ in range(generator.integers(1, 3)):
        content[generator.integers(len(content))] = generator.integers(256)
    return bytes(content)


def write_changed(path, parts, generator):
    parts = dict(parts)
    names = list(parts)
    of_bytes = generator.integers(4) == 0
    for _ in range(generator.integers(1, 3) * (not of_bytes)):
        name = names[generator.integers(len(names))]
        parts[name] = changed_text(parts[name], generator)
    if generator.integers(20) == 0:
        parts.pop(names[generator.integers(len(names))], None)
    packing = zipfile.ZIP_DEFLATED if generator.integers(4) == 0 else zipfile.ZIP_STORED
    written = io.BytesIO()
    with zipfile.ZipFile(written, "w", packing) as archive:
        for name, content in parts.items():
            archive.writestr(name, content.encode(errors="replace"))
    content = written.getvalue()
    path.unlink(missing_ok=True)  # a new file is written far faster than an old one over again
    path.write_bytes(changed_bytes(content, generator) if of_bytes else content)


def complaint(path):
    """Read, list and flatten a model; return the sentence that says why not, "" if all is well."""
    try:
        model = read_model(path)
        json.dumps(as_json(model), allow_nan=False)
        as_lines(model)
        as_summary(model)
        flatten(model)
    except DrakeLegError as error:
        return str(error) or "(nothing said)\n"
    return ""


def read_changed(tmp_path, monkeypatch, count, seed):
    """Read so many changed files; return how many were read to the end."""
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "inside" / "m.slx"
    path.parent.mkdir()
    generator = np.random.default_rng(seed)
    small = ModelBuilder()
    small.connect(small.add_block("Gain", "K"), small.add_block("Scope", "S"))
    sources = [small.parts(), small.parts(layout="old")]
    sources += [nested_model().parts(layout=layout) for layout in ("new", "old")]
    sources += [published_leg().parts(layout=layout) for layout in ("new", "old")]
    shares = np.array([8, 8, 8, 8, 1, 1]) / 34
    readable = 0
    for _ in range(count):
        write_changed(path, sources[generator.choice(len(sources), p=shares)], generator)
        sentence = complaint(path)
        assert "\n" not in sentence
        readable += not sentence
    assert [found.name for found in tmp_path.rglob("*")] == ["inside", "m.slx"]
    return readable


@pytest.mark.slow
def test_some_changed_files(tmp_path, monkeypatch):
    assert 20 < read_changed(tmp_path, monkeypatch, 200, seed=1) < 180


@pytest.mark.slow
def test_thousands_of_changed_files(tmp_path, monkeypatch):
    count = cases(1500)
    assert 0.1 * count < read_changed(tmp_path, monkeypatch, count, seed=2) < 0.9 * count


@pytest.mark.slow
def test_a_changed_mechanism_is_proved_or_refused(tmp_path):
    path = tmp_path / "m.slx"
    generator = np.random.default_rng(3)
    sources = [built.parts() for built in (four_bar(), pendulum(), published_leg())]
    proved = 0
    count = cases(200)
    for _ in range(count):
        write_changed(path, sources[generator.integers(len(sources))], generator)
        try:
            mechanism = mechanism_of(read_model(path))
            plant = mechanism_plant(mechanism)
        except DrakeLegError:
            continue
        assert prove_mechanism(mechanism, plant, postures=1).holds
        proved += 1
    assert 0.05 * count < proved < 0.9 * count
