"""What lets a subsystem iterate: For Each, For Iterator, While Iterator; and its ports."""

from __future__ import annotations

from drake_leg.simulink.running.code import Operand, Writer
from drake_leg.simulink.running.iterating import first_value
from drake_leg.simulink.running.kinds import kind, no_inputs
from drake_leg.simulink.running.settings import shape_of
from drake_leg.simulink.running.unrolling import JOINED, count_of

SEPARATE = "Separate states for each iteration"


def _require(w: Writer, usual: dict[str, str]) -> None:
    for name, value in usual.items():
        if w.settings.text(name, value) != value:
            raise w.fault(
                f"has {name} {w.settings.text(name)!r}, which does not run: make it {value!r}"
            )


@kind("ForEach", sample_time="")
def each(w: Writer) -> None:
    """Let a subsystem run for each part of what comes in, with states of its own."""
    _require(
        w,
        {
            "IterateSubsysMaskParameter": "off",
            "StateHandling": SEPARATE,
            "NeedActiveIterationSignal": "off",
        },
    )
    if w.node.outputs:
        first = 1.0 if w.settings.text("IndexMode", "Zero-based") == "One-based" else 0.0
        w.out(f"{w.node.copy + first}")


def entered(w: Writer) -> None:
    """Put out what comes into a subsystem that iterates, or one part of it."""
    u = w.input(0)
    if not w.settings.is_on("Partition"):
        w.put(u)
        return
    axis = int(w.settings.number("PartitionDimension", "1")) - 1
    width = int(w.settings.number("PartitionWidth", "1"))
    if w.settings.number("PartitionOffset", "0") != 0.0 or axis not in (0, 1) or width < 1:
        raise w.fault("takes parts that do not follow one another, which does not run")
    shape = shape_of(u.value) or (1,)
    if isinstance(u.value, dict) or axis >= len(shape):
        raise w.fault(f"takes parts along dimension {axis + 1} of a signal that has none")
    count, rest = divmod(shape[axis], width)
    if rest:
        raise w.fault(f"takes parts of {width} out of {shape[axis]}: let them fit")
    noted = count_of(w.node.copied)
    known = w.pen.wanted.get(noted, w.pen.shapes.get(noted))
    if known is None or (noted not in w.pen.wanted and known != (count,)):
        w.pen.wanted[noted] = (count,)
    elif known != (count,):
        raise w.fault(f"takes {count} parts, where another input has {known[0]}: make them alike")
    first = min(w.node.copy, count - 1) * width
    index = f"{first}:{first + width}"
    code = "array([{0}])" if u.is_scalar else "{0}"
    w.out(f"settled({code.format(u.code)}[{index if axis == 0 else f':, {index}'}])")


@kind(JOINED, sample_time="")
def joined_copies(w: Writer) -> None:
    """Join what the copies of a subsystem put out."""
    axis = int(w.settings.number("ConcatenationDimension", "1")) - 1
    parts = [w.input(place) for place in range(w.count)]
    if axis == 0 and all(len(one.shape) < 2 for one in parts):
        w.out(f"settled(joined({', '.join(one.code for one in parts)}))")
    elif axis in (0, 1):
        listed = ", ".join(f"as_matrix({one.code})" for one in parts)
        w.out(f"settled(np.concatenate([{listed}], axis={axis}))")
    else:
        raise w.fault(f"joins along dimension {axis + 1}, which does not run")


def _leads(w: Writer, count: str, until: str, first: float) -> None:
    """Note how often, and until when, the blocks around run."""
    w.kept |= {
        "count": count,
        "until": until,
        "resets": w.settings.text("ResetStates", "held") == "reset",
    }
    number: Operand = first_value(w.pen, w, first)
    w.put(number)


@kind("ForIterator", direct=no_inputs, sample_time="")
def for_iterator(w: Writer) -> None:
    """Let a subsystem run a number of times at each step."""
    _require(w, {"ExternalIncrement": "off"})
    first = 0.0 if w.settings.text("IndexMode", "One-based") == "Zero-based" else 1.0
    if w.settings.text("IterationSource", "internal") == "external":
        w.kept["port"] = True
        _leads(w, "", "", first)
    else:
        _leads(w, f"{int(w.settings.number('IterationLimit', '5'))}", "", first)


@kind("WhileIterator", direct=no_inputs, sample_time="")
def while_iterator(w: Writer) -> None:
    """Let a subsystem run again at each step while a condition holds."""
    most = int(w.settings.number("MaxIters", "5"))
    if most < 1:
        raise w.fault("may iterate without end, which does not run: give it a maximum")
    _leads(w, f"{most}", "", 1.0)


def settled_iterator(w: Writer) -> None:
    """Read what an iterator is told, when all of its blocks are written."""
    if w.node.block.type == "ForIterator" and "port" in w.kept:
        w.kept["count"] = f"max({w.number(0).code}, 0.0)"
    if w.node.block.type == "WhileIterator":
        w.kept["until"] = f"{w.number(0).code} != 0.0"
        if w.settings.text("WhileBlockType", "while") == "while":
            w.kept["count"] = f"{w.kept['count']} if {w.number(1).code} != 0.0 else 0"
