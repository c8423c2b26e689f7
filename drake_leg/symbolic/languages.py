"""Programs as text, as LaTeX, and as code in languages that SymPy prints."""

from __future__ import annotations

import keyword
import re
import textwrap
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace

import sympy as sp
from sympy.printing.c import C99CodePrinter
from sympy.printing.numpy import NumPyPrinter

from drake_leg.errors import InvalidValueError, did_you_mean
from drake_leg.symbolic.decimals import latex_text, plain_text
from drake_leg.symbolic.programs import Output, Program

WIDTH = 96  # of a line of code
LETTERS = "letters"  # the argument that has the values of letters
RESERVED = """
auto break case char const continue default do double else enum extern float for goto if inline int
long register restrict return short signed sizeof static struct switch typedef union unsigned void
volatile while y0 y1 yn j0 j1 jn gamma signgam
where end function begin local module using otherwise persistent np numpy zero each pi im E I
"""  # in C, MATLAB, Julia and what the functions use themselves


def code(program: Program, language: str) -> str:
    """Write a program as a function in one of ``LANGUAGES``.

    Raises
    ------
    InvalidValueError
        If there is no such language.
    """
    require_language(language)
    return LANGUAGES[language](_with_plain_names(program))


def require_language(language: str) -> None:
    """Refuse what is not one of ``LANGUAGES``."""
    if language not in LANGUAGES:
        raise InvalidValueError(
            f"there is no language {language!r}",
            advice=did_you_mean(language, LANGUAGES, f"there are {', '.join(LANGUAGES)}"),
        )


def _with_plain_names(program: Program) -> Program:
    """Rename what a language reserves, or what is no identifier."""
    reserved = {*keyword.kwlist, *RESERVED.split(), LETTERS, program.name}
    reserved |= {one.name for one in program.inputs} | {one.name for one in program.outputs}
    symbols = [*(s for one in program.inputs for s in one.symbols), *program.letters]
    symbols += [name for name, _ in program.assignments]
    taken = {symbol.name for symbol in symbols}
    new: dict[sp.Basic, sp.Basic] = {}
    for symbol in symbols:
        name = re.sub(r"[^A-Za-z0-9_]", "_", symbol.name)
        name = name if re.match(r"[A-Za-z]", name) else f"x{name}"
        while name in reserved or (name != symbol.name and name in taken):
            name += "_"
        taken.add(name)
        new[symbol] = sp.Symbol(name, real=True)
    return replace(
        program,
        inputs=tuple(
            replace(one, symbols=tuple(new[symbol] for symbol in one.symbols))
            for one in program.inputs
        ),
        assignments=tuple(
            (new[n], expression.xreplace(new)) for n, expression in program.assignments
        ),
        outputs=tuple(replace(one, value=one.value.xreplace(new)) for one in program.outputs),
        values={new.get(symbol, symbol): value for symbol, value in program.values.items()},
    )


# --- for people ------------------------------------------------------------------------------


def text(program: Program) -> str:
    """Write a program for a terminal: its counts, its assignments, its outputs."""
    lines = [*_heading(program), ""]
    lines += [f"{name} = {plain_text(value)}" for name, value in program.assignments]
    lines += [""]
    for output in program.outputs:
        lines += _shown(output)
    return "\n".join(lines)


def latex(program: Program) -> str:
    """Write a program as lines of LaTeX's mathematics, under a comment."""
    lines = [f"% {line}" for line in _heading(program)]
    lines += [f"{sp.latex(name)} = {latex_text(value)}" for name, value in program.assignments]
    for output in program.outputs:
        lines += [f"% {line}" for line in _meaning(output)]
        lines += [f"{sp.latex(sp.Symbol(output.name))} = {latex_text(output.value)}"]
    return "\n".join(lines)


def counts(program: Program) -> str:
    """Say how many operations a program has, and how many without names for what is used again."""
    functions = program.operations.functions
    own = f"{program.operations}" + f", {functions} sines, cosines and signs" * bool(functions)
    return f"{own}; with every name written out: {program.naive_operations}"


def _heading(program: Program) -> list[str]:
    outputs = ", ".join(output.name for output in program.outputs)
    given = ", ".join(one.name for one in program.inputs)
    lines = [f"{program.title}: {outputs} of {given}"]
    lines += [
        f"{one.name} = ({', '.join(symbol.name for symbol in one.symbols)}): {one.meaning}"
        for one in program.inputs
    ]
    lines += [*program.notes, *_known(program), counts(program)]
    return lines


