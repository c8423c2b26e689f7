"""Where a model's variables come from: options, scripts, callbacks, its own workspace, CAD data."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.file import SimulinkFile, simulink_file
from drake_leg.simulink.linking import home_of
from drake_leg.simulink.matlab.folders import MODELS
from drake_leg.simulink.matlab.frames import Drawing
from drake_leg.simulink.matlab.matfiles import read_struct
from drake_leg.simulink.matlab.numeric import MatlabError
from drake_leg.simulink.matlab.workspace import Workspace

CAD_DATA = "smiData"  # that an imported CAD model keeps its numbers in
_CAD_FILE = "_DataFile.m"
_BEFORE = ("PreLoadFcn", "PostLoadFcn")  # callbacks that MATLAB runs before a person's scripts
_AFTER = ("InitFcn",)
_NAME = re.compile(r"[A-Za-z]\w{0,62}")
SCRIPTS = (".m", ".mlx", ".mat")


@dataclass(frozen=True, kw_only=True)
class Given:
    """What a person gives beside the model's file."""

    values: Mapping[str, Any] = field(default_factory=dict)  # name to number or MATLAB text
    init: Sequence[Path] = ()  # scripts, .mat files, and models that lend their own workspace
    paths: Sequence[Path] = ()  # folders


class Variables:
    """The variables that a model's parameters may use, each with its source.

    Attributes
    ----------
    workspace : Workspace
        Those that options, scripts and callbacks set.
    own : dict
        Those of the model workspace, which come first.
    own_sources : dict
        Where those come from.
    used : dict
        Names of variables that were used, to their sources.
    init : tuple of Path
        The scripts, .mat files and models that a person gave.
    is_lent : bool
        Whether another model lends the values, as to a library.
    """

    def __init__(self, workspace: Workspace) -> None:
        self.workspace = workspace
        self.own: dict[str, Any] = {}
        self.own_sources: dict[str, str] = {}
        self.used: dict[str, str] = {}
        self.init: tuple[Path, ...] = ()
        self.is_lent = False

    def note(self, name: str) -> None:
        """Note that a variable is used."""
        if name in self.own:
            self.used[name] = self.own_sources[name]
        elif name in self.workspace.variables:
            self.used[name] = self.workspace.source.get(name, "a script")


def no_variables() -> Variables:
    """Make variables of which there are none."""
    return Variables(Workspace())


def variables_inside(file: SimulinkFile, around: Variables) -> Variables:
    """Find the variables of a model to which another one refers: its own, then the other's.

    Those of the other one's model workspace are not seen inside.
    """
    found = Variables(around.workspace)
    found.used, found.init = around.used, around.init
    _read_own(file, found, f"model workspace of {file.path.stem}")
    return found


def variables_of(
    file: SimulinkFile,
    given: Given,
    mentions: Callable[[str], bool] | None = None,
    blocks: Drawing | None = None,
) -> Variables:
    """Find a model's variables.

    What a person sets comes first, then what their scripts set: callbacks change neither. Then
    come the callbacks of the model, and the data of CAD import.

    Parameters
    ----------
    file : SimulinkFile
        The model.
    given : Given
        What a person gives.
    mentions : callable, optional
        Whether the model uses a name.
    blocks : Drawing, optional
        Its blocks, whose parameters callbacks may read.

    Raises
    ------
    InvalidValueError
        If what a person gives is not there or not well formed, or takes too long.
    """
    home = home_of(file.path, given.paths)
    near = [file.path.parent, home.parent, *(path.parent for path in given.init)]
    workspace = Workspace(near, given.paths, model=home)
    workspace.blocks = blocks
    found = Variables(workspace)
    found.init = tuple(path.resolve() for path in given.init)
    found.is_lent = not file.is_model
    for name, value in given.values.items():
        _set(workspace, name, value)
    for callback in _BEFORE:
        _run_callback(file, callback, workspace)
    before = dict(workspace.source)
    for path in given.init:
        _run_given(workspace, path)
    workspace.fixed.update(
        name for name, source in workspace.source.items() if before.get(name) != source
    )
    for callback in _AFTER:
        _run_callback(file, callback, workspace)
    _read_own(file, found)
    known = {**workspace.variables, **found.own}
    if CAD_DATA not in known and mentions is not None and mentions(CAD_DATA):
        _run_cad_data(file, workspace)
    return found


