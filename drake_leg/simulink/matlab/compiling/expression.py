"""Expressions of blocks such as Fcn and Interpreted MATLAB Function."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.matlab import syntax
from drake_leg.simulink.matlab.compiling.function import CompiledFunction, made
from drake_leg.simulink.matlab.folders import Folders
from drake_leg.simulink.matlab.frames import Memory
from drake_leg.simulink.matlab.names import names_in
from drake_leg.simulink.matlab.numeric import MatlabError
from drake_leg.simulink.matlab.program import parsed_expression

# ruff: noqa: ANN401 - any value of a signal
_OF_C = {"pow": "power", "sgn": "sign", "ln": "log", "fabs": "abs"}
_INDEX = re.compile(r"(?<=\w)\[([^\[\]]*)\]")  # u[1]; a matrix never touches a name
_CALLED = re.compile(rf"\b({'|'.join(_OF_C)})(?=\s*\()")


class CompiledExpression:
    """An expression of a block; make it by `compiled_expression`.

    Attributes
    ----------
    names : tuple of str
        The names of its arguments.
    """

    def __init__(self, function: CompiledFunction) -> None:
        self._function = function
        self.names = function.inputs

    @property
    def source(self) -> str:
        """Python source for the kinds of arguments of the calls so far; "" before the first."""
        return self._function.source

    @property
    def keeps(self) -> bool:
        """Whether a function that it calls leaves something for the next call."""
        return self._function.keeps

    def start(self, shared: Mapping[str, Any] | None = None) -> Memory:
        """Return what is kept before the first call, as `CompiledFunction.start` does."""
        return self._function.start(shared)

    def __call__(self, *arguments: Any, kept: Memory | None = None) -> Any:
        """Evaluate the expression; what is true is 1.

        Parameters
        ----------
        *arguments
            Of its names.
        kept : dict, optional
            What functions keep, from `start`; the call changes it.

        Raises
        ------
        InvalidValueError
            If it cannot be evaluated.
        """
        (found,) = self._function.call({} if kept is None else kept, *arguments)
        return float(found) if isinstance(found, bool) else found


def compiled_expression(
    text: str,
    names: tuple[str, ...] = ("u",),
    *,
    variables: Mapping[str, Any] | None = None,
    functions: Folders | None = None,
) -> CompiledExpression:
    """Make an expression callable.

    Parameters
    ----------
    text : str
        The expression; in C's way, too: ``u[1]``, ``!``, ``!=``, ``pow``, ``sgn``, ``ln``. The
        name of a function alone is that function of the arguments.
    names : tuple of str, optional
        The names of its arguments.
    variables : mapping, optional
        Values of other names.
    functions : Folders, optional
        Where functions in files are looked for.

    Raises
    ------
    InvalidValueError
        If it is not well formed, or uses names that mean nothing.
    """
    if "'" not in text and '"' not in text:
        text = text.replace("!", "~")
    while (plain := _INDEX.sub(r"(\1)", text)) != text:
        text = plain
    try:
        node = parsed_expression(_CALLED.sub(lambda found: _OF_C[found[1]], text))
    except MatlabError as fault:
        raise InvalidValueError(
            f"the expression {text!r:.60} is not well formed: {fault}"
        ) from None
    used = names_in(node)
    given = {name: one for name, one in (variables or {}).items() if name in used}
    if isinstance(node, syntax.Name) and node.name not in (*names, *given):
        arguments = tuple(syntax.Name(name=name) for name in names)
        node = syntax.Apply(name=node.name, arguments=arguments)
    function = syntax.Function(
        line=1,
        name="expression",
        inputs=(*names, *(name for name in given if name not in names)),
        outputs=("y",),
        body=(syntax.Assign(line=1, targets=(syntax.Target(name="y"),), value=node),),
        nesting=3,
    )
    parameters = {name: one for name, one in given.items() if name not in names}
    return CompiledExpression(made((function,), parameters, functions))
