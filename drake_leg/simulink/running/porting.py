"""A model written as a script that builds the same diagram, and runs without the model's file."""

from __future__ import annotations

import ast
import json
import math
import re
import runpy
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, fields, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from pydrake.systems.framework import System

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.dynamics.driven import DrivenMechanism
from drake_leg.simulink.dynamics.system import Contact, mechanism_dynamics
from drake_leg.simulink.matlab.compiling import compiled
from drake_leg.simulink.model import Model, Value
from drake_leg.simulink.running import operations
from drake_leg.simulink.running.code import NAMESPACE, Call, Recorded, literal
from drake_leg.simulink.running.columns import labels_of
from drake_leg.simulink.running.compiling import Code
from drake_leg.simulink.running.diagram import Array, ModelDiagram
from drake_leg.simulink.running.folding import WIDTH, folded
from drake_leg.simulink.running.kinds.functions import Expression
from drake_leg.simulink.running.replaying import position_labels
from drake_leg.simulink.running.running import Runnable
from drake_leg.simulink.running.settings import shape_of
from drake_leg.simulink.wiring import physical_part

INLINE = 400  # numbers of an array that are written in the script; more are in the data beside it
OWN = {
    "source",
    "scope",
    "written",
    "loops",
}  # fields of the code that the script has in another form
SAID = {
    "commands": "Return what enters the mechanism.",
    "derivatives": "Return the derivatives of the continuous states.",
    "record": "Return what sinks show.",
    "major": "Change what blocks remember, at sample times and major steps.",
    "edges": "Return the signals whose changes of sign let something happen.",
}
TITLES = {
    "x": "continuous states at the start",
    "memory": "what blocks remember at the start",
    "rates": "sample times: period and offset [s]",
    "recorded": "what sinks show",
    "states": "their names",
    "read_at_once": "what is sensed and not only shown",
    "fastest": "of filters, the reciprocal of the shortest time constant [1/s]",
    "begins": "time of the signals at the start [s]",
    "breaks": "times at which signals have corners [s]",
}
PYDRAKE = {
    "Diagram": "pydrake.systems.framework",
    "DiagramBuilder": "pydrake.systems.framework",
    "TriggerType": "pydrake.systems.framework",
    "LogVectorOutput": "pydrake.systems.primitives",
}
NOTHING = (["pass"], ["u = zeros(0)", "return u"], ["dx = zeros(0)", "return dx"],
           ["r = []", "return r"], ["r = joined()", "return r"])  # fmt: skip
END = ['if __name__ == "__main__":', "    main()"]
SENSED = re.compile(r"^# sensed at ([^#]+)#\w+:\d+$")
MATLAB: dict[str, Callable[..., Any]] = {"compiled": compiled, "Expression": Expression}
RUNNING = "drake_leg.simulink.running"
MODULES = {
    **PYDRAKE,
    "Path": "pathlib",
    "CubicSpline": "scipy.interpolate",
    "compiled": "drake_leg.simulink.matlab.compiling",
    "Expression": f"{RUNNING}.kinds.functions",
    "shown": f"{RUNNING}.ported",
    "Label": f"{RUNNING}.columns",
    "columns_of": f"{RUNNING}.columns",
    "figures_of": f"{RUNNING}.columns",
    "recording_of": f"{RUNNING}.columns",
    "SignalSystem": f"{RUNNING}.system",
    "WrittenCode": f"{RUNNING}.ported",
    "mechanism_from": f"{RUNNING}.ported",
    "simulated": f"{RUNNING}.ported",
    "figure_of": "drake_leg.pictures.plots.scope_plots",
    "save": "drake_leg.pictures.plots.style",
}
WHOLE = {"json": "import json", "math": "import math", "np": "import numpy as np",
         "sys": "import sys"}  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class Script:
    """A ported model."""

    text: str  # Python
    data: str  # JSON, of a file beside it; "" where it needs none


def ported(
    model: Model,
    ready: Runnable,
    name: str,
    *,
    contact: Contact = "smooth",
    accuracy: float | None = None,
) -> Script:
    """Write a model that is ready to run as a script of a name, with what it needs beside it.

    The script is carried out once: its diagram shows, and drives its mechanism with, the same at
    the start.

    Raises
    ------
    InvalidValueError
        If the model has something that cannot be written.
    """
    writing = _Writing(model, ready, name, contact, accuracy)
    script = Script(text=writing.text(), data=writing.data())
    _prove(script, ready, name)
    return script


def data_name(name: str) -> str:
    """Name the file of data beside a script."""
    return f"{name}_data.json"