def _known(program: Program) -> list[str]:
    return _lines(f"{s} = {program.values[s]:.9g}" for s in program.letters if s in program.values)


def _lines(parts: Iterable[str], indent: str = "") -> list[str]:
    """Fill lines with parts, each whole, with commas between them."""
    lines, line = [], ""
    for part in parts:
        if line and len(f"{indent}{line}, {part},") > WIDTH:
            lines.append(f"{indent}{line},")
            line = ""
        line = f"{line}, {part}" if line else part
    return [*lines, f"{indent}{line}"] if line else lines


def _meaning(output: Output) -> list[str]:
    lines = [f"{output.name}: {output.meaning}"]
    if output.columns:
        lines += ["its columns:", *_lines(output.columns)]
    return lines


def _shown(output: Output) -> list[str]:
    """Write an output as a vector, or as a matrix row by row."""
    lines = _meaning(output)
    if output.is_vector:
        return [
            *lines,
            *textwrap.wrap(f"{output.name} = ({', '.join(map(plain_text, output.value))})", WIDTH),
        ]
    rows = [f"({', '.join(map(plain_text, output.value[i, :]))})" for i in range(output.value.rows)]
    return [*lines, f"{output.name} =", *(f"  {row}" for row in rows)]


# --- code ------------------------------------------------------------------------------------


def _comment(program: Program) -> list[str]:
    """Say what a function computes of what."""
    lines = [f"{program.title[0].upper()}{program.title[1:]}."]
    lines += [f"{one.name}: {one.meaning}, {len(one.symbols)}" for one in program.inputs]
    for output in program.outputs:
        lines += [f"returns {line}" if i == 0 else line for i, line in enumerate(_meaning(output))]
    return [*lines, *program.notes, *textwrap.wrap(counts(program), WIDTH - 8)]


def _numpy(program: Program) -> str:
    printer = NumPyPrinter({"allow_unknown_functions": True})

    def printed(expression: sp.Expr) -> str:
        return str(printer.doprint(expression)).replace("numpy.", "np.")

    letters = [symbol.name for symbol in program.letters]
    known = [
        f"    {symbol.name!r}: {program.values[symbol]!r},"
        for symbol in program.letters
        if symbol in program.values
    ]
    comment = _comment(program)
    arguments = [one.name for one in program.inputs]
    lines = [f'"""{comment[0]}"""', "", "import numpy as np", ""]
    lines += [f"{LETTERS.upper()} = {{", *known, "}", ""] if known else []
    lines += [
        "",
        f"def {program.name}({', '.join([*arguments, *_letters_argument(letters, known)])}):",
    ]
    lines += [f'    """{comment[0]}', "", *(f"    {line}" for line in comment[1:]), '    """']
    for one in program.inputs:
        names = ", ".join(symbol.name for symbol in one.symbols)
        lines += [f"    {names}, = np.moveaxis(np.asarray({one.name}, dtype=float), -1, 0)"]
    lines += [f'    {name} = {LETTERS}["{name}"]' for name in letters]
    lines += [f"    {name.name} = {printed(value)}" for name, value in program.assignments]
    shape = " + ".join(f"0.0 * {one.symbols[0]}" for one in program.inputs if one.symbols)
    lines += [f"    zero = {shape or '0.0'}"]
    for output in program.outputs:
        size = (len(output.value),) if output.is_vector else output.value.shape
        lines += [f"    {output.name} = np.stack([zero + each for each in ("]
        *above, last = _lines((printed(entry) for entry in output.value), " " * 8)
        lines += [*above, f"{last},"]
        lines += [f"    )], axis=-1).reshape((*zero.shape, *{tuple(map(int, size))}))"]
    lines += [f"    return {', '.join(output.name for output in program.outputs)}"]
    return "\n".join(lines) + "\n"


def _letters_argument(letters: Sequence[str], known: Sequence[str]) -> list[str]:
    if not letters:
        return []
    return [f"{LETTERS}={LETTERS.upper()}"] if len(known) == len(letters) else [LETTERS]


