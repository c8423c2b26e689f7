"""The errors that this package raises, each with the numbers that explain it.

An error's text is one sentence: the problem, and, after a colon, what the caller can do. Advice is
written for Python; settings are in backquotes, as ``choose `inverse='damped'` ``, so that the
command line can show them as its options.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from importlib import import_module
from typing import Any

MOST_OF_A_TEXT = 300  # characters
ALIKE = 0.7  # 1: the same; names less alike than this are not suggested


class DrakeLegError(Exception):
    """Root of all errors of this package; its text is one sentence for a person.

    Attributes
    ----------
    problem : str
        What is wrong.
    advice : str
        What to do about it, in Python's terms; may be empty.
    """

    advice = ""

    def __init__(self, problem: str, *, advice: str = "") -> None:
        super().__init__(problem)
        if advice:
            self.advice = advice

    @property
    def problem(self) -> str:
        """What is wrong, without the advice."""
        return super().__str__()

    def __str__(self) -> str:
        return f"{self.problem}: {self.advice}" if self.advice else self.problem

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle problem and attributes, whatever the constructor takes."""
        return _restored, (type(self), self.args, vars(self))


def _restored(
    kind: type[DrakeLegError], arguments: Sequence[object], attributes: Mapping[str, Any]
) -> DrakeLegError:
    error = kind.__new__(kind, *arguments)
    vars(error).update(attributes)
    return error


class InvalidValueError(DrakeLegError, ValueError):
    """A value that makes no sense."""


class MissingNumbersError(InvalidValueError):
    """Letters of a robot's file that need a number and have none.

    Attributes
    ----------
    letters : tuple of str
        All of them.
    """

    def __init__(self, where: object, letters: Mapping[str, str], why: str = "") -> None:
        self.letters = tuple(letters)
        named = [f"{letter} ({place})" for letter, place in letters.items()]
        listed = " and ".join(filter(None, (", ".join(named[:-1]), named[-1])))
        numbers = ", ".join(f"{letter!r}: 0.1" for letter in letters)
        super().__init__(
            f"{where}: {listed} {'have' if len(named) > 1 else 'has'} no number{why}",
            advice=f"give numbers={{{numbers}}} with the right numbers",
        )


GIVE_A_VALUE = "give a value of "
GIVE_A_PLACE, GIVE_A_DIRECTION = "give a place to ", "give a place and a direction to "


class UnknownValueError(InvalidValueError):
    """A value of a Simulink model that cannot be evaluated.

    Attributes
    ----------
    names : tuple of str
        The variables and functions that it uses and nothing gives, where that is the reason.
    text : str
        The value as it stands in the file.
    """

    def __init__(
        self, problem: str, *, names: Iterable[str] = (), text: str = "", advice: str = ""
    ) -> None:
        self.names, self.text = tuple(names), text
        super().__init__(problem, advice=advice)


class UnplacedFeatureError(InvalidValueError):
    """A frame on a feature of a CAD program's file, which nobody has placed.

    Attributes
    ----------
    file, feature : str
        The file's name without its folder, and Simscape's name of the feature in it.
    directed : bool
        Whether the frame is along it, so that it takes a direction, too.
    """

    def __init__(self, *, file: str, feature: str, directed: bool = False) -> None:
        self.file, self.feature, self.directed = file, feature, directed
        give = GIVE_A_DIRECTION if directed else GIVE_A_PLACE
        super().__init__(
            f"it has a frame on {feature!r} of {file!r}, which takes a CAD program to find",
            advice=f"{give}'{file}:{feature}' in the solid's reference frame",
        )


class MissingThingsError(InvalidValueError):
    """All that a Simulink model lacks for what is asked of it.

    A value that several blocks need is asked for once.

    Attributes
    ----------
    problems : tuple of str
        A sentence about each.
    """

    def __init__(self, problems: Iterable[str], goal: str) -> None:
        self.problems = tuple(problems)
        uses: dict[str, list[str]] = {}
        for problem in self.problems:
            _, asked, names = problem.rpartition(GIVE_A_VALUE)
            uses.setdefault(names if asked else problem, []).append(problem)
        lines = [
            first
            + (f" ({len(others)} more need{'s' if len(others) == 1 else ''} it)" if others else "")
            for first, *others in uses.values()
        ]
        several = f"{len(lines)} things are missing for {goal}"
        super().__init__(lines[0] if len(lines) == 1 else "\n  ".join((several, *lines)))


class OutputError(DrakeLegError):
    """A file or folder that cannot be written or read."""


