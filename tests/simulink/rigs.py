"""Small models of signals, drawn in a few lines, and what they put out."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from slx_writer import ModelBuilder

from drake_leg.simulink.reader import read_model
from drake_leg.simulink.running.compiling import Code, Ports, compile_signals
from drake_leg.simulink.running.network import signal_network
from drake_leg.simulink.running.running import ModelRun, run_model, runnable


class Rig(ModelBuilder):
    """A model in the making; every block that is asked for is shown under its name."""

    def block(self, kind: str, name: str, *inputs: str, system: str = "", **parameters: str) -> str:
        """Add a block behind others, and return its SID; ``Library/Name`` is a library's."""
        ports = {"in": len(inputs), "out": 1}
        if "/" in kind:
            sid = self.add_library(kind, name, parameters, ports=ports, system=system)
        else:
            sid = self.add_block(kind, name, parameters, ports=ports, system=system)
        for place, source in enumerate(inputs, 1):
            if source:
                self.connect(source, f"{sid}#in:{place}")
        return sid

    def show(self, source: str, name: str, system: str = "") -> str:
        """Show a signal under a name."""
        return self.block("ToWorkspace", f"to {name}", source, VariableName=name, system=system)

    def constant(self, value: str) -> str:
        """Add a constant."""
        return self.block("Constant", f"value {len(self.blocks)}", Value=value)

    def code(self, folder: Path) -> Code:
        """Compile the signals."""
        model = read_model(self.write(folder / "rig.slx"))
        return compile_signals(signal_network(model), Ports())

    def values(self, folder: Path, time: float = 0.0) -> dict[str, object]:
        """Compute what is shown, with the states at the start."""
        code = self.code(folder)
        none = np.zeros(0)
        with np.errstate(all="ignore"):
            shown = code.functions()["record"](time, code.x.tolist(), list(code.memory), none, none)
        return {each.name: value for each, value in zip(code.recorded, shown, strict=False)}

    def run(self, folder: Path, duration: float = 1.0, accuracy: float = 1e-9) -> ModelRun:
        """Run the model."""
        model = read_model(self.write(folder / "rig.slx"))
        return run_model(runnable(model, duration=duration), accuracy=accuracy)


def shown(run: ModelRun, name: str) -> np.ndarray:
    """What a run shows under a name, a row of one number as a number."""
    (found,) = [each.values for each in run.shown if each.name == name]
    return found[:, 0] if found.shape[1] == 1 else found