def _c(program: Program) -> str:
    printer = _CPrinter()
    letters = program.letters
    arguments = [f"const double {one.name}[{len(one.symbols)}]" for one in program.inputs]
    arguments += [f"const double {LETTERS}[{len(letters)}]"] if letters else []
    for output in program.outputs:
        size = [len(output.value)] if output.is_vector else list(output.value.shape)
        arguments.append(f"double {output.name}{''.join(f'[{n}]' for n in size)}")
    used = _used(program)
    lines = ["/*", *(f" * {line}" for line in _comment(program))]
    if letters:
        names = _lines((symbol.name for symbol in letters), " * ")
        lines += [f" * {LETTERS}:", *names]
    lines += [" */", "#include <math.h>", ""]
    if letters and all(symbol in program.values for symbol in letters):
        values = _lines((repr(float(program.values[symbol])) for symbol in letters), "    ")
        name = f"{program.name}_{LETTERS}"
        lines += [f"const double {name}[{len(letters)}] = {{", *values, "};", ""]
    lines += [f"void {program.name}(", *_lines(arguments, "    "), ")", "{"]
    for one in (*((i.name, i.symbols) for i in program.inputs), (LETTERS, letters)):
        name, symbols = one
        read = [(k, symbol) for k, symbol in enumerate(symbols) if symbol in used]
        lines += [f"    const double {symbol.name} = {name}[{k}];" for k, symbol in read]
        lines += [f"    (void){name};"] if symbols and not read else []
    lines += [
        f"    const double {name.name} = {printer.doprint(value)};"
        for name, value in program.assignments
    ]
    for output in program.outputs:
        for i in range(output.value.rows):
            for j in range(output.value.cols):
                place = f"[{i}]" if output.is_vector else f"[{i}][{j}]"
                lines.append(f"    {output.name}{place} = {printer.doprint(output.value[i, j])};")
    return "\n".join([*lines, "}"]) + "\n"


def _used(program: Program) -> set[sp.Symbol]:
    """The symbols that something is computed from."""
    found: set[sp.Symbol] = set()
    for _, expression in program.assignments:
        found |= expression.free_symbols
    for output in program.outputs:
        found |= output.value.free_symbols
    return found


class _CPrinter(C99CodePrinter):  # type: ignore[misc] # SymPy has no types
    """Squares as products."""

    def _print_Pow(self, power: sp.Pow) -> str:
        if power.exp == 2 and power.base.is_Symbol:
            name = self._print(power.base)
            return f"({name}*{name})"
        return str(super()._print_Pow(power))


def _matlab(program: Program) -> str:
    arguments = [one.name for one in program.inputs] + [LETTERS] * bool(program.letters)
    returned = ", ".join(output.name for output in program.outputs)
    lines = [f"function [{returned}] = {program.name}({', '.join(arguments)})"]
    lines += [f"  % {line}" for line in _comment(program)]
    lines += [
        f"  % {LETTERS}.{s.name} = {program.values[s]!r};"
        for s in program.letters
        if s in program.values
    ]
    used = _used(program)
    for one in program.inputs:
        lines += [
            f"  {symbol.name} = {one.name}({k});"
            for k, symbol in enumerate(one.symbols, start=1)
            if symbol in used
        ]
    lines += [f"  {symbol.name} = {LETTERS}.{symbol.name};" for symbol in program.letters]
    lines += [f"  {name.name} = {sp.octave_code(value)};" for name, value in program.assignments]
    for output in program.outputs:
        rows = [
            ", ".join(sp.octave_code(e) for e in output.value[i, :])
            for i in range(output.value.rows)
        ]
        lines += [f"  {output.name} = [{'; '.join(rows)}];"]
    return "\n".join([*lines, "end"]) + "\n"


def _julia(program: Program) -> str:
    arguments = [one.name for one in program.inputs] + [LETTERS] * bool(program.letters)
    lines = [f"# {line}" for line in _comment(program)]
    lines += [
        f"# {LETTERS}.{s.name} = {program.values[s]!r}"
        for s in program.letters
        if s in program.values
    ]
    lines += [f"function {program.name}({', '.join(arguments)})"]
    for one in program.inputs:
        lines += [f"    {s.name} = {one.name}[{k}]" for k, s in enumerate(one.symbols, start=1)]
    lines += [f"    {symbol.name} = {LETTERS}.{symbol.name}" for symbol in program.letters]
    lines += [f"    {name.name} = {sp.julia_code(value)}" for name, value in program.assignments]
    for output in program.outputs:
        if output.is_vector:
            entries = ", ".join(sp.julia_code(entry) for entry in output.value)
        else:
            entries = "; ".join(
                " ".join(f"({sp.julia_code(e)})" for e in output.value[i, :])
                for i in range(output.value.rows)
            )
        lines += [f"    {output.name} = [{entries}]"]
    lines += [f"    return {', '.join(output.name for output in program.outputs)}", "end"]
    return "\n".join(lines) + "\n"


LANGUAGES: dict[str, Callable[[Program], str]] = {
    "numpy": _numpy,
    "c": _c,
    "matlab": _matlab,  # and Octave
    "julia": _julia,
}
