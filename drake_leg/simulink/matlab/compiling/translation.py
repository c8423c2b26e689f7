"""One function under translation: its variables, the lines written so far, the names in use."""

from __future__ import annotations

from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from drake_leg.simulink.matlab import syntax
from drake_leg.simulink.matlab.compiling.code import (
    Code,
    UncompilableError,
    constant,
    converted,
    one_piece,
)
from drake_leg.simulink.matlab.compiling.kinds import (
    ANYTHING,
    LOST,
    Kind,
    Lost,
    Numbers,
    alike,
    is_scalar,
    is_small,
    met,
    places,
    sample,
    variable,
)
from drake_leg.simulink.matlab.compiling.source import Lines, called, is_atom, is_long, safe
from drake_leg.simulink.matlab.frames import File

if TYPE_CHECKING:
    from collections.abc import Iterator

    from drake_leg.simulink.matlab.compiling.module import Module

# ruff: noqa: ANN401 - any value of a script
MOST_NODES = 60_000  # of the tree that are translated for one function


@dataclass
class Variables:
    """What is known of the variables at one point of the code."""

    kinds: dict[str, Kind] = field(default_factory=dict)
    unsure: set[str] = field(default_factory=set)  # that may have no value
    owned: set[str] = field(default_factory=set)  # whose array nothing else refers to
    kept: frozenset[str] = frozenset()  # persistent variables

    def copy(self) -> Variables:
        """Copy them."""
        return Variables(dict(self.kinds), set(self.unsure), set(self.owned), self.kept)

    def loses(self, name: str, wanted: Kind) -> bool:
        """Whether a variable that may have no value cannot be held as wanted."""
        kind = self.kinds.get(name)
        return (
            kind is not None
            and name in self.unsure
            and places(kind) != 1
            and not alike(kind, wanted)
        )

    def joined(self, other: Variables) -> Variables:
        """Return what is known where two ways meet."""
        if self.kept != other.kept:
            raise UncompilableError("a persistent variable is declared on one way only")
        kinds: dict[str, Kind] = {}
        unsure = self.unsure | other.unsure
        for name in (*self.kinds, *(name for name in other.kinds if name not in self.kinds)):
            here, there = self.kinds.get(name), other.kinds.get(name)
            if here is not None and there is not None:
                kinds[name] = met(here, there)
                for one in (self, other):
                    if one.loses(name, kinds[name]):
                        kinds[name] = LOST
                continue
            unsure.add(name)
            only = variable(here or there or ANYTHING)
            kinds[name] = only if places(only) or only == LOST else ANYTHING
        return Variables(kinds, unsure, self.owned & other.owned, self.kept)


def places_of(name: str, kind: Kind) -> tuple[str, ...]:
    """Names of the places that hold a variable."""
    count = places(kind)
    if count == 1:
        return (f"v_{safe(name)}",)
    return tuple(f"e{k}_{safe(name)}" for k in range(count))


