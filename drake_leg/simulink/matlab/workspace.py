"""The variables that scripts, .mat files and options give, each with its source.

A value is a float, bool or complex where it is one number, a NumPy array of two or more dimensions
where it is more or none, a str, a `Struct` (or `Structs`), a `Cell` or a `Function`.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from drake_leg.errors import InvalidValueError, UnknownValueError
from drake_leg.simulink.matlab import syntax
from drake_leg.simulink.matlab.data import (
    Allowance,
    LackError,
    SpentError,
    StopError,
    Struct,
)
from drake_leg.simulink.matlab.folders import SCRIPTS, Folders, parsed, text_of
from drake_leg.simulink.matlab.frames import Drawing, File, Frame, MaskedBlock, Values
from drake_leg.simulink.matlab.handles import METHODS, OfBlocks
from drake_leg.simulink.matlab.interpreter import Interpreter
from drake_leg.simulink.matlab.library import CONSTANTS, KNOWN, NOT_RUN
from drake_leg.simulink.matlab.matfiles import read_mat
from drake_leg.simulink.matlab.names import names_in
from drake_leg.simulink.matlab.numeric import MatlabError, quiet
from drake_leg.simulink.matlab.parser import Parser
from drake_leg.simulink.matlab.program import parsed_expression
from drake_leg.simulink.matlab.specials import SPECIAL
from drake_leg.simulink.matlab.tokens import tokenize

MOST_KEPT = 1_000  # lines of output, and things that are skipped
SHARE = 0.4  # of all steps, that one script may take


@dataclass(frozen=True, kw_only=True)
class Skipped:
    """Something that a script does and that is not done here."""

    what: str  # a function, or the variables that have no value because of it
    file: str
    line: int
    reason: str

    def __str__(self) -> str:
        if not self.file:
            return self.reason
        return f"{self.what} ({self.reason}), line {self.line} of {self.file}"


class Workspace:
    """Variables, and what runs scripts on them.

    Parameters
    ----------
    near : iterable of Path, optional
        Folders in which functions, scripts and .mat files are looked for first.
    paths : iterable of Path, optional
        Folders that are searched with all folders inside them; nothing outside of all these is
        read.
    model : Path, optional
        The model that the scripts belong to.
    budget : Allowance, optional
        Steps and elements that all scripts together may take.
    """

    def __init__(
        self,
        near: Iterable[Path] = (),
        paths: Iterable[Path] = (),
        *,
        model: Path | None = None,
        budget: Allowance | None = None,
    ) -> None:
        self.variables: dict[str, Any] = {}
        self.source: dict[str, str] = {}
        self.fixed: set[str] = set()  # variables that scripts do not change
        self.skipped: list[Skipped] = []
        self.lacking: dict[str, str] = {}  # variables that a script would have set: why not
        self.output: list[str] = []  # what scripts print
        self.model = model.stem if model else ""  # name of that which the scripts belong to
        self.blocks: Drawing | None = None  # of that model
        self.budget = budget or Allowance()
        self.folders = Folders(model)
        self._interpreter = Interpreter(self, self.budget)
        self._running: list[str] = []
        self._lost_here: dict[str, str] = {}
        self._at_run: tuple[dict[str, Any], dict[str, str]] | None = None  # as a script runs it
        self._masked: MaskedBlock | None = None
        self._changing: dict[str, bool] = {}  # texts of scripts: whether they set parameters
        for path in near:
            self.folders.add(path)
        for path in paths:
            self.folders.add(path, inside=True)

    @property
    def globals(self) -> Mapping[str, Any]:
        """The global variables of scripts."""
        return self._interpreter.globals

    def set(self, name: str, value: Any, source: str, *, fixed: bool = False) -> None:  # noqa: ANN401
        """Set a variable and say where it comes from; scripts do not change a `fixed` one."""
        self.variables[name] = value
        self.source[name] = source
        self.lacking.pop(name, None)
        if fixed:
            self.fixed.add(name)

    def run(
        self,
        text: str,
        *,
        name: str,
        folder: Path | None = None,
        local: dict[str, Any] | None = None,
        masked: MaskedBlock | None = None,
    ) -> dict[str, str]:
        """Run a script; what is not done is listed in `skipped`, and the rest goes on.

        Parameters
        ----------
        text : str
            The script.
        name : str
            Its name in messages.
        folder : Path, optional
            Where it looks for files first.
        local : dict, optional
            The variables that it works on, instead of those of the workspace.
        masked : MaskedBlock, optional
            The block whose mask the script initializes.

        Returns
        -------
        dict
            Variables that have no value because of what is not done: why not.

        Raises
        ------
        InvalidValueError
            If the text is not well formed, or takes more than the budget.
        """
        self._masked = masked
        try:
            return self._run(parsed(text, name), name, folder, local)
        finally:
            self._masked = None

    def run_file(self, path: Path, *, local: dict[str, Any] | None = None) -> dict[str, str]:
        """Run a script of a file, as `run` does.

        Raises
        ------
        InvalidValueError
            If it cannot be read, is not well formed, or takes more than the budget.
        """
        return self._run(parsed(text_of(path), path.name), path.name, path.parent, local)

    def _run(
        self,
        tree: syntax.Script,
        name: str,
        folder: Path | None,
        local: dict[str, Any] | None = None,
    ) -> dict[str, str]:
        statements = tree.statements
        if not statements and tree.functions and not tree.functions[0].inputs:
            first = tree.functions[0]
            call = syntax.Evaluate(line=first.line, value=syntax.Name(name=first.name))
            statements = (call,)
        file = File(
            name=name,
            functions={one.name: one for one in tree.functions},
            folder=folder.resolve() if folder else None,
        )
        held = {name: self.variables[name] for name in self.fixed if name in self.variables}
        sources = {name: self.source[name] for name in held}
        values = self.variables if local is None else local
        self._lost_here = {}
        self._at_run = None
        frame = Frame(values=values, file=file, lenient=True)
        self.budget.share(SHARE)
        self._running.append(name)
        try:
            with quiet():
                self._interpreter.block(statements, frame)
        except SpentError as spent:
            where = f"line {spent.line or frame.line} of {name}"
            raise InvalidValueError(f"{where}: {spent}") from None
        except MatlabError as fault:
            frame.line = fault.line or frame.line
            self.skip("the rest of the script", frame, str(fault))
        except RecursionError:
            where = f"line {frame.line} of {name}"
            raise InvalidValueError(f"{where}: it is nested too deeply") from None
        finally:
            self._running.pop()
            self.budget.until = 0
            self._restore()
            self.variables.update(held)
        self.source.update(sources)
        return self._lost_here

    def _restore(self) -> None:
        """Give variables the values that they had where a script would run the model."""
        if self._at_run is None:
            return
        variables, source = self._at_run
        self.variables.update(variables)
        self.source.update(source)
        for name in variables:
            self.lacking.pop(name, None)
            self._lost_here.pop(name, None)

    def changes(self, code: str) -> bool:
        """Whether the text of a script, or of files that it names, sets parameters of blocks."""
        if code not in self._changing:
            self._changing[code] = False  # while it is looked at
            self._changing[code] = "set_param" in code or any(
                self.changes(text) for text in self.folders.texts_named_in(code)
            )
        return self._changing[code]

    def evaluate(self, expression: str, *, local: Mapping[str, Any] | None = None) -> Any:  # noqa: ANN401
        """Evaluate an expression with the variables, and with others before them.

        Raises
        ------
        UnknownValueError
            If it uses names that nothing gives; `names` are all of them.
        InvalidValueError
            If it is not well formed, or cannot be evaluated.
        """
        values = OfBlocks(dict(local or {}), self.variables)
        try:
            node = parsed_expression(expression)
            unknown = self.missing(names_in(node), values)
            if unknown:
                raise UnknownValueError(self._why(unknown), names=unknown)
            frame = Frame(values=values, file=File(name="the expression"))
            with quiet():
                return self._interpreter.value(node, frame)
        except LackError as lack:
            if lack.names:
                why = self.lacking.get(lack.names[0])
                said = f"{lack} ({why})" if why else str(lack)
                raise UnknownValueError(said, names=lack.names) from None
            raise InvalidValueError(str(lack)) from None
        except MatlabError as fault:
            raise InvalidValueError(str(fault)) from None
        except RecursionError:
            raise InvalidValueError("it is nested too deeply") from None

    def missing(self, names: Iterable[str], local: Mapping[str, Any]) -> list[str]:
        """Tell which of some names mean nothing, beside those of the workspace and others."""
        return [name for name in names if not (name in self.variables or self._has(name, local))]

    def _why(self, names: list[str]) -> str:
        if len(names) > 1:
            listed = ", ".join(f"'{name}'" for name in names)
            return f"{listed} are not known functions or constants"
        why = self.lacking.get(names[0])
        because = f" ({why})" if why else ""
        return f"'{names[0]}' is not a known function or constant{because}"

    def _has(self, name: str, values: Mapping[str, Any]) -> bool:
        tables = (values, KNOWN, CONSTANTS, SPECIAL, METHODS, NOT_RUN)
        if any(name in table for table in tables):
            return True
        try:
            return self._function(name, None) is not None
        except LackError:  # a file that is not well formed, which is said where it is called
            return True

    def load(self, path: Path) -> None:
        """Read the variables of a .mat file.

        Raises
        ------
        InvalidValueError
            If it cannot be read.
        """
        try:
            found = read_mat(path)
        except MatlabError as fault:
            raise InvalidValueError(f"{path.name}: {fault}") from None
        for name, value in found.items():
            if name not in self.fixed:
                self.set(name, value, path.name)

    # --- what the interpreter asks for ------------------------------------------------------

    def _function(self, name: str, beside: Path | None) -> File | None:
        known = name in KNOWN or name in CONSTANTS or name in SPECIAL
        return self.folders.function(name, beside, known=known)

    def function_file(self, name: str, file: File) -> File | None:
        """Find the file of a function, seen from another one."""
        return self._function(name, file.folder)

    def run_beside(self, name: str, frame: Frame) -> bool:
        """Run the script of that name in a frame, if there is one; a model of it is not opened.

        A name with the ending of a script is not that of a model.
        """
        if name == self.model or self.folders.has_model(name):
            self.skip(name, frame, NOT_RUN["open_system"])
            return True
        path = self.folders.code(name, frame.file.folder)
        if path is None:
            return False
        try:
            tree = self.folders.script(path)
        except InvalidValueError as error:
            raise LackError(str(error)) from None
        if not tree.statements:
            return False
        if path.name in self._running:
            raise SpentError(f"it runs {path.name}, which runs itself")
        functions = {one.name: one for one in tree.functions}
        file = File(name=path.name, functions=functions, folder=path.parent)
        inner = Frame(values=frame.values, file=file, lenient=True, nesting=frame.nesting + 3)
        inner.shared = frame.shared
        self._running.append(path.name)
        try:
            self._interpreter.block(tree.statements, inner)
        except StopError as fault:
            self.skip("the rest of the script", inner, str(fault))
        finally:
            self._running.pop()
        return True

    def run_text(self, text: str, wanted: int, frame: Frame) -> Values:
        """Run a text as code in a frame; its lines count from the one that runs it."""
        self.budget.step(len(text))
        if wanted:
            return self._interpreter.several(parsed_expression(text), wanted, frame)
        parser = Parser(tokenize("\n" * (frame.line - 1) + text))
        statements = parser.script().statements
        inner = replace(frame, nesting=frame.nesting + max(parser.deepest, 3))
        self._interpreter.descend(inner, "eval")
        self._interpreter.block(statements, inner)
        return []

    def mat_file(self, frame: Frame, words: Values) -> Struct:
        """Variables of a .mat file in the folders."""
        names = [str(word) for word in words if isinstance(word, str)]
        if not names:
            raise LackError("'load' names no file")
        path = self.folders.within(names[0]) or self.folders.within(f"{names[0]}.mat")
        if path is None or not path.is_file():
            raise LackError(f"the file {names[0]!r} is not in the given folders")
        if path.suffix.lower() != ".mat":
            raise LackError(f"'load' reads only .mat files, not {path.name!r}")
        found = read_mat(path)
        wanted = [name for name in names[1:] if not name.startswith("-")]
        return Struct({key: found[key] for key in found if not wanted or key in wanted})

    def simulates(self, model: Any) -> None:  # noqa: ANN401
        """Note the variables that the model has where a script runs it for the first time."""
        stem = Path(model).stem if isinstance(model, str) else ""
        if self._at_run is None and self._is_own(stem):
            self._at_run = dict(self.variables), dict(self.source)

    def _is_own(self, stem: str) -> bool:
        """Whether a name is that of the model, or what a renamed copy has behind a prefix."""
        if not stem or not self.model.endswith(stem):
            return False
        before = self.model.removesuffix(stem)
        return not before or (not before[-1].isalnum() and not self.folders.has_model(stem))

    def add_paths(self, words: Values) -> None:
        """Look for files in more folders, if they are inside the given ones."""
        for word in words:
            path = self.folders.within(str(word)) if isinstance(word, str) else None
            if path is not None and path.is_dir():
                self.folders.add(path, inside=True)

    def has_file(self, name: str) -> bool:
        """Whether there is such a file or folder in the given ones."""
        return any(self.folders.within(f"{name}{ending}") for ending in ("", *SCRIPTS, ".mat"))

    def path_of(self, name: str) -> Path | None:
        """Find a file of data in the given folders."""
        path = self.folders.within(name)
        return path if path is not None and path.is_file() else None

    def base(self) -> dict[str, Any]:
        """Return the variables that all scripts share."""
        return self.variables

    def masked(self) -> MaskedBlock | None:
        """Return the block whose mask is being initialized."""
        return self._masked

    def drawing(self) -> Drawing | None:
        """Return the blocks of the model that the scripts belong to."""
        return self.blocks

    def model_name(self) -> str:
        """Return the name of the model that the scripts belong to."""
        return self.model

    def printed(self, text: str) -> None:
        """Keep what a script prints."""
        if len(self.output) < MOST_KEPT:
            self.output.append(text[:MOST_KEPT])

    def skip(self, what: str, frame: Frame, reason: str) -> None:
        """Note what is not run."""
        if frame.values is not self.variables and frame.function is None:
            return  # of a mask: its variables tell
        one = Skipped(what=what, file=frame.file.name, line=frame.line, reason=reason)
        if one not in self.skipped[-50:] and len(self.skipped) < MOST_KEPT:
            self.skipped.append(one)

    def note(self, reason: str) -> None:
        """Note that a whole script is not run."""
        one = Skipped(what="a script", file="", line=0, reason=reason)
        if one not in self.skipped:
            self.skipped.append(one)

    def stored(self, name: str, frame: Frame) -> None:
        """Note which line gave a variable its value."""
        if frame.function is None:
            self._lost_here.pop(name, None)
        if frame.values is self.variables:
            self.source[name] = f"{frame.file.name}, line {frame.line}"
            self.lacking.pop(name, None)

    def lost(self, names: Iterable[str], frame: Frame, reason: str) -> None:
        """Note variables that have no value because of what is lacking."""
        why = f"line {frame.line} of {frame.file.name}: {reason}"
        if frame.function is None:
            self._lost_here.update(dict.fromkeys(names, why))
        if frame.values is self.variables:
            for name in names:
                self.source.pop(name, None)
                self.lacking[name] = why
