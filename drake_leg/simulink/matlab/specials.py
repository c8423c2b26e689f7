"""Functions and commands that see the variables of the frame, other files, or other functions."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from drake_leg.simulink.matlab import operators, random
from drake_leg.simulink.matlab.data import (
    Cell,
    Function,
    LackError,
    SpentError,
    Struct,
    extent,
    items_of,
    settled,
)
from drake_leg.simulink.matlab.differential import DIFFERENTIAL
from drake_leg.simulink.matlab.faults import FAULTS
from drake_leg.simulink.matlab.gathering import GATHERING_BY_FUNCTIONS
from drake_leg.simulink.matlab.handles import HANDLES
from drake_leg.simulink.matlab.library import KNOWN, NOT_RUN
from drake_leg.simulink.matlab.numeric import MatlabError
from drake_leg.simulink.matlab.reading import READERS
from drake_leg.simulink.matlab.searching import SEARCHING
from drake_leg.simulink.matlab.validators import VALIDATORS_OF_CALLS

if TYPE_CHECKING:
    from drake_leg.simulink.matlab.frames import Frame, MaskedBlock, Values
    from drake_leg.simulink.matlab.interpreter import Interpreter

# ruff: noqa: ANN401 - any value of a script
Special = Callable[["Interpreter", "Values", int, "Frame"], "Values"]
Command = Callable[["Interpreter", "Values", "Frame"], None]


def _exist(self: Interpreter, arguments: Values, wanted: int, frame: Frame) -> Values:
    name = str(arguments[0])
    kind = str(arguments[1]) if len(arguments) > 1 else ""
    if name in frame.values and kind in ("", "var"):
        return [1.0]
    if kind == "var":
        return [0.0]
    if kind in ("file", "dir"):
        return [(7.0 if kind == "dir" else 2.0) if self.host.has_file(name) else 0.0]
    return [2.0 if self.knows(name, frame) or self.host.has_file(name) else 0.0]


def _which(self: Interpreter, arguments: Values, wanted: int, frame: Frame) -> Values:
    """``which``: the name of a file that is there, else an empty text."""
    name = str(arguments[0])
    return [f"./{name}" if self.host.has_file(name) else ""]


def _is_file(self: Interpreter, arguments: Values, wanted: int, frame: Frame) -> Values:
    return [self.host.has_file(str(arguments[0]))]


def _feval(self: Interpreter, arguments: Values, wanted: int, frame: Frame) -> Values:
    return self.apply(arguments[0], arguments[1:], wanted, frame)


def _each(self: Interpreter, arguments: Values, wanted: int, frame: Frame) -> Values:
    """``arrayfun``, ``cellfun`` and ``structfun``."""
    function, *rest = arguments
    texts = [k for k, value in enumerate(rest) if isinstance(value, str) and k]
    options = rest[texts[0] :] if texts else []
    rest = rest[: texts[0]] if texts else rest
    if not rest:
        raise MatlabError("it needs a function and values")
    if any(str(option).lower() == "errorhandler" for option in options[::2]):
        raise LackError("an ErrorHandler is not known here")
    uniform = not (len(options) > 1 and not operators.truth(options[1]))
    shape, flats = extent(rest[0]), [items_of(value).ravel(order="F") for value in rest]
    if len({flat.size for flat in flats}) > 1:
        raise MatlabError("the values differ in size")
    count = max(1, wanted)
    made: list[Values] = [[] for _ in range(count)]
    for inputs in zip(*flats, strict=True):
        self.budget.step()
        plain = [settled(item) if isinstance(item, np.generic) else item for item in inputs]
        found = self.apply(function, plain, wanted, frame)
        for place, value in enumerate(found[:count]):
            made[place].append(value)
    if not wanted and not made[0]:
        return []
    if not uniform:
        return [Cell(_folded(values, shape)) for values in made]
    if any(not isinstance(value, (float, bool, complex)) for values in made for value in values):
        raise MatlabError("a value is no number: ask for cells with 'UniformOutput', false")
    return [settled(np.array(values).reshape(shape, order="F")) for values in made]


def _structfun(self: Interpreter, arguments: Values, wanted: int, frame: Frame) -> Values:
    function, value, *rest = arguments
    if not isinstance(value, Struct):
        raise MatlabError("'structfun' needs a structure")
    items = Cell(_folded(list(value.values()), (len(value), 1)))
    found = _each(self, [function, items, *rest], wanted, frame)
    if found and isinstance(found[0], Cell):
        return [Struct(zip(value, found[0].items.ravel(), strict=True))]
    return found


def _folded(values: Values, shape: tuple[int, ...]) -> Any:
    items = np.empty(len(values), dtype=object)
    for k, value in enumerate(values):
        items[k] = value
    return items.reshape(shape, order="F")


def _load(self: Interpreter, arguments: Values, wanted: int, frame: Frame) -> Values:
    return [self.host.mat_file(frame, arguments)]


def _print(self: Interpreter, arguments: Values, wanted: int, frame: Frame) -> Values:
    if arguments and not isinstance(arguments[0], str):
        arguments = arguments[1:]  # the screen's number
    if arguments:
        self.host.printed(str(KNOWN["sprintf"](self.budget, 1, *arguments)))
    return []


def _file_name(self: Interpreter, arguments: Values, wanted: int, frame: Frame) -> Values:
    """``mfilename``: folders count from those that are searched."""
    return [Path(frame.file.name).stem]


def _here(self: Interpreter, arguments: Values, wanted: int, frame: Frame) -> Values:
    """``pwd``: where files are looked for."""
    return ["."]


def _assign_in(self: Interpreter, arguments: Values, wanted: int, frame: Frame) -> Values:
    where, name, value = arguments
    if where != "base" or not re.fullmatch(r"[A-Za-z]\w{0,62}", str(name)):
        raise LackError("'assignin' sets variables of the base workspace only")
    self.host.base()[str(name)] = value
    return []


def _eval(self: Interpreter, arguments: Values, wanted: int, frame: Frame) -> Values:
    """``eval``: a text runs like the lines around it; a second one if the first fails."""
    texts = [str(text) for text in arguments if isinstance(text, str)]
    if not texts or len(texts) < len(arguments):
        raise MatlabError("'eval' needs a text")
    if len(texts) == 1:
        return self.host.run_text(texts[0], wanted, frame)
    lenient, frame.lenient = frame.lenient, False
    try:
        return self.host.run_text(texts[0], wanted, frame)
    except (LackError, SpentError):
        raise
    except MatlabError:
        return self.host.run_text(texts[1], wanted, frame)
    finally:
        frame.lenient = lenient


def _eval_in(self: Interpreter, arguments: Values, wanted: int, frame: Frame) -> Values:
    """``evalin``: a text runs on the variables that all scripts share."""
    where, *texts = arguments
    if where != "base" or not texts:
        raise LackError("'evalin' runs a text in the base workspace only")
    inner = replace(frame, values=self.host.base(), function=None, kept=None, ends=[], owned=set())
    return _eval(self, texts, wanted, inner)


def _masked(self: Interpreter, name: str) -> MaskedBlock:
    block = self.host.masked()
    if block is None:
        raise LackError(f"'{name}' is not run: {NOT_RUN[name]}", names=(name,))
    return block


def _current_block(self: Interpreter, arguments: Values, wanted: int, frame: Frame) -> Values:
    """``gcb``: the block whose mask is initialized."""
    return [_masked(self, "gcb").path]


def _get_param(self: Interpreter, arguments: Values, wanted: int, frame: Frame) -> Values:
    block = self.host.masked() or self.host.drawing() or _masked(self, "get_param")
    if len(arguments) != 2 or not all(isinstance(word, str) for word in arguments):
        raise LackError("'get_param' reads parameters of blocks by their paths only")
    found = block.get(str(arguments[0]), str(arguments[1]))
    if found is None:
        raise LackError(f"the parameter {str(arguments[1])!r} of the block is not known")
    return [found]


def _set_param(self: Interpreter, arguments: Values, wanted: int, frame: Frame) -> Values:
    block = self.host.masked()
    if block is None:
        self.host.skip("set_param", frame, NOT_RUN["set_param"])
        return []
    path, *pairs = arguments
    for name, value in zip(pairs[::2], pairs[1::2], strict=False):
        if isinstance(path, str) and isinstance(value, str):
            block.set(str(path), str(name), str(value))
    return []


_SEARCHED = frozenset((
    "followlinks", "lookundermasks", "lookinsidesubsystemreference", "matchfilter",
    "includecommented", "casesensitive", "findall", "variants",
))  # fmt: skip


def _find_system(self: Interpreter, arguments: Values, wanted: int, frame: Frame) -> Values:
    """``find_system``: paths of blocks inside a mask, those of all variants."""
    block = _masked(self, "find_system")
    path, *pairs = arguments or [block.path]
    names = [str(name) for name in pairs[::2]]
    if not isinstance(path, str) or len(pairs) % 2 or {"SearchDepth", "RegExp"} & set(names):
        raise LackError("'find_system' finds blocks by pairs of names and texts only")
    texts = dict(zip(names, pairs[1::2], strict=True))
    texts = {name: text for name, text in texts.items() if name.lower() not in _SEARCHED}
    found = block.found(str(path), {name: str(text) for name, text in texts.items()})
    return [Cell(_folded(list(found), (len(found), 1)))]


def _mask_object(self: Interpreter, arguments: Values, wanted: int, frame: Frame) -> Values:
    """``Simulink.Mask.get(gcb)``: an object whose parameters can be read."""
    _masked(self, "gcb")
    return [Struct(getParameter=Function(name=_MASK_PARAMETER))]


def _mask_parameter(self: Interpreter, arguments: Values, wanted: int, frame: Frame) -> Values:
    block, name = _masked(self, "gcb"), str(arguments[0])
    found = block.get(block.path, name)
    if found is None:
        raise LackError(f"the mask has no parameter {name!r}")
    return [Struct(Name=name, Value=found, Visible="on", Enabled="on")]


def _model_name(self: Interpreter, arguments: Values, wanted: int, frame: Frame) -> Values:
    """``bdroot``: the model."""
    return [self.host.model_name()]


def _no_picture(self: Interpreter, arguments: Values, wanted: int, frame: Frame) -> Values:
    return [False]


_MASK_PARAMETER = "Simulink.Mask.getParameter"
SPECIAL: Mapping[str, Special] = {
    "gcb": _current_block,
    "get_param": _get_param,
    "set_param": _set_param,
    "find_system": _find_system,
    "Simulink.Mask.get": _mask_object,
    _MASK_PARAMETER: _mask_parameter,
    "bdroot": _model_name,
    "nargin": lambda self, arguments, wanted, frame: [float(frame.given)],
    "nargout": lambda self, arguments, wanted, frame: [float(frame.wanted)],
    "exist": _exist,
    "which": _which,
    "isfile": _is_file,
    "isfolder": _is_file,
    "isdir": _is_file,
    "isvarname": lambda self, arguments, wanted, frame: [str(arguments[0]).isidentifier()],
    "feval": _feval,
    "rand": random.rand,
    "randi": random.randi,
    "rng": random.rng,
    "arrayfun": _each,
    "cellfun": _each,
    "structfun": _structfun,
    "load": _load,
    "fprintf": _print,
    "mfilename": _file_name,
    "pwd": _here,
    "genpath": lambda self, arguments, wanted, frame: [str(arguments[0])],
    "assignin": _assign_in,
    **READERS,
    **FAULTS,
    **HANDLES,
    **DIFFERENTIAL,
    **GATHERING_BY_FUNCTIONS,
    **SEARCHING,
    **VALIDATORS_OF_CALLS,
    # No time passes while a script runs, and it has no pictures.
    "tic": lambda self, arguments, wanted, frame: [0.0] if wanted else [],
    "toc": lambda self, arguments, wanted, frame: [0.0] if wanted else [],
    "isgraphics": _no_picture,
    "ishandle": _no_picture,
    "ishghandle": _no_picture,
    "eval": _eval,
    "evalin": _eval_in,
}


# --- commands ---------------------------------------------------------------------------------


def _clear(self: Interpreter, words: Values, frame: Frame) -> None:
    words = [str(word) for word in words]
    at = words.index("-except") if "-except" in words else len(words)
    kept, plain = words[at + 1 :], [w for w in words[:at] if w not in ("all", "-all", "variables")]
    patterns = [re.compile(_pattern(word)) for word in plain]
    for known in list(frame.values):
        chosen = any(pattern.fullmatch(known) for pattern in patterns)
        if (not plain and known not in kept) or chosen:
            del frame.values[known]


def _pattern(word: str) -> str:
    return re.escape(word).replace(r"\*", r"\w*")


def _load_into(self: Interpreter, words: Values, frame: Frame) -> None:
    for key, value in self.host.mat_file(frame, words).items():
        self.store(key, value, frame)


def _add_path(self: Interpreter, words: Values, frame: Frame) -> None:
    self.host.add_paths(words)


def _run(self: Interpreter, words: Values, frame: Frame) -> None:
    name = str(words[0]) if words else ""
    file = re.split(r"[\\/]", name)[-1]
    if not self.host.run_beside(file, frame):
        lack = f"the script {name!r} is not in the given folders"
        raise LackError(lack, names=(file.removesuffix(".m"),))


def _symbols(self: Interpreter, words: Values, frame: Frame) -> None:
    for word in words:
        frame.values.pop(str(word), None)
    self.host.lost({str(word) for word in words}, frame, "symbols are not known here")
    self.host.skip("syms", frame, "symbols are not known here")


COMMANDS: Mapping[str, Command] = {
    "clear": _clear,
    "clearvars": _clear,
    "load": _load_into,
    "addpath": _add_path,
    "cd": _add_path,
    "run": _run,
    "syms": _symbols,
}