def _set(workspace: Workspace, name: str, value: Any) -> None:  # noqa: ANN401
    if not _NAME.fullmatch(name):
        raise InvalidValueError(f"{name[:60]!r} is no name of a variable: write it as in L1=0.05")
    try:
        number = workspace.evaluate(value) if isinstance(value, str) else _from_python(value)
    except InvalidValueError as error:
        raise InvalidValueError(f"the value of {name} is {value!r:.60}: {error}") from None
    workspace.set(name, number, "set by hand", fixed=True)


def _from_python(value: Any) -> Any:  # noqa: ANN401
    from drake_leg.simulink.matlab.program import variable

    try:
        return variable("it", float(value) if isinstance(value, int) else value)
    except MatlabError as fault:
        raise InvalidValueError(str(fault)) from None


def _run_given(workspace: Workspace, path: Path) -> None:
    """Run a script, or read a .mat file or the workspace of a model, that a person gives."""
    if path.suffix.lower() not in (*SCRIPTS, *MODELS):
        raise InvalidValueError(
            f"{path} is neither a script (.m, .mlx) nor a .mat file, nor a model: give one"
        )
    if not path.is_file():
        raise InvalidValueError(f"there is no file {path}: give one that exists")
    if path.suffix.lower() == ".mat":
        workspace.load(path)
    elif path.suffix.lower() in MODELS:
        lender = Variables(workspace)
        _read_own(simulink_file(path), lender)
        for name in lender.own.keys() - workspace.fixed:
            workspace.set(name, lender.own[name], f"model workspace of {path.name}")
    else:
        workspace.run_file(path)


def _run_callback(file: SimulinkFile, callback: str, workspace: Workspace) -> None:
    text = file.callbacks.get(callback, "")
    if text.strip():
        _try(workspace, lambda: workspace.run(text, name=callback, folder=file.path.parent))


def _try(workspace: Workspace, act: Callable[[], object]) -> None:
    """Do what a person did not ask for; what is wrong with it is noted."""
    try:
        act()
    except (InvalidValueError, MatlabError) as error:
        workspace.note(str(error))


def _read_own(file: SimulinkFile, found: Variables, name: str = "model workspace") -> None:
    """Read the model workspace: kept in the file, or made by code or another file."""
    settings, workspace = file.workspace, found.workspace
    kind = settings.get("WSDataSource", "")
    where = re.split(r"[\\/]", settings.get("WSSourceFileName", ""))[-1]
    path = workspace.folders.file(where) if where else None
    if kind == "MATLAB Code":
        code = settings.get("WSMATLABCode", "")
        _try(workspace, lambda: workspace.run(code, name=f"the {name}", local=found.own))
    elif path is not None and path.suffix.lower() in SCRIPTS:
        _try(workspace, lambda: _read_file(workspace, path, found.own))
    elif file.workspace_content is not None:
        content = file.workspace_content
        _try(workspace, lambda: found.own.update(read_struct(content, f"the {name}")))
    source = f"{name} ({where})" if path is not None else name
    for name in workspace.fixed & set(found.own):
        del found.own[name]
    found.own_sources.update(dict.fromkeys(found.own, source))


def _read_file(workspace: Workspace, path: Path, values: dict[str, Any]) -> None:
    if path.suffix.lower() == ".mat":
        from drake_leg.simulink.matlab.matfiles import read_mat

        values.update(read_mat(path))
    else:
        workspace.run_file(path, local=values)


def _run_cad_data(file: SimulinkFile, workspace: Workspace) -> None:
    """Run the data file that CAD import wrote beside the model."""
    files = workspace.folders.ending(_CAD_FILE)
    stem = file.path.stem
    fitting = [path for path in files if stem.endswith(path.name.removesuffix(_CAD_FILE))]
    chosen = max(fitting, key=lambda path: len(path.name), default=None)
    if chosen is None and len(files) == 1:
        chosen = files[0]
    if chosen is not None:
        path = chosen
        _try(workspace, lambda: workspace.run_file(path))
