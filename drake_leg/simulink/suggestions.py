"""Which script a person would run before a model: the one that sets most of what it lacks."""

from __future__ import annotations

import re
from collections.abc import Callable, Container, Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.file import SimulinkFile
from drake_leg.simulink.lacks import Lack, lacks_of
from drake_leg.simulink.matlab import syntax
from drake_leg.simulink.matlab.checking import walked
from drake_leg.simulink.matlab.folders import SCRIPTS, Folders, text_of
from drake_leg.simulink.matlab.matfiles import names_of_mat, read_struct
from drake_leg.simulink.matlab.names import assigned
from drake_leg.simulink.matlab.numeric import MatlabError
from drake_leg.simulink.model import Model

MOST_SCRIPTS = 3
MOST_MODELS = 100  # whose workspaces are looked into
_SHORT = 4_000  # letters; a longer script does more than run others
_GOODNESS = {".slx": 0, ".mat": 1, **dict.fromkeys(SCRIPTS, 2)}
_STARTS = "startup"  # name of a script that a project runs when it is opened
_DEPTH = 4  # scripts that scripts run


@dataclass(frozen=True, kw_only=True)
class Suggestion:
    """A script, .mat file or model that sets variables which a model lacks."""

    path: Path
    names: tuple[str, ...]  # that it sets
    others: tuple[Path, ...] = ()  # files that set as many, farther from the model


def suggested_init(
    model: Model, lacks: Iterable[Lack], without: Container[Path] = ()
) -> Suggestion | None:
    """Find the file beside the model, or in its folders, that sets most of what it lacks.

    Of several that set as many: a script rather than a .mat file, one that a project runs when it
    is opened, one that sets them itself rather than one that only runs it, and the one nearest to
    the model. Those that are as good but for that are its ``others``. What a library lacks may lie
    in the workspace of a model, too. Files in ``without`` are passed over.
    """
    missing = _missing(lacks)
    if not missing or model.variables is None:
        return None
    folders = model.variables.workspace.folders
    done = set(model.variables.init)
    reader = _Reader(folders, set(missing))
    ranked: dict[tuple[int, int, bool, int], list[Path]] = {}  # the best last, nearest first
    models = list(filter(folders.is_near, folders.ending(".slx")))[:MOST_MODELS]
    models = models if model.variables.is_lent else []
    files = (path for ending in (*SCRIPTS, ".mat") for path in folders.ending(ending))
    for path in (*files, *models):
        sets = reader.sets(path) if path.resolve() not in done and path not in without else set()
        if sets:
            opens = path.stem.lower().startswith(_STARTS)
            rank = (len(sets), _GOODNESS[path.suffix], opens, len(reader.own[path]))
            ranked.setdefault(rank, []).append(path)
    if not ranked:
        return None
    nearest, *others = ranked[max(ranked)]
    sets = reader.sets(nearest)
    names = dict.fromkeys(name.partition(".")[0] for name in missing if name in sets)
    return Suggestion(path=nearest, names=tuple(names), others=tuple(others))


def with_scripts(
    model: Model,
    read: Callable[[Sequence[Path]], Model],
    lacks_in: Callable[[Model], Sequence[Lack]] = lacks_of,
) -> tuple[Model, tuple[Suggestion, ...]]:
    """Read a model again with scripts that a person would run first, while it lacks ever less.

    ``read`` reads it with such files, and ``lacks_in`` lists what it lacks; the scripts that were
    used are returned, too.
    """
    used: tuple[Suggestion, ...] = ()
    useless: list[Path] = []  # what fails or gives nothing, as nobody has asked for it
    lacks = lacks_in(model)
    while lacks and max(len(used), len(useless)) < MOST_SCRIPTS:
        hint = suggested_init(model, lacks, without=useless)
        if hint is None:
            break
        try:
            again = read([*(each.path for each in used), hint.path])
            left = lacks_in(again)
        except InvalidValueError:
            left = lacks
        if _measure(left) < _measure(lacks):
            model, lacks, used = again, left, (*used, hint)
        else:
            useless.append(hint.path)
    return model, used


