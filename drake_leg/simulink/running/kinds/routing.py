"""Blocks that only carry signals: vectors, buses, selections."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from drake_leg.arguments import counted
from drake_leg.simulink.running.code import CONTINUOUS, Operand, Writer, literal
from drake_leg.simulink.running.kinds import kind
from drake_leg.simulink.running.settings import as_signal, flat, shape_of

_PASS = (
    "SignalConversion", "SignalSpecification", "Squeeze",
    "DataTypeDuplicate", "PS Signal Specification", "Unit Conversion", "PS Unit Conversion",
    "Environment Controller",
)  # fmt: skip


@kind(*_PASS, sample_time="")
def passed(w: Writer) -> None:
    """Pass a signal on."""
    w.put(w.input(0))


@kind("DataTypeConversion", sample_time="")
def converted(w: Writer) -> None:
    """Convert to another type: whole numbers are rounded and kept in their range."""
    u = w.input(0)
    kind_of_number = w.settings.text("OutDataTypeStr", "Inherit").removeprefix("Inherit").lower()
    if "int" not in kind_of_number and kind_of_number != "boolean":
        w.put(u)
        return
    if kind_of_number == "boolean":
        w.out(f"float({u.code} != 0.0)" if u.is_scalar else f"({u.code} != 0.0).astype(float)")
        return
    info = np.iinfo(kind_of_number) if kind_of_number.lstrip("u").startswith("int") else None
    if info is None:
        w.put(u)
        return
    how = w.settings.text("RndMeth", "Floor")
    name = {"Floor": "floor", "Ceiling": "ceil", "Zero": "fix"}.get(how, "rounded")
    array = {"floor": "np.floor", "ceil": "np.ceil", "fix": "np.trunc", "rounded": "rounded_array"}
    lower, upper = literal(float(info.min)), literal(float(info.max))
    if u.is_scalar:
        w.out(f"limited({name}({u.code}), {lower}, {upper})")
    else:
        w.out(f"np.clip({array[name]}({u.code}), {lower}, {upper})")


@kind("Mux", "Bus to Vector", "BusToVector", sample_time="")
def mux(w: Writer) -> None:
    """Join signals to a vector."""
    operands = w.inputs
    if len(operands) == 1 and not isinstance(operands[0].value, dict):
        w.put(operands[0])
    elif all(one.is_scalar for one in operands):
        w.out(f"array([{', '.join(one.code for one in operands)}])")
    else:
        w.out(f"joined({', '.join(one.code for one in operands)})")


@kind("Demux", sample_time="")
def demux(w: Writer) -> None:
    """Take a vector apart.

    Where only their number is given, its outputs have the sizes that the mechanism takes of them.
    """
    u = w.vector()
    if not u.code.isidentifier():
        u = w.let(u.code)
    asked = [int(each) for each in w.settings.numbers("Outputs", "4")]
    if w.is_open(0):
        count = asked[0] if len(asked) == 1 else len(asked)
        for place in range(count):
            width = max(asked[place], 1) if len(asked) > 1 else 1
            w.out("0.0" if width == 1 else f"zeros({width})", place)
        return
    if len(asked) == 1 and asked[0] > 1:
        count = asked[0]
        least, more = divmod(u.size, count)
        if not least:
            raise w.fault(
                f"takes {counted(u.size, 'number')} apart into {count} outputs: let what feeds it "
                f"put out {count} at least, as a constant [0 0 0] has 3"
            )
        widths = [least + (place < more) for place in range(count)]
        wanted = [w.pen.asked.get(port, 0) for port in w.node.outputs]
        if all(wanted) and sum(wanted) == u.size:
            widths = wanted
    else:
        widths = asked
        rest = u.size - sum(width for width in widths if width > 0)
        open_ends = [place for place, width in enumerate(widths) if width < 0]
        for number, place in enumerate(open_ends):
            share, more = divmod(rest, len(open_ends))
            widths[place] = share + (number < more)
    if sum(widths) != u.size:
        raise w.fault(
            f"takes {counted(u.size, 'number')} apart into outputs of {widths}: let what feeds it "
            f"put out {sum(widths)}, as a constant [0 0 0] has 3"
        )
    first = 0
    for place, width in enumerate(widths):
        if width == 1:
            w.out(f"float({u.code}[{first}])", place)
        else:
            w.out(f"{u.code}[{first}:{first + width}]", place)
        first += width


@kind("BusCreator", sample_time="")
def bus(w: Writer) -> None:
    """Join signals under their names."""
    names = bus_names(w)
    signals = dict(zip(names, w.inputs, strict=False))
    made = w.let(f"{{{', '.join(f'{name!r}: {one.code}' for name, one in signals.items())}}}")
    w.put(parted(w, made, signals))


def parted(w: Writer, bus: Operand, signals: Mapping[str, Operand]) -> Operand:
    """Let what reads a signal of a bus not read the others, where the bus is computed always."""
    is_current = w.rate == CONTINUOUS and not w.gates
    return replace(bus, parts=signals) if is_current else bus


def bus_names(w: Writer) -> list[str]:
    """Names of the signals of a bus: as the block lists them, or those of the lines."""
    given = w.settings.text("Inputs", "")
    if (given and not given.isdigit() and "," in given) or given.startswith("'"):
        listed = [part.strip().strip("'") for part in given.split(",")]
        if len(listed) == w.count:
            return listed
    names: list[str] = []
    for place in range(w.count):
        name = w.node.names[place].strip("<>") or f"signal{place + 1}"
        while name in names:
            name += f"_{place + 1}"
        names.append(name)
    return names


@kind("BusSelector", sample_time="")
def selected_of_bus(w: Writer) -> None:
    """Take signals out of a bus by their names."""
    asked = [part.strip() for part in w.settings.text("OutputSignals", "").split(",")]
    u = w.input(0)
    if w.is_open(0):
        for place in range(len(asked)):
            w.out("0.0", place)
        w.pen.open.update(w.node.outputs)
        return
    if not isinstance(u.value, dict):
        if len(asked) == 1:
            w.put(u)
            return
        u = w.vector()
        for place in range(len(asked)):
            w.out(f"float({u.code}[{place}])", place)
        return
    made = [of_bus(w, u, name) for name in asked]
    if w.settings.is_on("OutputAsBus"):
        items = ", ".join(f"{name!r}: {one.code}" for name, one in zip(asked, made, strict=True))
        w.out(f"{{{items}}}")
        return
    for place, one in enumerate(made):
        w.put(replace(w.let(one.code, asked[place]), parts=one.parts), place)


def joined_bus(w: Writer) -> Operand:
    """Write the bus of the signals at all inputs by their names."""
    signals = dict(zip(w.node.names, w.inputs, strict=True))
    made = w.let(written_bus({name: one.code for name, one in signals.items()}))
    return parted(w, made, {name: one for name, one in signals.items() if "." not in name})


def written_bus(signals: Mapping[str, str]) -> str:
    """Write a bus of signals by their names, in which dots lead inwards."""
    tree: dict[str, Any] = {}
    for name, code in signals.items():
        *above, last = name.split(".")
        inner = tree
        for part in above:
            inner = inner.setdefault(part, {})
        inner[last] = code

    def text(part: str | dict[str, Any]) -> str:
        if isinstance(part, str):
            return part
        return "{" + ", ".join(f"{key!r}: {text(inner)}" for key, inner in part.items()) + "}"

    return text(tree)


# Simulink's names of a signal by its place: of one without a name, and of one of several alike.
_NUMBERED = re.compile(r"signal(?P<only>\d{1,4})|.*\(signal (?P<alike>\d{1,4})\)")


def of_bus(w: Writer, bus: Operand, name: str) -> Operand:
    """Take a signal out of a bus by its name, in which dots lead inwards."""
    found = bus
    for part in name.split("."):
        code, value = found.code, found.value
        if not isinstance(value, dict) or part not in value:
            numbered = _NUMBERED.fullmatch(part)
            place = int(numbered["only"] or numbered["alike"]) if numbered else 0
            names = list(value) if isinstance(value, dict) else []
            if 0 < place <= len(names):
                part = names[place - 1]
            else:
                known = ", ".join(names[:10])
                raise w.fault(f"selects {name!r}, but the bus has {known or 'no such signal'}")
        inner = Operand(code=f"{code}[{part!r}]", value=value[part])
        found = found.parts.get(part, inner)
    return found


@kind("BusAssignment", sample_time="")
def assigned_in_bus(w: Writer) -> None:
    """Replace signals of a bus."""
    names = [part.strip() for part in w.settings.text("AssignedSignals", "").split(",")]
    items = ", ".join(f"{name!r}: {w.input(place + 1).code}" for place, name in enumerate(names))
    w.out(f"{{**{w.input(0).code}, {items}}}")


@kind("Selector", sample_time="")
def selector(w: Writer) -> None:
    """Take elements out of a vector or a matrix."""
    dimensions = int(w.settings.number("NumberOfDimensions", "1"))
    options = [
        part.strip() for part in w.settings.text("IndexOptions", "Index vector (dialog)").split(",")
    ]
    first = 1 if w.settings.text("IndexMode", "One-based") == "One-based" else 0
    u = _selected_from(w) if dimensions == 1 else w.numeric()
    shape = (u.size,) if dimensions == 1 else shape_of(u.value)
    if dimensions == 2 and u.is_scalar:
        u, shape = Operand(code=f"array([[{u.code}]])", value=np.array([[u.value]])), (1, 1)
    if dimensions == 2 and u.value.ndim == 1:
        u = Operand(code=f"{u.code}.reshape(-1, 1)", value=u.value.reshape(-1, 1))
        shape = u.shape
    texts = _index_texts(w, dimensions)
    port, places = 1, []
    for axis in range(dimensions):
        option = options[min(axis, len(options) - 1)]
        if option == "Select all":
            places.append(":")
        elif option == "Index vector (dialog)":
            indices = np.ravel(w.settings.evaluate(texts[axis], "Indices")) - first
            places.append(_listed(w, indices, shape[axis]))
        elif option == "Index vector (port)":
            index = w.input(port)
            port += 1
            at = f"selected(0, {index.code} - {first}, {shape[axis]})"
            if not index.is_scalar:
                at = f"[selected(0, i - {first}, {shape[axis]}) for i in {index.code}]"
            places.append(at)
        elif option.startswith("Starting index"):
            size = int(np.ravel(w.settings.evaluate(_sizes(w)[axis], "OutputSizes"))[0])
            if "port" in option:
                start = f"selected(0, {w.input(port).code} - {first}, {shape[axis]})"
                port += 1
            else:
                start = str(int(np.ravel(w.settings.evaluate(texts[axis], "Indices"))[0]) - first)
            places.append(
                f"{start}:{start} + {size}" if "(" in start else f"{start}:{int(start) + size}"
            )
        else:
            raise w.fault(f"selects by {option!r}, which does not run")
    if dimensions == 2 and all(place.startswith("[") for place in places):
        code = f"{u.code}[np.ix_({', '.join(places)})]"
    else:
        code = f"{u.code}[{', '.join(places)}]"
    w.out(f"settled({code})")


def _selected_from(w: Writer) -> Operand:
    """Return the vector that is selected from; where nothing is given, one of zeros."""
    if not w.is_open(0):
        return w.vector()
    return w.let(f"zeros({int(w.settings.number('InputPortWidth', '3'))})", "nothing")


def _index_texts(w: Writer, dimensions: int) -> list[str]:
    single = w.settings.text("Indices", "[1 3]")
    parts = parts_of(single) if dimensions > 1 else [single]
    return parts if len(parts) == dimensions else [single] * dimensions


def parts_of(text: str) -> list[str]:
    """Split a text at the commas outside of brackets."""
    found, depth = [""], 0
    for sign in text:
        depth += (sign in "([{") - (sign in ")]}")
        if sign == "," and not depth:
            found.append("")
        else:
            found[-1] += sign
    return [part.strip() for part in found]


def _sizes(w: Writer) -> list[str]:
    text = w.settings.text("OutputSizes", "1")
    parts = [part.strip() for part in text.split(",")]
    return parts if len(parts) > 1 else parts * 4


def _listed(w: Writer, indices: np.ndarray, count: int) -> str:
    for index in indices:
        if not 0 <= index < count:
            raise w.fault(f"selects element {index + 1:g} of {count}")
    return str([int(index) for index in indices])


@kind("Concatenate", "Matrix Concatenate", "Vector Concatenate", sample_time="")
def concatenated(w: Writer) -> None:
    """Join vectors, or matrices side by side or one below the other; buses become an array."""
    if all(isinstance(one.value, dict) for one in w.inputs):
        items = ", ".join(f"'({n})': {one.code}" for n, one in enumerate(w.inputs, 1))
        w.out(f"{{{items}}}")
        return
    if w.settings.text("Mode", "Vector") == "Vector":
        w.out(f"joined({', '.join(one.code for one in w.inputs)})")
        return
    axis = int(w.settings.number("ConcatenateDimension", "1")) - 1
    parts = ", ".join(f"as_matrix({one.code})" for one in w.inputs)
    w.out(f"settled(np.concatenate([{parts}], axis={axis}))")


@kind("Reshape", sample_time="")
def reshaped(w: Writer) -> None:
    """Give a signal another shape, column by column."""
    how = w.settings.text("OutputDimensionality", "1-D array")
    u = w.vector()
    if how.startswith("1-D"):
        w.put(u)
    elif how.startswith("Column"):
        w.out(f"{u.code}.reshape(-1, 1)")
    elif how.startswith("Row"):
        w.out(f"{u.code}.reshape(1, -1)")
    elif how.startswith("Customize"):
        shape = tuple(int(each) for each in w.settings.numbers("OutputDimensions", "[1 1]"))
        if np.prod(shape) != u.size:
            raise w.fault(f"gives {u.size} numbers the shape {shape}")
        w.out(f"settled({u.code}.reshape({shape}, order='F'))")
    else:
        raise w.fault(f"reshapes to {how!r}, which does not run")


@kind("PermuteDimensions", sample_time="")
def permuted(w: Writer) -> None:
    """Exchange rows and columns."""
    order = [int(each) for each in w.settings.numbers("Order", "[2,1]")]
    u = w.numeric()
    w.out(f"as_matrix({u.code}).T" if order == [2, 1] else u.code)


@kind("Assignment", sample_time="")
def assigned(w: Writer) -> None:
    """Replace elements of a vector."""
    first = 1 if w.settings.text("IndexMode", "One-based") == "One-based" else 0
    if w.settings.text("IndexOptions", "Index vector (dialog)") != "Index vector (dialog)":
        raise w.fault("takes its indices from a port, which does not run")
    indices = np.ravel(w.settings.value("Indices", "1")) - first
    u = w.vector(0)
    w.out(f"replaced({u.code}, {_listed(w, indices, u.size)}, {w.input(1).code})")


@kind("Width", constant=True)
def width(w: Writer) -> None:
    """Put out how many elements a signal has."""
    w.out(literal(float(w.input(0).size)))


@kind("Probe", sample_time="")
def probe(w: Writer) -> None:
    """Tell the width, the sample time and the size of a signal, which is never complex."""
    u = w.input(0)
    told = {
        "ProbeWidth": float(u.size),
        "ProbeSampleTime": np.array([w.period or 0.0, 0.0]),
        "ProbeComplexSignal": 0.0,
        "ProbeSignalDimensions": as_signal(np.array([u.shape or (1,)], dtype=float)),
    }
    asked = [name for name in told if w.settings.text(name, "on") == "on"]
    if "ProbeSampleTime" in asked and w.period is None:
        raise w.fault("asks for the sample time of a signal that has none: ask for others")
    for place, name in enumerate(asked):
        w.out(w.constant(told[name], name), place)


@kind("DataStoreMemory", constant=True)
def store(w: Writer) -> None:
    """Hold a value by name."""
    _slot_of_store(w, as_signal(w.settings.matrix("InitialValue", "0")))


def _slot_of_store(w: Writer, start: object) -> int:
    name = w.settings.text("DataStoreName", "A")
    stores = w.pen.stores
    if name not in stores:
        stores[name] = w.pen.slot(start)
    elif start is not None:
        w.pen.slots[stores[name]] = start
    return stores[name]


@kind("DataStoreRead")
def store_read(w: Writer) -> None:
    """Read a value by name."""
    slot = _slot_of_store(w, None)
    if w.pen.slots[slot] is None:
        w.pen.slots[slot] = 0.0
    w.out(f"m[{slot}]")


def _store_written(w: Writer) -> None:
    w.kept["slot 0"] = _slot_of_store(w, None)
    if w.pen.slots[w.kept["slot 0"]] is None:
        w.pen.slots[w.kept["slot 0"]] = flat(w.input(0).value) * 0.0
    w.remember(w.input(0).code)


@kind("DataStoreWrite", finish=_store_written, direct=lambda node, settings: ())
def store_write(w: Writer) -> None:
    """Write a value by name, at sample times and major steps."""
