"""The models that are derived from a robot's table, by name."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from drake_leg.errors import InvalidValueError, did_you_mean
from drake_leg.robot.robot import Robot, require_robot

if TYPE_CHECKING:
    from drake_leg.symbolic.base_parameters import BaseParameters
    from drake_leg.symbolic.programs import Program
    from drake_leg.symbolic.table import SymbolicTable


@dataclass(frozen=True, kw_only=True)
class Model:
    """A model that can be derived, and what it takes besides the table."""

    meaning: str
    of_frame: bool = False  # of one frame in another
    grouped: bool = False  # may be in base parameters


MODELS: Mapping[str, Model] = {
    "geometry": Model(meaning="pose of a frame in another", of_frame=True),
    "jacobian": Model(meaning="Jacobian of a frame along another's axes", of_frame=True),
    "determinant": Model(meaning="determinant of the square Jacobian", of_frame=True),
    "velocity": Model(meaning="velocities of all frames"),
    "acceleration": Model(meaning="accelerations of all frames"),
    "bias-acceleration": Model(meaning="Jdot qdot of a frame", of_frame=True),
    "dynamics": Model(meaning="joint torques of a motion", grouped=True),
    "inertia": Model(meaning="inertia matrix", grouped=True),
    "coriolis": Model(meaning="Coriolis and centrifugal torques", grouped=True),
    "gravity": Model(meaning="gravity torques", grouped=True),
    "direct": Model(meaning="joint accelerations from torques", grouped=True),
    "identification": Model(meaning="joint torques per dynamic parameter", grouped=True),
}
BASE_PARAMETERS = "base-parameters"


def derive_model(
    robot: Robot,
    model: str,
    *,
    frame: int | str | None = None,
    within: int | str | None = None,
    grouped: bool = False,
) -> Program:
    """Derive a geometric, kinematic or dynamic model of a robot in symbols, as a program.

    A program is a list of short assignments. It can be evaluated for one state or many, printed,
    and written as code.

    Parameters
    ----------
    robot : Robot
        A tree of links, whose base may float. Closed loops are cut: the models are those of the
        tree, and, of torques and inertia, of the actuated joints; "direct" keeps loops closed.
    model : str
        "geometry", "jacobian", "determinant", "velocity", "acceleration", "bias-acceleration",
        "dynamics", "inertia", "coriolis", "gravity", "direct" or "identification".
    frame : int or str, optional
        Number of the frame meant, from 1, or the name of its link, where the model is of one frame:
        the last one by default.
    within : int or str, optional
        Frame along whose axes the result is; 0, the base's, by default.
    grouped : bool
        Use the base parameters in place of the links' dynamic parameters: fewer operations, and an
        identification model of full rank.

    Returns
    -------
    Program
        Called with its inputs, it returns its outputs by name. ``code`` writes it in a language.

    Raises
    ------
    InvalidValueError
        If there is no such model, no such frame, or the Jacobian is not square.

    Examples
    --------
    >>> from drake_leg import LEG_B
    >>> from drake_leg.symbolic.models import derive_model
    >>> torques = derive_model(LEG_B, "dynamics")
    >>> print(torques.operations)
    90 multiplications, 72 additions
    >>> q = [0.0, 0.5, -1.0]
    >>> at_rest = torques(q, [0, 0, 0], [0, 0, 0])["tau"]
    >>> at_rest.round(6).tolist()  # [N*m]
    [0.0, 0.008442, 0.0025]
    >>> print(torques.code("c").splitlines()[-4].strip())
    tau[0] = tau1;
    """
    require_robot(robot)
    require_model(model)
    from drake_leg.symbolic.regressor import with_all_parameters
    from drake_leg.symbolic.table import table_of_robot

    table = table_of_robot(robot)
    if model == "identification" or grouped:
        table = with_all_parameters(table)
    return model_of_table(
        table,
        model,
        frame=frame_number(robot, frame),
        within=frame_number(robot, within),
        grouped=grouped,
    )


def frame_number(robot: Robot, frame: int | str | None) -> int | None:
    """Find the number of a frame that is given by its number or by the name of its link."""
    if frame is None or (isinstance(frame, int) and not isinstance(frame, bool)):
        return frame
    if isinstance(frame, str) and frame.isdecimal():
        return int(frame)
    names = {robot.base_name: 0}
    names |= {s.link.name: n for n, s in enumerate(robot.segments, start=1) if s.link is not None}
    if frame not in names:
        raise InvalidValueError(
            f"{robot.name} has no frame {frame!r}",
            advice=did_you_mean(
                str(frame), names, f"give its number, or a link: {', '.join(names)}"
            ),
        )
    return names[frame]


def base_parameters(robot: Robot) -> BaseParameters:
    """Find a robot's base parameters: the fewest dynamic parameters that give the same torques.

    Links have Khalil's inertial parameters, with the inertia about the origin of the link's frame,
    and joints the inertia of their rotor, viscous and Coulomb friction.

    Parameters
    ----------
    robot : Robot
        A tree of links, whose base may float.

    Returns
    -------
    BaseParameters
        What is grouped in each, its number, and the parameters that have no effect.

    Raises
    ------
    InvalidValueError
        If the grouping is not recognized as a formula.

    Examples
    --------
    >>> from drake_leg import PENDULUM
    >>> from drake_leg.symbolic.models import base_parameters
    >>> print(base_parameters(PENDULUM))
    ZZR1 = IA1 + ZZ1
    MX1
    MY1
    FV1
    FS1
    without effect: XX1, XY1, XZ1, YY1, YZ1, MZ1, M1
    """
    require_robot(robot)
    from drake_leg.symbolic.base_parameters import group_parameters
    from drake_leg.symbolic.regressor import with_all_parameters
    from drake_leg.symbolic.table import table_of_robot

    return group_parameters(with_all_parameters(table_of_robot(robot)))


def require_model(name: str) -> None:
    """Refuse what is not the name of a model."""
    if name not in MODELS:
        raise InvalidValueError(
            f"there is no model {name!r}",
            advice=did_you_mean(name, MODELS, f"the models are {', '.join(MODELS)}"),
        )


def model_of_table(
    table: SymbolicTable,
    name: str,
    *,
    frame: int | None = None,
    within: int | None = None,
    grouped: bool = False,
) -> Program:
    """Derive a model from a table in symbols; frames and ``grouped`` are refused where unused."""
    require_model(name)
    from drake_leg.symbolic import dynamics, geometry, inertia, regressor
    from drake_leg.symbolic.base_parameters import group_parameters

    model = MODELS[name]
    if not model.of_frame and (frame is not None or within is not None):
        raise InvalidValueError(
            f"the model {name!r} is of all frames, and takes neither `frame` nor `within`"
        )
    if grouped and not model.grouped:
        raise InvalidValueError(
            f"the model {name!r} has no dynamic parameters to group", advice="leave out `grouped`"
        )
    if name == "determinant":
        return geometry.determinant(table, frame, within)
    if model.of_frame:
        of_frame: dict[str, Callable[..., Program]] = {
            "geometry": geometry.geometric_model,
            "jacobian": geometry.jacobian,
            "bias-acceleration": geometry.bias_acceleration,
        }
        return of_frame[name](table, frame, within or 0)
    if name == "identification":
        return (
            group_parameters(table).regressor()
            if grouped
            else regressor.regressor(table, regressor.parameters(table))
        )
    of_table: dict[str, Callable[[SymbolicTable], Program]] = {
        "velocity": geometry.velocities,
        "acceleration": geometry.accelerations,
        "dynamics": dynamics.inverse_dynamics,
        "inertia": inertia.inertia,
        "coriolis": dynamics.coriolis,
        "gravity": dynamics.gravity,
        "direct": inertia.direct_dynamics,
    }
    return of_table[name](group_parameters(table).reduced_table if grouped else table)