def _measure(lacks: Sequence[Lack]) -> tuple[int, int]:
    """Tell how much lacks: how many values, and how many names in them."""
    return len(lacks), len(_missing(lacks))


def _missing(lacks: Iterable[Lack]) -> dict[str, None]:
    """Names without a value, and the fields of them that are used: ``leg``, ``leg.mass``."""
    found: dict[str, None] = {}
    for lack in lacks:
        for name in lack.names:
            base = name.partition(".")[0]
            found[base] = None
            pattern = rf"(?<![\w.]){re.escape(base)}\.[A-Za-z]\w*"
            found.update(dict.fromkeys((*re.findall(pattern, lack.text), name)))
    return found


class _Reader:
    """Tells which of some variables a script sets, without running it."""

    def __init__(self, folders: Folders, wanted: set[str]) -> None:
        self._folders, self._wanted = folders, wanted
        self._word = re.compile(rf"\b(?:{'|'.join(map(re.escape, wanted))})\b")
        self._found: dict[Path, set[str]] = {}
        self.own: dict[Path, set[str]] = {}  # file -> names that it sets itself

    def sets(self, path: Path, depth: int = 0) -> set[str]:
        """Names that a file sets, those included that the scripts set which it runs."""
        if path not in self._found:
            self._found[path] = self.own[path] = set()  # while it is looked at
            with suppress(InvalidValueError, MatlabError, OSError):
                self._found[path] = self._looked_at(path, depth)
        return self._found[path]

    def _looked_at(self, path: Path, depth: int) -> set[str]:
        if path.suffix.lower() == ".mat":
            self.own[path] = self._wanted & names_of_mat(path)
            return self.own[path]
        if path.suffix == ".slx":
            content = SimulinkFile(path).workspace_content
            names = set(read_struct(content, path.name)) if content else set()
            self.own[path] = self._wanted & names
            return self.own[path]
        text = text_of(path)
        if len(text) > _SHORT and not self._word.search(text):
            return set()
        tree = self._folders.script(path)
        self.own[path] = self._wanted & {*assigned(tree.statements), *_fields(tree.statements)}
        found = set(self.own[path])
        if depth < _DEPTH:
            for statement, _ in walked(tree.statements):
                for inner in self._run_by(statement, path):
                    found |= self.sets(inner, depth + 1)
        return found

    def _run_by(self, statement: syntax.Statement, path: Path) -> list[Path]:
        """Files that a statement runs or loads."""
        found: Path | None = None
        match statement:
            case syntax.Evaluate(value=syntax.Name(name=script)):
                found = self._folders.code(script, path.parent)
            case syntax.Evaluate(
                value=syntax.Apply(name="run" | "load" as how, arguments=(syntax.Text(text=text),))
            ):
                found = self._named(text, how, path.parent)
            case syntax.Command(name="run" | "load" as how, words=(str() as text, *_)):
                found = self._named(text, how, path.parent)
        return [found] if found else []

    def _named(self, text: str, how: str, beside: Path) -> Path | None:
        """Find the file that ``run`` or ``load`` names, with or without its ending."""
        name = re.split(r"[\\/]", text)[-1]
        if how == "load":
            return self._folders.file(f"{name.removesuffix('.mat')}.mat", beside)
        return self._folders.code(name, beside)


def _fields(statements: tuple[syntax.Statement, ...]) -> Iterator[str]:
    """Fields of variables that statements set: ``leg.mass``."""
    for statement in statements:
        match statement:
            case syntax.Assign(targets=targets):
                for target in targets:
                    if isinstance(target, syntax.Place):
                        yield f"{target.name}.{_first_field(target.to)}"
            case syntax.If(branches=branches, otherwise=otherwise):
                for _, _, body in branches:
                    yield from _fields(body)
                yield from _fields(otherwise)
            case syntax.For(body=body) | syntax.While(body=body) | syntax.Try(body=body):
                yield from _fields(body)


def _first_field(node: syntax.Expression) -> str:
    name = ""
    while isinstance(node, (syntax.Field, syntax.Part)):
        name = str(node.name) if isinstance(node, syntax.Field) else name
        node = node.base
    return name
