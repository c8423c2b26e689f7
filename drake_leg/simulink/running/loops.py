"""Algebraic loops in code: blocks that run again and again until what is unknown fits them."""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from drake_leg.simulink.model import Block, split_port
from drake_leg.simulink.running.code import CONTINUOUS, Operand, Pen, Section
from drake_leg.simulink.running.network import SignalNetwork
from drake_leg.simulink.running.ordering import AlgebraicLoop
from drake_leg.simulink.running.settings import Settings, Signal, flat, shape_of
from drake_leg.simulink.running.solving import UnsolvedLoopError

NAMED = 5  # blocks of a loop in the error of a run
GUESSES = {"AlgebraicConstraint": ("InitialGuess",), "Algebraic Constraint": ("z0",),
           "InitialCondition": ("Value",), "IC": ("Value",)}  # fmt: skip
SAME = 1e-9  # quotient of a difference of guesses that another pass does not care about


@dataclass(kw_only=True)
class Unknown:
    """A signal that is not known before the blocks have run that make it."""

    port: str
    name: str  # variable that has its guess
    guess: Signal


@dataclass(kw_only=True)
class LoopSection(Section):
    """The sections of an algebraic loop, carried out with unknowns that Newton's method finds."""

    inner: list[Section]
    unknowns: list[Unknown]
    residuals: list[str]  # code, one of each unknown
    function: str  # its name
    slot: int  # in the memory, of the last solution
    about: str  # code of the constant that names the loop

    def settle(self) -> None:
        """Find the names that the parts make and read."""
        self.makes = frozenset().union(*(part.makes for part in self.parts))
        reads = frozenset().union(*(part.reads | {*part.gates} for part in self.parts))
        trees = (ast.walk(ast.parse(residual)) for residual in self.residuals)
        reads |= {node.id for tree in trees for node in tree if isinstance(node, ast.Name)}
        own = {unknown.name for unknown in self.unknowns}
        self.reads = (reads - own) | {"m"}

    @property
    def parts(self) -> Sequence[Section]:
        """Return the sections inside."""
        return self.inner

    @property
    def lasts(self) -> bool:
        """Whether it does something at events: it keeps its solution."""
        return True

    @property
    def is_sampled(self) -> bool:
        """Whether nothing of it runs between events."""
        return all(part.rate != CONTINUOUS for part in self.parts)

    def code(
        self,
        trial: Callable[[Section], list[str]],
        final: Callable[[Section], list[str]],
        *,
        is_kept: bool = False,
    ) -> Iterator[str]:
        """Write the loop: a function of the unknowns, its zero, and all blocks once more.

        ``trial`` and ``final`` write a part within the function and behind it; the zero is kept for
        the next time if it ``is_kept``.
        """
        z, root = f"{self.function}_z", f"{self.function}_root"
        unpacked = [*_unpacked(self.unknowns, z)]
        yield f"def {self.function}({z}):"
        for line in (*unpacked, *(line for part in self.parts for line in trial(part))):
            yield f"    {line}"
        single = all(isinstance(unknown.guess, float) for unknown in self.unknowns)
        listed = ", ".join(self.residuals)
        yield f"    return {f'array([{listed}])' if single else f'joined({listed})'}"
        yield f"{root} = solved({self.function}, m[{self.slot}], {self.about})"
        yield f"{z} = {root}[0]"
        if is_kept:
            yield f"m[{self.slot}] = {root}"
        yield from unpacked
        for part in self.parts:
            yield from final(part)


def opened(pen: Pen, loop: AlgebraicLoop) -> list[Unknown]:
    """Give the unknowns of a loop names and guesses, so that its blocks can be written."""
    blocks = {block.sid: block for block in loop.blocks}
    found = []
    for port in loop.torn:
        block = blocks[split_port(port)[0]]
        guess = pen.guesses.get(port)
        if guess is None:
            guess = _first_guess(block)
        unknown = Unknown(port=port, name=pen.name(f"{block.name}_guess"), guess=guess)
        pen.scope[unknown.name] = guess
        pen.values[port] = Operand(code=unknown.name, value=guess)
        found.append(unknown)
    return found