class _Writing:
    def __init__(
        self, model: Model, ready: Runnable, name: str, contact: Contact, accuracy: float | None
    ) -> None:
        self._ready, self._name = ready, name
        self._title = model.name.replace("\\", "/").replace('"', "'")
        self._contact, self._accuracy = contact, accuracy
        self._mechanism = _mechanism_data(model, contact) if ready.diagram.mechanism else None
        self._arrays: dict[str, Any] = {}
        self._paths = {block.sid: block.path or block.name for block in model.blocks}
        functions = [text.strip("\n") for text in ready.code.source.split("\n\n\n")]
        self._functions = [text for text in functions if _does_something(text)]

    def data(self) -> str:
        """Return the data beside the script."""
        found: dict[str, Any] = {}
        if self._mechanism is not None:
            found["mechanism"] = self._mechanism
        if self._arrays:
            found["arrays"] = self._arrays
        return _json_lines(found) if found else ""

    def text(self) -> str:
        """Return the script."""
        first = [*self._constants()]
        if self._mechanism is not None or self._arrays:
            place = f"Path(__file__).with_name({data_name(self._name)!r})"
            first = [f'data = json.loads({place}.read_text(encoding="utf-8"))', *first]
        parts = [[*self._signals()], [*self._diagram()], [*self._main()], END]
        if first:
            parts = [first, *parts]
        body = "\n\n\n".join("\n".join(lines) for lines in parts)
        between = "\n\n" if first else "\n\n\n"
        return f"{self._head()}{_imports(body)}{between}{body}\n"

    def _head(self) -> str:
        title = self._title
        return (
            f'"""{title}: a Simulink model as a Drake diagram, written by `drake-leg port`.\n\n'
            "It runs without the model's file, and needs drake_leg:\n\n"
            f"    python {self._name}.py DIR\n\n"
            "simulates it, and writes what its sinks show into the folder DIR, with figures.\n"
            '"""\n\n'
        )

    # --- constants ---

    def _constants(self) -> Iterator[str]:
        used = _names_in(self._ready.code.source)
        for name, value in self._ready.code.scope.items():
            if name in NAMESPACE or name not in used:
                continue
            line = f"{name} = {self._constant(name, value)}"
            if len(line) > WIDTH and isinstance(value, np.ndarray) and value.ndim == 2:
                yield from _rows(name, value)
            else:
                yield from folded(line, 0)

    def _constant(self, name: str, value: Any) -> str:  # noqa: ANN401 - of any kind
        call = self._ready.code.written.get(name)
        if call is not None:
            return _called(call)
        if isinstance(value, np.ndarray) and value.size > INLINE and value.dtype == float:
            self._arrays[name] = value.tolist()
            return f'array(data["arrays"]["{name}"])'
        return _written(value, name)

    # --- systems ---

    def _signals(self) -> Iterator[str]:
        mechanism = self._ready.diagram.mechanism
        ports = self._ready.ports
        commands = max((place.stop for place in ports.inputs.values()), default=0)
        yield "class Signals(SignalSystem):"
        yield f'    """The blocks of signals of {self._title}, in the order in which they run.'
        yield ""
        yield "    In its functions, t is the time [s], x are the continuous states, m is what"
        yield "    blocks remember; y is what the mechanism senses of its state, e of forces and"
        yield "    accelerations."
        yield '    """'
        yield ""
        yield "    def __init__(self) -> None:"
        yield "        code = WrittenCode("
        calls = ", ".join(f"self.{_name_of(function)}" for function in self._functions)
        yield f"            calls=({calls}{',' if len(self._functions) == 1 else ''}),"
        for field in fields(Code):
            yield from self._field(field.name, getattr(self._ready.code, field.name))
        yield "        )"
        sizes = f"sensed={ports.y.size}, efforts={ports.e.size}, commands={commands}"
        yield f"        super().__init__(code{f', {sizes}' if mechanism else ''})"
        for function in self._functions:
            yield ""
            yield "    @staticmethod"
            head, *lines = function.split("\n")
            yield f"    {head}"
            yield f'        """{SAID[_name_of(function)]}"""'
            for line in lines:
                indent = 4 + len(line) - len(line.lstrip())
                yield from folded(self._told(line.strip()), indent)

    def _field(self, name: str, value: Any) -> Iterator[str]:  # noqa: ANN401 - of any kind
        """Write a field of the code, unless it has none of it."""
        if name in OWN or not (value.size if isinstance(value, np.ndarray) else value):
            return
        if name in TITLES:
            yield f"            # {TITLES[name]}"
        if name == "recorded":
            yield "            recorded=("
            for each in value:
                yield from folded(f"{_recorded(each)},", 16)
            yield "            ),"
            return
        yield from folded(f"{name}={_written(value, name)},", 12)

    def _told(self, line: str) -> str:
        """Name the block at whose port something is sensed."""
        return SENSED.sub(lambda found: f"# {self._paths.get(found[1], found[1])}", line)

    def _diagram(self) -> Iterator[str]:
        diagram = self._ready.diagram
        signals = diagram.signals
        yield "class Model(Diagram):"
        yield f'    """{self._title}: its signals, its mechanism, and what they record."""'
        yield ""
        yield "    def __init__(self) -> None:"
        yield "        super().__init__()"
        yield "        builder = DiagramBuilder()"
        yield '        self.signals = builder.AddNamedSystem("signals", Signals())'
        if diagram.mechanism is None:
            yield "        self.mechanism = None"
        else:
            driven = ".driven()" if isinstance(diagram.mechanism, DrivenMechanism) else ""
            yield f'        mechanism = mechanism_from(data["mechanism"]){driven}'
            yield '        self.mechanism = builder.AddNamedSystem("mechanism", mechanism)'
            yield "        mechanism.read_at_once(self.signals.code.read_at_once)"
            for port in ("sensed", "now", "efforts"):
                if signals.HasInputPort(port):
                    yield "        builder.Connect("
                    yield f'            mechanism.GetOutputPort("{port}"),'
                    yield f'            self.signals.GetInputPort("{port}"),'
                    yield "        )"
            if signals.HasOutputPort("u"):
                yield "        builder.Connect("
                yield '            self.signals.GetOutputPort("u"),'
                yield '            mechanism.GetInputPort("u"),'
                yield "        )"
        scopes = _log("self.signals", "scopes") if diagram.scopes is not None else "None"
        states = _log("mechanism", "state") if diagram.states is not None else "None"
        yield f"        self.scopes = {scopes}"
        yield f"        self.states = {states}"
        yield "        builder.BuildInto(self)"

    # --- the run ---

    def _main(self) -> Iterator[str]:
        ready = self._ready
        yield "labels = ("
        labels, mechanism = labels_of(ready.code.recorded, ready.network), ready.diagram.mechanism
        if mechanism is not None:
            labels += position_labels(mechanism.plant, labels)
        for label in labels:
            said = ", ".join(repr(part) for part in label)
            yield from folded(f"Label({said}),", 4)
        yield ")"
        yield ""
        yield ""
        yield "def run():"
        yield '    """Simulate the model."""'
        given = [f"name={self._title!r}"]
        if ready.start is not None:
            given.append(f"start={_written(ready.start, 'start')}")
        given += [f"{key.replace(' ', '_')}={literal(v)}" for key, v in ready.solver.items()]
        if self._accuracy is not None:
            given.append(f"accuracy={self._accuracy!r}")
        yield from folded(f"return simulated(Model(), {', '.join(given)})", 4)
        yield ""
        yield ""
        yield "def main() -> None:"
        yield '    """Simulate the model, and write what its sinks show: a table, and figures."""'
        yield f"    folder = Path(sys.argv[1] if len(sys.argv) > 1 else {f'{self._name}_run'!r})"
        yield "    done = run()"
        yield "    shown = [each.values for each in done.shown]"
        if mechanism is not None:
            count = mechanism.plant.num_positions()
            yield f"    shown.append(done.states[:, :{count}])  # positions of its joints"
        yield "    columns = columns_of(labels, shown)"
        yield "    folder.mkdir(parents=True, exist_ok=True)"
        yield '    recording_of(done.time, columns).write_csv(folder / "recording.csv")'
        yield "    for sink in figures_of(columns):"
        yield f"        figure = figure_of({self._title!r}, done.time, sink)"
        yield '        save(figure, folder, sink.file_name, ("png",))'
        yield '    print(f"wrote {folder}: {len(done.time)} rows, to {done.ended:g} s")'
        yield "    if done.stopped:"
        yield "        print(done.stopped)"


