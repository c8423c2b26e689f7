"""Which script a person would run before a model: the one that sets most of what it lacks."""

from __future__ import annotations

import re
from collections.abc import Callable, Container, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import islice
from pathlib import Path

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.file import simulink_file
from drake_leg.simulink.lacks import Lack, lacks_of
from drake_leg.simulink.matlab import syntax
from drake_leg.simulink.matlab.checking import walked
from drake_leg.simulink.matlab.folders import SCRIPTS, Folders, text_of
from drake_leg.simulink.matlab.matfiles import names_of_mat, read_struct
from drake_leg.simulink.matlab.names import assigned
from drake_leg.simulink.matlab.numeric import MatlabError
from drake_leg.simulink.model import Model

MOST_SCRIPTS = 3
MOST_TRIED = 10  # that set as many variables
MOST_MODELS = 100  # whose workspaces are looked into
_SHORT = 4_000  # letters; a longer script does more than run others
_GOODNESS = {".slx": 0, ".mat": 1, **dict.fromkeys(SCRIPTS, 2)}
_STARTS = "startup"  # name of a script that a project runs when it is opened
_DEPTH = 4  # scripts that scripts run


Read = Callable[[Sequence[Path]], Model]


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
    return next(iter(_suggestions(model, lacks, without)), None)


def _suggestions(
    model: Model, lacks: Iterable[Lack], without: Container[Path]
) -> Iterator[Suggestion]:
    """List the files that set what a model lacks, the best first; others are as good as they."""
    missing = _missing(lacks)
    if not missing or model.variables is None:
        return
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
    for _, equal in sorted(ranked.items(), reverse=True):
        for path in equal:
            sets = reader.sets(path)
            names = dict.fromkeys(name.partition(".")[0] for name in missing if name in sets)
            others = tuple(other for other in equal if other != path)
            yield Suggestion(path=path, names=tuple(names), others=others)


def with_scripts(
    model: Model, read: Read, lacks_in: Callable[[Model], Sequence[Lack]] = lacks_of
) -> tuple[Model, tuple[Suggestion, ...]]:
    """Read a model again with scripts that a person would run first, while it lacks ever less.

    ``read`` reads it with such files, and ``lacks_in`` lists what it lacks; the scripts that were
    used are returned, too. Where values of a script do not fit, others are tried, and
    that one is used after which the model lacks least.
    """
    used: tuple[Suggestion, ...] = ()
    useless: list[Path] = []  # what fails or gives nothing, as nobody has asked for it
    now = _Reading(model, lacks_in(model))
    while now.lacks and max(len(used), len(useless)) < MOST_SCRIPTS:
        tried: dict[Suggestion, _Reading] = {}
        for hint in islice(_suggestions(now.model, now.lacks, useless), MOST_TRIED):
            files = [*(each.path for each in used), hint.path]
            found = _read_with(files, read, lacks_in)
            if found is None or found.measure >= now.measure:
                useless.append(hint.path)
                if len(useless) == MOST_SCRIPTS:
                    break
                continue
            tried[hint] = found
            if not found.lacks_by(hint.names):
                break
        if not tried:
            break
        best = min(tried, key=lambda hint: tried[hint].measure)
        now, used = tried[best], (*used, _among(tried, best, useless))
    return now.model, used


@dataclass(frozen=True)
class _Reading:
    """A model as it is read with some files, and what it lacks then."""

    model: Model
    lacks: Sequence[Lack]

    @property
    def measure(self) -> tuple[int, int]:
        """How much it lacks: how many values, and how many names in them."""
        return len(self.lacks), len(_missing(self.lacks))

    def lacks_by(self, names: Iterable[str]) -> bool:
        """Tell whether a value that is not known uses one of some variables."""
        used = re.compile(rf"\b(?:{'|'.join(map(re.escape, names))})\b")
        return any(used.search(lack.text) for lack in self.lacks)


def _read_with(
    files: Sequence[Path], read: Read, lacks_in: Callable[[Model], Sequence[Lack]]
) -> _Reading | None:
    """Read a model with files of values; None where one fails."""
    try:
        model = read(files)
        return _Reading(model, lacks_in(model))
    except InvalidValueError:
        return None


def _among(
    tried: Mapping[Suggestion, _Reading], best: Suggestion, useless: Container[Path]
) -> Suggestion:
    """Name with the best of the files that were tried those that are as good, or not tried."""
    measures = {hint.path: reading.measure for hint, reading in tried.items()}
    least = measures.pop(best.path)
    equal = [path for path in measures if measures[path] == least]
    untried = [path for path in best.others if path not in measures and path not in useless]
    return replace(best, others=(*equal, *untried))


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
            content = simulink_file(path).workspace_content
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
