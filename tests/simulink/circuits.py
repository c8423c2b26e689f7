"""Networks of one dimension, drawn in a few lines."""

from __future__ import annotations

from rigs import Rig

FOLDERS = {
    "Electrical Elements": "Electrical", "Electrical Sources": "Electrical",
    "Electrical Sensors": "Electrical", "Mechanical Sources": "Mechanical",
    "Mechanical Sensors": "Mechanical", "Rotational Elements": "Mechanical",
    "Translational Elements": "Mechanical", "Mechanisms": "Mechanical",
    "Multibody Interfaces": "Mechanical",
}  # fmt: skip


class Circuit(Rig):
    """A model of blocks at connections, which are named."""

    def __init__(self, **more: object) -> None:
        super().__init__(**more)
        self.nets: dict[str, list[str]] = {}

    def part(self, folder: str, kind: str, name: str, ends: dict[str, str], **texts: str) -> str:
        """Add a block; ``ends`` tells by its ports at which connections it is."""
        path = f"fl_lib/{FOLDERS[folder]}/{folder}/{kind}" if folder in FOLDERS else folder + kind
        sid = self.add_library(path, name, texts)
        for port, net in ends.items():
            self.nets.setdefault(net, []).append(f"{sid}#{port}")
        return sid

    def resistor(self, name: str, p: str, n: str, R: str) -> str:
        """Add a resistor [Ohm]."""
        return self.two("Electrical Elements", "Resistor", name, p, n, R=R, R_unit="Ohm")

    def two(self, folder: str, kind: str, name: str, left: str, right: str, **texts: str) -> str:
        """Add a block between two connections."""
        ends = {"lconn:1": left, "rconn:1": right}
        return self.part(folder, kind, name, ends, **texts)

    def one(self, folder: str, kind: str, name: str, net: str, **texts: str) -> str:
        """Add a block at one connection."""
        return self.part(folder, kind, name, {"lconn:1": net}, **texts)

    def ground(self) -> str:
        """Add an electrical reference at the connection 0."""
        return self.one("Electrical Elements", "Electrical Reference", "ground", "0")

    def given(self, folder: str, kind: str, name: str, left: str, right: str, signal: str) -> str:
        """Add a source that a signal of Simulink drives."""
        sid = self.part(folder, kind, name, {"lconn:1": left, "rconn:2": right})
        enters = self.add_library(
            "nesl_utility/Simulink-PS Converter", f"to {name}", ports={"in": 1}
        )
        self.connect(signal, enters)
        self.physical(f"{enters}#rconn:1", f"{sid}#rconn:1")
        return sid

    def shows(self, port: str, name: str) -> None:
        """Show a physical signal under a name."""
        leaves = self.block("nesl_utility/PS-Simulink Converter", f"leaves {name}")
        self.physical(port, f"{leaves}#lconn:1")
        self.show(f"{leaves}#out:1", name)

    def voltage(self, p: str, n: str, name: str) -> None:
        """Show a voltage."""
        ends = {"lconn:1": p, "rconn:2": n}
        sid = self.part("Electrical Sensors", "Voltage Sensor", f"V {name}", ends)
        self.shows(f"{sid}#rconn:1", name)

    def current(self, p: str, n: str, name: str) -> None:
        """Show a current."""
        ends = {"lconn:1": p, "rconn:2": n}
        sid = self.part("Electrical Sensors", "Current Sensor", f"I {name}", ends)
        self.shows(f"{sid}#rconn:1", name)

    def motion(self, R: str, C: str, speed: str, place: str = "", *, turns: bool = True) -> None:
        """Show a velocity and a position."""
        kind = f"Ideal {'Rotational' if turns else 'Translational'} Motion Sensor"
        ends = {"lconn:1": R, "rconn:1": C}
        sid = self.part("Mechanical Sensors", kind, f"motion {speed}", ends)
        self.shows(f"{sid}#rconn:2", speed)
        if place:
            self.shows(f"{sid}#rconn:3", place)

    def write(self, path: object) -> object:
        """Draw the connections, and write the file."""
        for ports in self.nets.values():
            if len(ports) > 1:
                self.physical(*ports)
        self.nets = {}
        return super().write(path)