# --- text ----------------------------------------------------------------------------------------


def _log(system: str, port: str) -> str:
    inner = f'{system}.GetOutputPort("{port}"), builder, {{TriggerType.kForced}}'
    return f"LogVectorOutput(\n            {inner}\n        )"


def _does_something(function: str) -> bool:
    lines = function.split("\n")[1:]
    return [line.strip() for line in lines] not in NOTHING


def _recorded(each: Recorded) -> str:
    shape = shape_of(each.value)
    return f"shown({each.block!r}, {each.port}, {each.name!r}{f', {shape}' if shape else ''})"


def _names_in(text: str) -> set[str]:
    return {node.id for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Name)}


def _name_of(function: str) -> str:
    return function[len("def ") : function.index("(")]


def _imports(body: str) -> str:
    used = _names_in(body)
    modules: dict[str, list[str]] = {}
    for name in sorted(used):
        module = MODULES.get(name) or (_module_of(name) if name in NAMESPACE else "")
        if module:
            modules.setdefault(module, []).append(name)
    lines = [
        (_rank(module), 1, module, f"from {module} import {', '.join(names)}")
        for module, names in modules.items()
    ]
    for name, text in WHOLE.items():
        if name in used:
            lines.append((_rank(text.split()[1]), 0, text, text))
    groups: dict[int, list[str]] = {}
    for rank, _, _, text in sorted(lines):
        groups.setdefault(rank, []).extend(_folded_import(text))
    return "\n\n".join("\n".join(groups[rank]) for rank in sorted(groups))


