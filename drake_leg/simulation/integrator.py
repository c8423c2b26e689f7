"""How time is stepped: Drake's integrators by name, and what may be asked of them."""

from __future__ import annotations

from dataclasses import dataclass

from drake_leg.errors import InvalidValueError
from drake_leg.units import require_number, require_positive

# Not among them: velocity_implicit_euler, which loses the states of Integrator blocks.
INTEGRATORS = (
    "runge_kutta5",
    "runge_kutta3",
    "bogacki_shampine3",
    "runge_kutta2",
    "explicit_euler",
    "semi_explicit_euler",
    "implicit_euler",
    "radau1",
    "radau3",
)
IMPLICIT = ("implicit_euler", "radau1", "radau3")  # stable, however fast a motion decays
ERROR_CONTROLLED = (
    "runge_kutta5",
    "runge_kutta3",
    "bogacki_shampine3",
    "implicit_euler",
    "radau1",
    "radau3",
)
ROW_INTERVAL = 0.040  # [s], greatest distance of two rows of a recording


def require_accuracy(what: str, accuracy: float) -> None:
    """Refuse a relative accuracy that no error control keeps, or that means nothing."""
    require_number(what, accuracy)
    if not 1e-14 <= accuracy <= 0.1:
        raise InvalidValueError(f"{what} is {accuracy!r}; it must be in 1e-14 ... 0.1")


@dataclass(frozen=True, kw_only=True)
class IntegratorSettings:
    """How time is stepped: at ``max_step``, or by error control where an accuracy is given."""

    scheme: str = "runge_kutta5"
    accuracy: float | None = None  # relative, of the error control; None: fixed steps
    max_step: float = ROW_INTERVAL  # [s]

    def __post_init__(self) -> None:
        if self.scheme not in INTEGRATORS:
            raise InvalidValueError(
                f"the integrator is {self.scheme!r}; it must be one of {', '.join(INTEGRATORS)}"
            )
        require_positive("the greatest step", self.max_step, "s")
        if self.max_step > ROW_INTERVAL:
            raise InvalidValueError(
                f"the greatest step is {self.max_step!r} s; it must be at most {ROW_INTERVAL} s, "
                "since the steps are the rows of the recording"
            )
        if self.accuracy is None:
            return
        require_accuracy("the accuracy", self.accuracy)
        if self.scheme not in ERROR_CONTROLLED:
            raise InvalidValueError(
                f"the integrator {self.scheme!r} has no error control, so that the accuracy "
                f"{self.accuracy!r} means nothing to it: leave it out, or choose one of "
                f"{', '.join(ERROR_CONTROLLED)}"
            )
