"""A model written as a script that builds the same diagram, and runs without the model's file."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import fields
from textwrap import wrap
from typing import Any

import numpy as np

from drake_leg.simulink.dynamics.driven import DrivenMechanism
from drake_leg.simulink.dynamics.system import Contact
from drake_leg.simulink.model import Model, vector
from drake_leg.simulink.running.code import NAMESPACE, Recorded, literal
from drake_leg.simulink.running.columns import labels_of
from drake_leg.simulink.running.compiling import Code
from drake_leg.simulink.running.folding import WIDTH, folded
from drake_leg.simulink.running.integrating import STEPS, automatic_step
from drake_leg.simulink.running.left_out import motion_of_another
from drake_leg.simulink.running.porting.files import Script, data_name, json_lines
from drake_leg.simulink.running.porting.functions import NotedFolders
from drake_leg.simulink.running.porting.mechanism import mechanism_data
from drake_leg.simulink.running.porting.proof import prove
from drake_leg.simulink.running.porting.text import called, imports, names_in, rows, written
from drake_leg.simulink.running.replaying import position_labels
from drake_leg.simulink.running.running import Runnable
from drake_leg.simulink.running.settings import shape_of

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
NOTHING = (["pass"], ["u = zeros(0)", "return u"], ["dx = zeros(0)", "return dx"],
           ["r = []", "return r"], ["r = joined()", "return r"])  # fmt: skip
END = ['if __name__ == "__main__":', "    main()"]
SENSED = re.compile(r"^# sensed at ([^#]+)#\w+:\d+$")


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
    prove(script, ready, name)
    return script


class _Writing:
    def __init__(
        self, model: Model, ready: Runnable, name: str, contact: Contact, accuracy: float | None
    ) -> None:
        self._ready, self._name = ready, name
        self._title = model.name.replace("\\", "/").replace('"', "'")
        self._contact, self._accuracy = contact, accuracy
        self._step = model.solver.get("FixedStep")
        found = model.variables.workspace.folders if model.variables else None
        self._folders = None if found is None else NotedFolders(found)
        self._mechanism = mechanism_data(model, contact) if ready.diagram.mechanism else None
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
        if self._functions_beside:
            found["functions"] = self._functions_beside
        return json_lines(found) if found else ""

    @property
    def _functions_beside(self) -> dict[str, list[str]]:
        return {} if self._folders is None else self._folders.texts()

    def text(self) -> str:
        """Return the script."""
        first = [*self._constants()]
        if self._functions_beside:
            first = ['functions = WrittenFunctions(data["functions"])', *first]
        if self._mechanism is not None or self._arrays or self._functions_beside:
            place = f"Path(__file__).with_name({data_name(self._name)!r})"
            first = [f'data = json.loads({place}.read_text(encoding="utf-8"))', *first]
        parts = [[*self._signals()], [*self._diagram()], [*self._main()], END]
        if first:
            parts = [first, *parts]
        body = "\n\n\n".join("\n".join(lines) for lines in parts)
        between = "\n\n" if first else "\n\n\n"
        return f"{self._head()}{imports(body)}{between}{body}\n"

    def _head(self) -> str:
        title = self._title
        return (
            f'"""{title}: a Simulink model as a Drake diagram, written by `drake-leg port`.\n\n'
            "It runs without the model's file, and needs drake_leg:\n\n"
            f"    python {self._name}.py DIR --duration SECONDS\n\n"
            "simulates it, and writes what its sinks show into the folder DIR, with figures.\n"
            f'{self._warning()}"""\n\n'
        )

    def _warning(self) -> str:
        """Say where the motion is not that of the model."""
        lines = [
            line
            for said in motion_of_another(self._ready.left_out)
            for line in wrap(f"WARNING: {said}.".replace("\\", "/").replace('"', "'"), WIDTH)
        ]
        return "".join(f"{line}\n" for line in ["", *lines]) if lines else ""

    # --- constants ---

    def _constants(self) -> Iterator[str]:
        used = names_in(self._ready.code.source)
        for name, value in self._ready.code.scope.items():
            if name in NAMESPACE or name not in used:
                continue
            line = f"{name} = {self._constant(name, value)}"
            if len(line) > WIDTH and isinstance(value, np.ndarray) and value.ndim == 2:
                yield from rows(name, value)
            else:
                yield from folded(line, 0)

    def _constant(self, name: str, value: Any) -> str:  # noqa: ANN401 - of any kind
        call = self._ready.code.written.get(name)
        if call is not None:
            return called(call, self._folders)
        if isinstance(value, np.ndarray) and value.size > INLINE and value.dtype == float:
            self._arrays[name] = value.tolist()
            return f'array(data["arrays"]["{name}"])'
        return written(value, name)

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
        if self._ready.code.closing and mechanism is not None:
            sizes += f", state={mechanism.GetOutputPort('state').size()}"
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
        yield from folded(f"{name}={written(value, name)},", 12)

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
            for port in ("sensed", "now", "efforts", "state"):
                if signals.HasInputPort(port):
                    yield "        builder.Connect("
                    yield f'            mechanism.GetOutputPort("{port}"),'
                    yield f'            self.signals.GetInputPort("{port}"),'
                    yield "        )"
            if self._ready.code.closing:
                yield "        self.signals.close(mechanism.respond)"
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
        duration = literal(ready.solver["duration"])
        yield f"def run(duration={duration}):"
        yield '    """Simulate the model for so long [s]."""'
        given = [f"name={self._title!r}"]
        if ready.start is not None:
            given.append(f"start={written(ready.start, 'start')}")
        given += [f"{key.replace(' ', '_')}={value}" for key, value in self._solver().items()]
        if self._accuracy is not None:
            given.append(f"accuracy={self._accuracy!r}")
        yield from folded(f"return simulated(Model(), {', '.join(given)})", 4)
        yield ""
        yield ""
        yield "def main() -> None:"
        yield '    """Simulate the model, and write what its sinks show: a table, and figures."""'
        folder = f"{self._name}_run"
        yield "    parser = argparse.ArgumentParser(description=main.__doc__)"
        yield from folded(
            f"parser.add_argument('folder', nargs='?', type=Path, default={folder!r}, "
            f"help={f'folder to write (default {folder})'!r})",
            4,
        )
        yield from folded(
            f"parser.add_argument('--duration', type=positive, default={duration}, "
            "help='of the run [s] (default %(default)s)')",
            4,
        )
        yield "    parser.add_argument("
        yield "        '--overwrite', action='store_true', help='replace an earlier recording'"
        yield "    )"
        yield "    given = parser.parse_args()"
        yield "    folder = given.folder"
        yield '    if (folder / "recording.csv").exists() and not given.overwrite:'
        yield '        parser.error(f"{folder} has a recording: name another, or add --overwrite")'
        yield "    done = run(given.duration)"
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

    def _solver(self) -> dict[str, str]:
        """Write the settings of the solver; an automatic step is a part of the duration."""
        found = {key: literal(value) for key, value in self._ready.solver.items()}
        if not vector(self._step) and self._ready.solver.get("fixed step") == automatic_step(
            self._ready.solver["duration"], None
        ):
            found["fixed step"] = f"duration / {STEPS}"
        return {**found, "duration": "duration"}


def _log(system: str, port: str) -> str:
    inner = f'{system}.GetOutputPort("{port}"), builder, {{TriggerType.kForced}}'
    return f"LogVectorOutput(\n            {inner}\n        )"


def _does_something(function: str) -> bool:
    lines = function.split("\n")[1:]
    return [line.strip() for line in lines] not in NOTHING


def _recorded(each: Recorded) -> str:
    shape = shape_of(each.value)
    return f"shown({each.block!r}, {each.port}, {each.name!r}{f', {shape}' if shape else ''})"


def _name_of(function: str) -> str:
    return function[len("def ") : function.index("(")]