def _rank(module: str) -> int:
    """Whether a module is Python's own, another's, or of this package."""
    package = module.partition(".")[0]
    return {"numpy": 1, "pydrake": 1, "scipy": 1, "drake_leg": 2}.get(package, 0)


def _folded_import(line: str) -> list[str]:
    """Fold an import that is too long for a line."""
    head, _, names = line.partition(" import ")
    if len(line) <= WIDTH or not names:
        return [line]
    return [f"{head} import (", *(f"    {name}," for name in names.split(", ")), ")"]


def _module_of(name: str) -> str:
    """Module that has a name which the code of signals uses; "" for one that is imported whole."""
    if name in WHOLE:
        return ""
    for module, text in ((operations, operations.__name__), (np, "numpy"), (math, "math")):
        if getattr(module, name, None) is NAMESPACE[name]:
            return text
    raise InvalidValueError(f"the code of signals calls {name}, which no script can import")


def _written(value: Any, name: str) -> str:  # noqa: ANN401 - of any kind
    """Write a value as Python."""
    if isinstance(value, bool | np.bool_):
        return repr(bool(value))
    if isinstance(value, np.ndarray):
        kind = "" if value.dtype == float else f", dtype={value.dtype.name!r}"
        if not value.size:
            return f"zeros({value.shape}{kind})"
        return f"array({_written(value.tolist(), name)}{kind})"
    if isinstance(value, float | np.floating):
        return literal(float(value))
    if isinstance(value, int | str) or value is None:
        return repr(value)
    if isinstance(value, tuple):
        inner = ", ".join(_written(each, name) for each in value)
        return f"({inner},)" if len(value) == 1 else f"({inner})"
    if isinstance(value, list):
        return f"[{', '.join(_written(each, name) for each in value)}]"
    if isinstance(value, frozenset):
        return f"frozenset({_written(sorted(value), name)})"
    if isinstance(value, dict):
        pairs = (f"{key!r}: {_written(each, name)}" for key, each in value.items())
        return f"{{{', '.join(pairs)}}}"
    raise InvalidValueError(f"{name} is a {type(value).__name__}, which a script cannot hold")


def _rows(name: str, matrix: Array) -> Iterator[str]:
    """Write a matrix by its rows."""
    yield f"{name} = array(["
    for row in matrix:
        yield from folded(f"{_written(row.tolist(), name)},", 4)
    yield "])"


def _called(call: Call) -> str:
    if call.function in MATLAB:
        _require_alone(call)
    words = [
        _text(each) if isinstance(each, str) else _written(each, "") for each in call.arguments
    ]
    words += [f"{key}={_written(value, key)}" for key, value in call.named.items() if value]
    return f"{call.function}({', '.join(words)})"


def _require_alone(call: Call) -> None:
    """Refuse code that calls functions in other files, which the script would not have."""
    try:
        MATLAB[call.function](*call.arguments, **call.named)
    except InvalidValueError as error:
        name = call.named.get("name", call.arguments[0])
        raise InvalidValueError(
            f"the MATLAB code {name!r} needs functions in other files, which the script would not "
            f"have: {error}"
        ) from None


def _text(text: str) -> str:
    """Write a text, over several lines where it has them."""
    if "\n" in text and '"""' not in text and "\\" not in text and not text.endswith('"'):
        return f'"""\\\n{text}"""'
    return repr(text)


# --- the mechanism -------------------------------------------------------------------------------