class PlaceError(OutputError):
    """A place where nothing can be written.

    Attributes
    ----------
    path : str
        The place.
    replaceable : bool
        Whether it could be written if overwriting were allowed.
    """

    def __init__(self, path: object, why: str, *, replaceable: bool = False) -> None:
        self.path = str(path)
        self.replaceable = replaceable
        overwrite = ", or add `overwrite=True`" if replaceable else ""
        super().__init__(f"{path} {why}", advice=f"choose another place{overwrite}")


class UnreadableFileError(InvalidValueError, OutputError):
    """A file that is not a regular file, is too large, or cannot be read.

    Attributes
    ----------
    reason : str
        Why, without the file's name.
    """

    def __init__(self, path: object, reason: str) -> None:
        self.reason = reason
        super().__init__(f"{path} cannot be read: {reason}")


class PictureError(DrakeLegError):
    """A picture that could not be made; nothing else is lost.

    Attributes
    ----------
    what : str
        Which picture: ``the figure angle``.
    """

    def __init__(self, what: str, error: Exception) -> None:
        self.what = what
        if isinstance(error, DrakeLegError):
            super().__init__(f"{what}: {error.problem}", advice=error.advice)
        else:
            super().__init__(
                f"{what} was not made ({in_a_line(error)})",
                advice="please report this, with the command that you gave",
            )


def in_a_line(error: BaseException) -> str:
    """Describe an unexpected error in one line."""
    text = " ".join(str(error).split())
    return f"{type(error).__name__}: {text[:MOST_OF_A_TEXT]}" if text else type(error).__name__


def did_you_mean(word: object, known: Iterable[str], otherwise: str = "") -> str:
    """Ask about the known names that begin with a word, or else about the most similar one."""
    import difflib  # not needed where nothing is wrong

    names = {name.lower(): name for name in known}
    typed = str(word).lower()
    begun = [name for lower, name in names.items() if typed and lower.startswith(typed)]
    near = begun or [
        names[each] for each in difflib.get_close_matches(typed, names, n=1, cutoff=ALIKE)
    ]
    return f"did you mean {' or '.join(near)}?" if near else otherwise


class SingularConfigurationError(DrakeLegError):
    """The inverse Jacobian is needed where it does not exist.

    Attributes
    ----------
    q : tuple of float
        Joint positions [rad or m].
    sigma_min : float
        Smallest singular value of the Jacobian there.
    time : float or None
        Simulated time [s], where there is one.
    """

    def __init__(
        self,
        *,
        q: Sequence[float],
        sigma_min: float,
        time: float | None = None,
        problem: str = "",
        advice: str = "choose another posture, a smaller amplitude or a higher frequency",
    ) -> None:
        self.q = tuple(float(value) for value in q)
        self.sigma_min = float(sigma_min)
        self.time = time
        when = "" if time is None else f" at t = {time:.9g} s"
        posture = ", ".join(f"{value:.6g}" for value in self.q)
        super().__init__(
            problem
            or f"the Jacobian is singular{when} (q = {posture} in rad, or m where a joint slides; "
            f"smallest singular value {self.sigma_min:.3g})",
            advice=advice,
        )


class ForeseenSingularityError(SingularConfigurationError):
    """A commanded motion that will meet a singularity, refused before it starts.

    Attributes
    ----------
    q : tuple of float
        Joint positions there [rad or m].
    time : float
        Simulated time at which it would be met [s].
    """

    def __init__(self, *, name: str, description: str, q: Sequence[float], time: float) -> None:
        super().__init__(
            q=q,
            sigma_min=0.0,
            time=time,
            problem=f"{name} would become {description}",
            advice="`force=True` goes up to there, `inverse='damped'` or `'limited'` goes on",
        )


class LostMotionError(DrakeLegError):
    """Near a singularity the joints no longer follow their prescribed motion.

    Attributes
    ----------
    time : float
        Simulated time [s].
    lag : float
        How far the joints are behind [rad or m].
    """

    def __init__(self, *, time: float, lag: float) -> None:
        self.time = time
        self.lag = lag
        super().__init__(
            f"near a singularity the joints were {lag:.3g} rad or m behind their prescribed "
            f"motion at t = {time:.9g} s",
            advice="choose `integrator='runge_kutta5'` or a smaller `max_step`",
        )


class StepBudgetError(DrakeLegError):
    """The integrator needed more steps than a run is allowed.

    Attributes
    ----------
    steps : int
        How many it had taken.
    time : float
        Simulated time reached [s].
    """

    def __init__(self, *, steps: int, time: float) -> None:
        self.steps = steps
        self.time = time
        super().__init__(
            f"the integrator had taken {steps} steps when it reached t = {time:.9g} s and "
            "was stopped",
            advice="choose a larger `max_step`, a looser `accuracy` or, where light links "
            "are damped, `integrator='radau3'`",
        )