def widened(pen: Pen, network: SignalNetwork, loop: AlgebraicLoop, number: int) -> bool:
    """Guess another shape of the unknowns, that of a signal from outside, in another pass.

    ``number`` counts these attempts from 0; behind the last one, the first guesses come again.
    Returns whether that is another attempt.
    """
    own = {block.sid for block in loop.blocks}
    outside = {port for sid in own for port in network.nodes[sid].inputs if port is not None}
    known = [pen.values[port] for port in sorted(outside) if port in pen.values]
    shapes = [*dict.fromkeys(one.shape for one in known if one.shape), ()]
    if len(shapes) == 1 or number >= len(shapes):
        return False
    blocks = {block.sid: block for block in loop.blocks}
    for port in loop.torn:
        first = flat(_first_guess(blocks[split_port(port)[0]]))
        pen.better[port] = np.resize(first, shapes[number]) if shapes[number] else float(first[0])
    return True


def _first_guess(block: Block) -> Signal:
    """Guess what a block puts out: what it is said to start at, else 0."""
    settings = Settings(block)
    names = [name for name in GUESSES.get(block.kind, ()) if settings.has(name)]
    return settings.array(names[0]) if names else 0.0


def closed(
    pen: Pen, loop: AlgebraicLoop, unknowns: list[Unknown], parts: list[Section]
) -> LoopSection:
    """Make a section of what the blocks of a loop wrote, and improve the guesses."""
    residuals = []
    for unknown in unknowns:
        code, value = _residual(pen, unknown)
        residuals.append(code)
        if value is not None:
            pen.better[unknown.port] = value
    start = np.concatenate([flat(unknown.guess) for unknown in unknowns])
    section = LoopSection(
        title=f"algebraic loop of {', '.join(block.name for block in loop.blocks[:NAMED])}",
        lines=[],
        rate=CONTINUOUS,
        inner=parts,
        unknowns=unknowns,
        residuals=residuals,
        function=pen.name("loop"),
        slot=pen.slot((start, None)),
        about=pen.constant(f"the algebraic loop of {loop.names}", "LOOP"),
    )
    section.settle()
    if not pen.better.keys() & set(loop.torn):
        _improve(pen, section)
    return section


def _residual(pen: Pen, unknown: Unknown) -> tuple[str, Signal]:
    """Write what is 0 where an unknown is right; return a guess of another shape if it needs one.

    A constraint makes its own residual, of as many numbers.
    """
    own = pen.residuals.get(unknown.port)
    made = own or pen.values[unknown.port]
    better = None
    if _unlike(made.value, unknown.guess):
        better = made.value
        if own is not None:
            better = np.broadcast_to(np.asarray(unknown.guess, dtype=float), own.shape).copy()
    if own is not None:
        return own.code, better
    if made.is_scalar and isinstance(unknown.guess, float):
        return f"{made.code} - {unknown.name}", better
    return f"flat({made.code}) - flat({unknown.name})", better


def _unlike(made: Signal, guess: Signal) -> bool:
    """Tell whether a signal has another shape, or is another bus, than was guessed."""
    if isinstance(made, dict):
        same = isinstance(guess, dict) and made.keys() == guess.keys()
        return not same or any(_unlike(made[name], guess[name]) for name in made)
    return isinstance(guess, dict) or shape_of(made) != shape_of(guess)


def _improve(pen: Pen, section: LoopSection) -> None:
    """Solve the loop at the start, and guess what is found there in another pass."""
    lines = [*section.code(lambda part: part.lines, lambda part: part.lines)]
    try:
        exec(compile("\n".join(lines), f"<{section.title}>", "exec"), pen.scope)
    except UnsolvedLoopError:
        return  # there may be no solution where it does not run yet
    start, z = pen.slots[section.slot][0], pen.scope[f"{section.function}_z"]
    if np.abs(z - start).max() > SAME * (1.0 + np.abs(start).max()):
        for unknown in section.unknowns:
            pen.better[unknown.port] = pen.scope[unknown.name]


def _unpacked(unknowns: Sequence[Unknown], vector: str) -> Iterator[str]:
    """Write the unknowns as parts of a vector."""
    first = 0
    for unknown in unknowns:
        code, first = _part(unknown.guess, vector, first)
        yield f"{unknown.name} = {code}"


def _part(like: Signal, vector: str, first: int) -> tuple[str, int]:
    """Write a signal of a shape as a part of a vector, and where the next part begins."""
    if isinstance(like, dict):
        items = []
        for name, each in like.items():
            code, first = _part(each, vector, first)
            items.append(f"{name!r}: {code}")
        return f"{{{', '.join(items)}}}", first
    shape = shape_of(like)
    last = first + int(np.prod(shape))
    if not shape:
        return f"float({vector}[{first}])", last
    order = f".reshape({shape}, order='F')" if len(shape) == 2 else ""
    return f"{vector}[{first}:{last}]{order}", last