class _Read(dict[str, Value]):
    """Parameters that note which of them are read."""

    def __init__(self, given: Mapping[str, Value]) -> None:
        super().__init__()
        self._given = given
        self.read: dict[str, Value] = {}

    def __getitem__(self, name: str) -> Value:
        found = self._given[name]
        self.read[name] = found
        return found

    def get(self, name: str, default: Any = None) -> Any:  # noqa: ANN401 - as of a dict
        return self[name] if name in self._given else default

    def __contains__(self, name: object) -> bool:
        if name not in self._given:
            return False
        self[str(name)]
        return True

    def __iter__(self) -> Iterator[str]:
        return iter(self._given)

    def __len__(self) -> int:
        return len(self._given)

    def keys(self) -> Any:  # noqa: ANN401 - as of a dict
        return self._given.keys()

    def items(self) -> Any:  # noqa: ANN401 - as of a dict
        return [(name, self[name]) for name in self._given]


def _mechanism_data(model: Model, contact: Contact) -> dict[str, Any]:
    """Gather the blocks of a mechanism with the parameters that its dynamics read."""
    flat = physical_part(model)
    ends = {port.partition("#")[0] for node in flat.nodes for port in node}
    blocks = [
        replace(block, system="", parameters=_Read(block.parameters))
        for block in flat.blocks
        if block.sid in ends
    ]
    mechanism_dynamics(replace(flat, blocks=tuple(blocks)), contact=contact)
    listed = []
    for block in blocks:
        assert isinstance(block.parameters, _Read)
        each = {"sid": block.sid, "name": block.name, "type": block.type, "source": block.source}
        more = (
            {"path": block.path, "mask": list(block.mask)} if block.mask else {"path": block.path}
        )
        listed.append({**each, **more, "parameters": dict(block.parameters.read)})
    return {
        "name": model.name,
        "contact": contact,
        "blocks": listed,
        "connections": [list(node) for node in flat.nodes],
    }


def _json_lines(data: Mapping[str, Any]) -> str:
    """Write data as JSON, each block, connection and array on a line of its own."""
    parts = []
    for key, value in data.items():
        inner = []
        for name, each in value.items():
            if isinstance(each, list) and name in ("blocks", "connections"):
                rows = ",\n      ".join(json.dumps(row, ensure_ascii=False) for row in each)
                inner.append(f"    {json.dumps(name)}: [\n      {rows}\n    ]")
            else:
                inner.append(f"    {json.dumps(name)}: {json.dumps(each, ensure_ascii=False)}")
        parts.append(f"  {json.dumps(key)}: {{\n" + ",\n".join(inner) + "\n  }")
    return "{\n" + ",\n".join(parts) + "\n}\n"


# --- the proof -----------------------------------------------------------------------------------


def _prove(script: Script, ready: Runnable, name: str) -> None:
    """Carry the script out, and compare what its diagram puts out at the start."""
    with TemporaryDirectory() as folder:
        place = Path(folder) / f"{name}.py"
        place.write_text(script.text, encoding="utf-8")
        if script.data:
            (Path(folder) / data_name(name)).write_text(script.data, encoding="utf-8")
        theirs = _model_of(place)
    _require_whole(ready.diagram, theirs)
    ours = _outputs(ready.diagram, ready)
    for port, values in _outputs(theirs, ready).items():
        if not np.array_equal(ours[port], values, equal_nan=True):
            raise InvalidValueError(
                f"the script would differ from the model at the start, in its port {port!r}"
            )


def _require_whole(ours: ModelDiagram, theirs: ModelDiagram) -> None:
    """Refuse a script without the contacts whose shapes lie in files of CAD programs."""
    if ours.mechanism is None or theirs.mechanism is None:
        return
    kept, missing = ours.mechanism.left_out, theirs.mechanism.left_out
    lost = [kind for kind, names in missing.items() if tuple(names) != tuple(kept.get(kind, ()))]
    if lost:
        raise InvalidValueError(
            f"a script would be without {', '.join(lost)}, whose shapes are in other files"
        )


def _model_of(place: Path) -> ModelDiagram:
    names: dict[str, Any] = runpy.run_path(str(place))
    made: ModelDiagram = names["Model"]()
    return made


def _outputs(diagram: ModelDiagram, ready: Runnable) -> dict[str, Array]:
    """Return what the systems of a diagram put out at the start."""
    context = diagram.CreateDefaultContext()
    systems: list[System] = [diagram.signals]
    if diagram.mechanism is not None:
        diagram.mechanism.start(context, ready.start)
        systems.append(diagram.mechanism)
    return {
        f"{system.get_name()}:{port.get_name()}": port.Eval(system.GetMyContextFromRoot(context))
        for system in systems
        for port in (system.get_output_port(n) for n in range(system.num_output_ports()))
    }
