"""Charts in the making, as files hold them."""

from __future__ import annotations

from xml.etree.ElementTree import fromstring
from xml.sax.saxutils import escape, quoteattr

from rigs import Rig

from drake_leg.simulink.matlab.compiling import compiled
from drake_leg.simulink.stateflow import function_of, read_machine

MATLAB = "2"


def text(name: str, value: str) -> str:
    """A ``<P>`` of a name and a text."""
    return f"<P Name={quoteattr(name)}>{escape(value)}</P>"


class Drawing:
    """A chart: states, junctions and transitions inside it or one of its states."""

    def __init__(self, *, language: str = MATLAB, parallel: bool = False, **texts: str) -> None:
        self._head = text("decomposition", "SET_CHART" if parallel else "CLUSTER_CHART")
        if language:
            self._head += text("actionLanguage", language)
        self._head += "".join(text(*each) for each in texts.items())
        self._held: dict[str, list[str]] = {"": []}
        self._states: dict[str, tuple[str, str]] = {}  # name -> parent, texts
        self._numbers: dict[str, str] = {"": ""}
        self.inputs: list[str] = []
        self.outputs: list[str] = []

    def _number(self, name: str) -> str:
        return self._numbers.setdefault(name, str(len(self._numbers)))

    def data(
        self, scope: str, *names: str, initial: str = "", size: str = "", type: str = ""
    ) -> None:
        """Add data: ``INPUT``, ``OUTPUT``, ``LOCAL`` ones."""
        for name in names:
            {"INPUT": self.inputs, "OUTPUT": self.outputs}.get(scope, []).append(name)
            array = f"<array>{text('size', size)}</array>" if size else ""
            self._held[""].append(
                f"<data name={quoteattr(name)}>{text('scope', f'{scope}_DATA')}"
                f"<props>{text('initialValue', initial)}{array}</props>"
                f"{text('dataType', type or 'Inherit: Same as Simulink')}</data>"
            )

    def state(
        self,
        name: str,
        actions: str = "",
        *,
        within: str = "",
        parallel: bool = False,
        order: int = 0,
        kind: str = "",
    ) -> None:
        """Add a state with what stands behind its name."""
        self._held[name] = []
        mark = "AND_STATE" if order else "OR_STATE"
        texts = text("labelString", f"{name}{actions}") + text("type", kind or mark)
        texts += text("decomposition", "SET_STATE" if parallel else "CLUSTER_STATE")
        self._states[name] = within, texts + (text("executionOrder", str(order)) if order else "")

    def junction(self, name: str, within: str = "", kind: str = "CONNECTIVE_JUNCTION") -> None:
        """Add a junction."""
        number = self._number(name)
        self._held[within].append(f'<junction SSID="{number}">{text("type", kind)}</junction>')

    def way(self, source: str, target: str, label: str = "", *, within: str = "", order: int = 1):
        """Add a transition; a default one has no source."""
        ends = "".join(
            f"<{end}>{text('SSID', self._number(name)) if name else ''}</{end}>"
            for end, name in (("src", source), ("dst", target))
        )
        self._held[within].append(
            f"<transition>{text('labelString', label)}{ends}"
            f"{text('executionOrder', str(order))}</transition>"
        )

    def function(self, label: str, script: str) -> None:
        """Add a MATLAB function."""
        self._held[""].append(
            f'<state SSID="900">{text("labelString", label)}{text("type", "FUNC_STATE")}'
            f"<eml>{text('script', script)}</eml></state>"
        )

    def add(self, xml: str) -> None:
        """Add anything else."""
        self._held[""].append(xml)

    def content(self) -> str:
        """Return what the chart holds."""
        return f"{self._head}<Children>{self._inside('')}</Children>"

    def _inside(self, holder: str) -> str:
        states = "".join(
            f'<state SSID="{self._number(name)}">{texts}<Children>{self._inside(name)}</Children>'
            "</state>"
            for name, (within, texts) in self._states.items()
            if within == holder
        )
        return states + "".join(self._held[holder])

    # --- its steps ---

    def code(self) -> str:
        """Return its function."""
        chart = fromstring(f'<chart id="1">{text("name", "Plant/Mode")}{self.content()}</chart>')
        return function_of(read_machine(chart, [*self.inputs, *self.outputs]))

    def steps(self, *inputs: tuple[float, ...], period: float = 0.1) -> list[tuple[float, ...]]:
        """Return the outputs after steps of inputs; the time comes last, where it counts."""
        function = compiled(self.code())
        kept, found = dict(function.start()), []
        for number, given in enumerate(inputs):
            values = (*given, number * period) if "time_now" in function.inputs else given
            found.append(tuple(float(each) for each in function.call(kept, *values)))
        return found


def charted(rig: Rig, drawing: Drawing, *inputs: str, name: str = "Mode", **parameters: str) -> str:
    """Add a chart to a model; its ports stand in another order than its data."""
    ports = {"in": len(inputs), "out": len(drawing.outputs)}
    settings = {"SFBlockType": "Chart", **parameters}
    sid = rig.add_block("SubSystem", name, settings, ports=ports, script=drawing.content())
    for kind, names in (("Inport", drawing.inputs), ("Outport", drawing.outputs)):
        for place, each in enumerate(reversed(names), 1):
            rig.add_block(kind, each, {"Port": str(place)}, system=sid)
    for place, source in enumerate(inputs, 1):
        rig.connect(source, f"{sid}#in:{place}")
    return sid


def thermostat() -> Drawing:
    """It heats from below 1 to above 2; ``more`` is added to these limits."""
    made = Drawing()
    made.data("INPUT", "more", "x")
    made.data("OUTPUT", "count", "heat")
    made.state("Cool", "\nentry: heat = 0;")
    made.state("Heat", "\nentry: heat = 1; count = count + 1;")
    made.way("", "Cool")
    made.way("Cool", "Heat", "[x < 1 + more]")
    made.way("Heat", "Cool", "[x > 2 + more]")
    return made


def heated(*, sampled: bool) -> Rig:
    """A body that is heated by 3 and loses 1: x' = 3 heat - 1 from 1.55."""
    rig = Rig()
    x = rig.block("Integrator", "x", InitialCondition="1.55")
    source = rig.block("ZeroOrderHold", "each", x, SampleTime="0.12") if sampled else x
    chart = charted(rig, thermostat(), source, rig.constant("0"))
    heat = rig.block("Gain", "power", f"{chart}#out:1", Gain="3")
    rig.connect(rig.block("Sum", "sum", heat, rig.constant("1"), Inputs="+-"), f"{x}#in:1")
    rig.blocks[x].ports["in"] = 1
    rig.show(x, "x")
    rig.show(f"{chart}#out:1", "heat")
    rig.show(f"{chart}#out:2", "count")
    return rig
