"""How a model is integrated: what its file says of its solver, and what is chosen here."""

from __future__ import annotations

import math
from collections.abc import Mapping

from pydrake.systems.analysis import SimulatorConfig

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.dynamics.system import MechanismSystem
from drake_leg.simulink.model import Model, number, vector
from drake_leg.simulink.running.diagram import ModelDiagram
from drake_leg.simulink.running.rates import Rate
from drake_leg.simulink.running.stepping import FAST, STIFF

ACCURACY = 1e-6
STEPS = 50  # at least, of a run, as Simulink takes
# Contact is stiff, and a model that takes short steps: implicit steps as of ode15s are longer.
STIFF_ACCURACY = 1e-3
STIFF_SOLVERS = ("ode15s", "ode23s", "ode23t", "ode23tb", "daessc", "ode14x", "ode1be")
FINEST = 1e-10  # accuracy that a file may ask for
EXPLICIT = "runge_kutta3"  # Drake's integrator for what is not stiff
FIXED = "bogacki_shampine3"  # Simulink's ode3, for fixed steps
STRETCHED = 1.0 + 1e-9  # fixed steps that end at a row are not followed by one of rounding


def solver_of(model: Model, duration: float | None, *, signals_alone: bool) -> dict[str, float]:
    """Return what matters of the settings of a model's solver.

    Parameters
    ----------
    model : Model
        The model.
    duration : float, optional
        Instead of the file's own [s].
    signals_alone : bool
        Whether it has no mechanism: an absolute tolerance is then heeded, too, as the states of a
        mechanism are of the size of 1, and those of signals may be small.
    """
    found = {"duration": _span(model) if duration is None else duration}
    if not math.isfinite(found["duration"]):
        raise InvalidValueError("the model runs for ever: give `duration`")
    longest = vector(model.solver.get("MaxStep"))
    if longest and math.isfinite(longest[0]):
        found["longest step"] = longest[0]
    tolerances = vector(model.solver.get("RelTol"))
    if signals_alone:
        tolerances = (*tolerances, *vector(model.solver.get("AbsTol")))
    if positive := [each for each in tolerances if each > 0.0]:
        found["tolerance"] = max(min(positive), FINEST)
    if model.solver.get("Solver") in STIFF_SOLVERS:
        found["stiff"] = 1.0
    if has_fixed_steps(model) and (step := vector(model.solver.get("FixedStep"))):
        found["fixed step"] = step[0]
    return found


def has_fixed_steps(model: Model) -> bool:
    """Tell whether a model's file asks for a solver of fixed steps."""
    return bool(model.solver.get("SolverType") == "Fixed-step")


def automatic_step(duration: float, base: Rate | None) -> float:
    """Return a fixed step that a file leaves to Simulink [s]: its sample times meet it."""
    return duration / STEPS if base is None else base[0]


def _span(model: Model) -> float:
    """Return how long a model runs by itself [s]."""
    begins, ends = number(model.solver.get("StartTime")), number(model.solver.get("StopTime"), 10.0)
    if ends < begins:
        raise InvalidValueError(f"the model starts at {begins:g} s and stops at {ends:g} s")
    return ends - begins


def takes_fixed_steps(
    diagram: ModelDiagram, solver: Mapping[str, float], accuracy: float | None
) -> bool:
    """Tell whether a run takes the fixed steps of the model's file.

    It does where blocks put out what depends on the steps, as a Derivative does. Contact and what
    the file's solver takes for stiff are integrated by error control all the same, and so is a
    run of a given accuracy.
    """
    return (
        bool(solver.get("fixed step"))
        and diagram.signals.code.has_major
        and accuracy is None
        and "stiff" not in solver
        and not _touches(diagram)
    )


def config_of(
    diagram: ModelDiagram, solver: Mapping[str, float], accuracy: float | None
) -> SimulatorConfig:
    """Choose Drake's integrator, the accuracy and the longest step."""
    is_stiff, duration = _touches(diagram), solver["duration"]
    usual = STIFF_ACCURACY if is_stiff else ACCURACY
    is_fixed = takes_fixed_steps(diagram, solver, accuracy)
    longest = solver.get("longest step", duration / STEPS if duration else 1.0)
    return SimulatorConfig(
        integration_scheme=STIFF if is_stiff else FIXED if is_fixed else EXPLICIT,
        accuracy=accuracy or min(usual, solver.get("tolerance", usual)),
        max_step_size=STRETCHED * solver["fixed step"] if is_fixed else longest,
        use_error_control=not is_fixed,
    )


def is_stiff(diagram: ModelDiagram, solver: Mapping[str, float], config: SimulatorConfig) -> bool:
    """Tell what is known before: bodies may touch, or signals alone are integrated, some fast."""
    if isinstance(diagram.mechanism, MechanismSystem):
        return bool(config.integration_scheme == STIFF)
    fastest = diagram.signals.code.fastest
    return "stiff" in solver or bool(fastest * config.max_step_size > FAST)


def _touches(diagram: ModelDiagram) -> bool:
    mechanism = diagram.mechanism
    return isinstance(mechanism, MechanismSystem) and bool(mechanism.touches)