class Translation:
    """One function for inputs of some kinds."""

    def __init__(
        self, module: Module, function: syntax.Function, file: File, given: int, wanted: int
    ) -> None:
        self.module, self.function, self.file = module, function, file
        self.given, self.wanted = given, wanted
        self.variables = Variables()
        self.lines = Lines()
        self.ends: list[tuple[Code, int, int]] = []  # what `end` means
        self._made = 0

    @property
    def daring(self) -> bool:
        """Whether numbers are expected to stay real and finite."""
        return self.module.daring

    def count(self) -> None:
        """Count one node of the tree."""
        self.module.nodes += 1
        if self.module.nodes > MOST_NODES:
            raise UncompilableError("it is too large")

    # --- lines --------------------------------------------------------------------------------

    def emit(self, line: Any) -> None:
        """Write a line."""
        self.lines.append(line)

    @contextmanager
    def into(self, lines: Lines) -> Iterator[Lines]:
        """Write lines elsewhere."""
        before, self.lines = self.lines, lines
        try:
            yield lines
        finally:
            self.lines = before

    def name(self) -> str:
        """Return a name that is not in use."""
        self._made += 1
        return f"t{self._made}"

    def temporary(self, piece: str) -> str:
        """Give a name to what a piece computes."""
        name = self.name()
        self.emit(f"{name} = {piece}")
        return name

    def atom(self, piece: str) -> str:
        """Make a piece one that can be written twice."""
        return piece if is_atom(piece) else self.temporary(piece)

    def atoms(self, code: Code) -> Code:
        """Make all parts of a value ones that can be written twice."""
        return Code(code.kind, tuple(map(self.atom, code.parts)), code.fresh)

    def short(self, code: Code) -> Code:
        """Give names to parts that have become long."""
        if not any(map(is_long, code.parts)):
            return code
        parts = tuple(self.temporary(one) if is_long(one) else one for one in code.parts)
        return Code(code.kind, parts, code.fresh)

    def unpacked(self, piece: str, kind: Kind) -> Code:
        """Take the elements that a piece gives into places of their own."""
        names = tuple(self.name() for _ in range(places(kind)))
        if names:
            self.emit(f"{', '.join(names)}{',' * (len(names) == 1)} = {piece}")
        return Code(kind, names, fresh=True)

    # --- variables ----------------------------------------------------------------------------

    def read(self, name: str) -> Code:
        """Return the value of a variable; others may refer to it from here on."""
        self.variables.owned.discard(name)
        return self.seen(name)

    def seen(self, name: str) -> Code:
        """Return the value of a variable of which only elements are taken."""
        kind = self.variables.kinds[name]
        if isinstance(kind, Lost):
            return Code(ANYTHING, ("lost()",))
        if isinstance(kind, Numbers) and kind.value is not None and kind.shape is not None:
            found = constant(sample(kind))
            if found is not None:
                return Code(kind, found.parts)
        return Code(kind, places_of(name, kind))

    def assign(self, name: str, code: Code) -> None:
        """Set a variable."""
        names = places_of(name, code.kind)
        self.move(names, code.parts)
        self.variables.kinds[name] = code.kind
        self.variables.unsure.discard(name)
        if code.fresh and not is_small(code.kind):
            self.variables.owned.add(name)
        else:
            self.variables.owned.discard(name)

    def move(self, names: tuple[str, ...], parts: tuple[str, ...]) -> None:
        """Set places, all at once."""
        pairs = [(a, b) for a, b in zip(names, parts, strict=True) if a != b]
        if pairs:
            left, right = (", ".join(side) for side in zip(*pairs, strict=True))
            self.emit(f"{left} = {right}")

    def convert(self, before: Variables, after: Variables, lines: Lines) -> None:
        """Write the lines that hold variables as they are wanted where ways meet."""
        with self.into(lines):
            names: list[str] = []
            parts: list[str] = []
            for name, kind in before.kinds.items():
                wanted = after.kinds[name]
                if alike(kind, wanted):
                    continue
                made = converted(Code(kind, places_of(name, kind)), wanted)
                names.extend(places_of(name, wanted))
                parts.extend(made.parts)
            self.move(tuple(names), tuple(parts))

    def whole(self, code: Code) -> str:
        """Write a value in one place."""
        return one_piece(code)


def checked(t: Translation, piece: str, kind: Numbers) -> Code:
    """Take a value that should be of a kind; if it is not, the call departs."""
    name = "bool" if kind.kind == "bool" else "float"
    if kind.shape is None:
        return Code(kind, (t.temporary(called("real", piece)),), fresh=True)
    if is_scalar(kind):
        check = "logical" if kind.kind == "bool" else "number"
        return Code(kind, (t.temporary(called(check, piece)),))
    t.module.arrays = True
    if is_small(kind):
        return t.unpacked(called("spread", piece, name, repr(kind.shape)), kind)
    return Code(kind, (t.temporary(called("array", piece, name, repr(kind.shape))),), fresh=True)