class TimeBudgetError(DrakeLegError):
    """A calculation that did not finish in the time it was allowed.

    Attributes
    ----------
    seconds : float
        That time [s].
    """

    def __init__(self, *, seconds: float) -> None:
        self.seconds = seconds
        super().__init__(f"not done within {seconds:g} s", advice="give it more with `budget`")


class UnstableRunError(DrakeLegError):
    """The integration blew up: its step is too large for the model's stiffness.

    Attributes
    ----------
    time : float
        Simulated time [s] at which it was noticed.
    max_step : float
        The largest step [s].
    scheme : str
        The integrator.
    """

    def __init__(self, *, time: float, max_step: float, scheme: str) -> None:
        self.time = time
        self.max_step = max_step
        self.scheme = scheme
        super().__init__(
            f"the integration had blown up at t = {time:.9g} s: steps of {max_step:g} s are too "
            f"large for {scheme} on this model",
            advice="choose a smaller `max_step`, an `accuracy`, or `integrator='radau3'`",
        )


class JointLimitError(DrakeLegError):
    """A joint has left its limits.

    Attributes
    ----------
    joint : str
        Name of the joint.
    position : float
        Where it is [rad or m].
    limits : (float, float)
        Lower and upper limit [rad or m].
    time : float
        Simulated time [s].
    """

    def __init__(
        self,
        *,
        joint: str,
        position: float,
        limits: tuple[float, float],
        time: float,
        slides: bool = False,
        advice: str = "choose another posture or a smaller amplitude",
    ) -> None:
        self.joint = joint
        self.position = float(position)
        self.limits = limits
        self.time = time
        unit, size = ("m", 1.0) if slides else ("deg", math.degrees(1.0))
        low, high = (size * limit for limit in limits)
        super().__init__(
            f"joint {joint} is at {size * self.position:.9g} {unit} at t = {time:.9g} s, outside "
            f"its limits {low:.6g} ... {high:.6g} {unit}",
            advice=advice,
        )


class ImpossibleWalkError(DrakeLegError):
    """A walk that the robot cannot make, refused before it starts.

    Attributes
    ----------
    where : str
        Leg, joint or links of which too much is asked; empty for the whole robot.
    time : float
        Simulated time at which that would be [s].
    value, limit : float
        What is asked for, and what the robot can do.
    """

    def __init__(
        self, problem: str, *, advice: str, where: str, time: float, value: float, limit: float
    ) -> None:
        self.where = where
        self.time = time
        self.value = value
        self.limit = limit
        super().__init__(problem, advice=advice)


class BrokenPackageError(DrakeLegError):
    """A package that is needed is not installed, or fails when it is imported.

    Attributes
    ----------
    reason : str
        Why it cannot be imported.
    """

    def __init__(self, purpose: str, package: str, reason: str, remedy: str) -> None:
        self.reason = reason
        super().__init__(
            f"{purpose} needs {package}, which cannot be imported ({reason})", advice=remedy
        )


def require_import(module: str, *, purpose: str, package: str, remedy: str) -> None:
    """Refuse to go on without a package, of which this module is needed for a purpose.

    Raises
    ------
    BrokenPackageError
        With the reason, whatever it is.
    """
    try:
        import_module(module)
    except Exception as error:  # a broken package may raise anything
        lines = str(error).splitlines() or [type(error).__name__]
        raise BrokenPackageError(purpose, package, lines[0], remedy) from error


def require_matplotlib() -> None:
    """Refuse to go on without matplotlib and Pillow, which figures need."""
    require_pillow()
    require_import(
        "matplotlib",
        purpose="a figure",
        package="matplotlib",
        remedy="take MPLBACKEND out of the environment if it is set, or "
        "pip install --force-reinstall matplotlib",
    )


def require_pillow() -> None:
    """Refuse to go on without Pillow, which all pictures need."""
    require_import(
        "PIL.Image",
        purpose="a picture",
        package="Pillow",
        remedy="pip install --force-reinstall pillow",
    )


def require_pyarrow() -> None:
    """Refuse to go on without pyarrow, which the table of a sweep needs."""
    require_import(
        "pyarrow.parquet",
        purpose="the table of a sweep",
        package="pyarrow",
        remedy="pip install 'drake-leg[sweep]'",
    )


def require_distributed() -> None:
    """Refuse to go on without dask.distributed, which a cluster needs."""
    require_import(
        "distributed",
        purpose="a cluster",
        package="dask.distributed",
        remedy="pip install 'drake-leg[cluster]'",
    )
