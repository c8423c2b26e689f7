"""The solver's settings."""

from __future__ import annotations

import re
from xml.etree.ElementTree import Element

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.evaluation import evaluate, require_finite
from drake_leg.simulink.markup import parameters
from drake_leg.simulink.model import Value

_DEFAULTS = {
    "StartTime": "0.0",
    "StopTime": "10.0",
    "RelTol": "1e-3",
    "AbsTol": "auto",
    "MaxStep": "auto",
    "MinStep": "auto",
    "InitialStep": "auto",
    "FixedStep": "auto",
}
_UNBOUNDED = ("StopTime", "MaxStep")
_FIXED = re.compile(r"FixedStep\w*|ode(1|2|3|4|5|8|14x|1be|1b)")


def solver_of(configuration: Element | None) -> dict[str, Value]:
    """Read the settings of the first configuration.

    Parameters
    ----------
    configuration : Element or None
        Root of the part that holds it; None where the file has none.

    Returns
    -------
    dict
        ``Solver``, ``SolverType`` and times [s] and tolerances; defaults where they are absent.

    Raises
    ------
    InvalidValueError
        If a number cannot be evaluated, or is infinite where none can be.
    """
    texts = _texts(configuration)
    solver = texts.get("SolverName") or texts.get("Solver") or "VariableStepAuto"
    kind = "Fixed-step" if _FIXED.fullmatch(solver) else "Variable-step"
    found: dict[str, Value] = {"Solver": solver, "SolverType": texts.get("SolverType", kind)}
    for name, default in _DEFAULTS.items():
        try:
            text = texts.get(name, default)
            found[name] = evaluate(text, "", "")
            require_finite(found[name], text, unbounded=name in _UNBOUNDED)
        except InvalidValueError as error:
            raise InvalidValueError(f"solver setting {name} {error}") from None
    return found


def _texts(configuration: Element | None) -> dict[str, str]:
    if configuration is None:
        return {}
    for component in configuration.iter("Object"):
        if component.get("ClassName", "").endswith("SolverCC"):
            return parameters(component)
    for component in configuration.iter():
        texts = parameters(component)
        if "StopTime" in texts:
            return texts
    return {}
