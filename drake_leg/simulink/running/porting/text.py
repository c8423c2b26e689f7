"""Python text: values, calls and imports as a script has them."""

from __future__ import annotations

import ast
import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.running import operations
from drake_leg.simulink.running.code import NAMESPACE, Call, literal
from drake_leg.simulink.running.diagram import Array
from drake_leg.simulink.running.folding import WIDTH, folded
from drake_leg.simulink.running.porting.functions import NotedFolders

PYDRAKE = {
    "Diagram": "pydrake.systems.framework",
    "DiagramBuilder": "pydrake.systems.framework",
    "TriggerType": "pydrake.systems.framework",
    "LogVectorOutput": "pydrake.systems.primitives",
}
MATLAB = ("compiled", "Expression")  # their first argument is code
RUNNING = "drake_leg.simulink.running"
MODULES = {
    **PYDRAKE,
    "Path": "pathlib",
    "CubicHermiteSpline": "scipy.interpolate",
    "compiled": "drake_leg.simulink.matlab.compiling",
    "Expression": f"{RUNNING}.kinds.functions",
    "shown": f"{RUNNING}.ported",
    "Label": f"{RUNNING}.columns",
    "columns_of": f"{RUNNING}.columns",
    "figures_of": f"{RUNNING}.columns",
    "recording_of": f"{RUNNING}.columns",
    "SignalSystem": f"{RUNNING}.system",
    "WrittenCode": f"{RUNNING}.ported",
    "WrittenFunctions": f"{RUNNING}.ported",
    "mechanism_from": f"{RUNNING}.ported",
    "positive": f"{RUNNING}.ported",
    "simulated": f"{RUNNING}.ported",
    "figure_of": "drake_leg.pictures.plots.scope_plots",
    "save": "drake_leg.pictures.plots.style",
}
WHOLE = {"json": "import json", "math": "import math", "np": "import numpy as np",
         "argparse": "import argparse"}  # fmt: skip


def names_in(text: str) -> set[str]:
    """Names that a Python text reads or sets."""
    return {node.id for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Name)}


def imports(body: str) -> str:
    """Write the imports that a body needs, in groups as is usual."""
    used = names_in(body)
    modules: dict[str, list[str]] = {}
    for name in sorted(used):
        module = MODULES.get(name) or (_module_of(name) if name in NAMESPACE else "")
        if module:
            modules.setdefault(module, []).append(name)
    lines = [
        (_rank(module), 1, module, f"from {module} import {', '.join(names)}")
        for module, names in modules.items()
    ]
    for name, text in WHOLE.items():
        if name in used:
            lines.append((_rank(text.split()[1]), 0, text, text))
    groups: dict[int, list[str]] = {}
    for rank, _, _, text in sorted(lines):
        groups.setdefault(rank, []).extend(_folded_import(text))
    return "\n\n".join("\n".join(groups[rank]) for rank in sorted(groups))


def _rank(module: str) -> int:
    """Whether a module is Python's own, another's, or of this package."""
    package = module.partition(".")[0]
    return {"numpy": 1, "pydrake": 1, "scipy": 1, "drake_leg": 2}.get(package, 0)


def _folded_import(line: str) -> list[str]:
    """Fold an import that is too long for a line."""
    head, _, names = line.partition(" import ")
    if len(line) <= WIDTH or not names:
        return [line]
    return [f"{head} import (", *(f"    {name}," for name in names.split(", ")), ")"]


def _module_of(name: str) -> str:
    """Module that has a name which the code of signals uses; "" for one that is imported whole."""
    if name in WHOLE:
        return ""
    for module, text in ((operations, operations.__name__), (np, "numpy"), (math, "math")):
        if getattr(module, name, None) is NAMESPACE[name]:
            return text
    raise InvalidValueError(f"the code of signals calls {name}, which no script can import")


def written(value: Any, name: str) -> str:  # noqa: ANN401 - of any kind
    """Write a value as Python."""
    if isinstance(value, bool | np.bool_):
        return repr(bool(value))
    if isinstance(value, np.ndarray):
        kind = "" if value.dtype == float else f", dtype={value.dtype.name!r}"
        if not value.size:
            return f"zeros({value.shape}{kind})"
        return f"array({written(value.tolist(), name)}{kind})"
    if isinstance(value, float | np.floating):
        return literal(float(value))
    if isinstance(value, int | str) or value is None:
        return repr(value)
    if isinstance(value, tuple):
        inner = ", ".join(written(each, name) for each in value)
        return f"({inner},)" if len(value) == 1 else f"({inner})"
    if isinstance(value, list):
        return f"[{', '.join(written(each, name) for each in value)}]"
    if isinstance(value, frozenset):
        return f"frozenset({written(sorted(value), name)})"
    if isinstance(value, dict):
        pairs = (f"{key!r}: {written(each, name)}" for key, each in value.items())
        return f"{{{', '.join(pairs)}}}"
    raise InvalidValueError(f"{name} is a {type(value).__name__}, which a script cannot hold")


def rows(name: str, matrix: Array) -> Iterator[str]:
    """Write a matrix by its rows."""
    yield f"{name} = array(["
    for row in matrix:
        yield from folded(f"{written(row.tolist(), name)},", 4)
    yield "])"


def called(call: Call, folders: NotedFolders | None) -> str:
    """Write a call; code that calls functions in files has them from the script's `functions`."""
    words = [_text(each) if isinstance(each, str) else written(each, "") for each in call.arguments]
    words += [f"{key}={written(value, key)}" for key, value in call.named.items() if value]
    if call.function in MATLAB and folders is not None and folders.note(call.arguments[0]):
        words.append("functions=functions")
    return f"{call.function}({', '.join(words)})"


def _text(text: str) -> str:
    """Write a text, over several lines where it has them."""
    if "\n" in text and '"""' not in text and "\\" not in text and not text.endswith('"'):
        return f'"""\\\n{text}"""'
    return repr(text)
