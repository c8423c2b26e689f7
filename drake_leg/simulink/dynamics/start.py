"""Where a mechanism starts: at its state targets, with its loops closed."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import QuaternionFloatingJoint
from scipy.linalg import null_space

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.dynamics.acting import Acting
from drake_leg.simulink.dynamics.constraints import Between, OnCurve
from drake_leg.simulink.dynamics.coordinates import Axis
from drake_leg.simulink.dynamics.welds import Welded
from drake_leg.simulink.multibody.assembly import Assembly
from drake_leg.simulink.multibody.mass import Array
from drake_leg.simulink.multibody.plant import set_posture

CLOSED = 1e-6  # [m, rad], of loops and constraints at the start
ROUNDING = 1e-12  # [m, rad]
FAR = 0.5  # [m, rad], from where loops may close to either side
STEPS = 60
LONGEST = 0.3  # [rad or m], of a step
REDUNDANT = 1e-9  # of the greatest singular value

Level = tuple[Array, Array]  # rows (r, n) and values (r,) of `rows @ v = values`


def start_of(acting: Acting, u: Array | None = None) -> Array:
    """Return the state of the plant at the start; driven axes are at their motions in ``u``.

    Motions and loops come first, then targets of high priority, then those of low priority; what is
    left free is at rest, and where Simscape's guess is, at 0.

    Raises
    ------
    InvalidValueError
        If loops cannot be closed.
    """
    plant = acting.plant
    moment = acting.moment
    context = plant.CreateDefaultContext()
    q, gap = Assembly(acting.mechanism).assembled(_given(acting, u))
    if gap > CLOSED:
        names = ", ".join(repr(joint.block.name) for joint in acting.mechanism.loops[:5])
        raise InvalidValueError(
            f"the loops at {names} stay {gap:.2g} rad or m open at the start: change state targets "
            "or motions that cannot be met together"
        )
    set_posture(plant, context, acting.tree, q)
    state = np.concatenate([plant.GetPositions(context), np.zeros(plant.num_velocities())])
    moment.move_to(state)
    state = _met(acting, state, u)
    state[plant.num_positions() :] = prioritized(_levels(acting, u), plant.num_velocities())
    return state


def unguided_loops(acting: Acting, u: Array | None = None) -> list[str]:
    """Name the joints at which loops close far from 0 while no state target says to which side."""
    given, assembly = _given(acting, u), Assembly(acting.mechanism)
    loops = acting.mechanism.loops
    if not loops or np.delete(assembly.aimed, list(given)).any():
        return []
    moved = np.delete(assembly.assembled(given)[0], list(given))
    return [joint.block.name for joint in loops] if np.abs(moved).max(initial=0.0) > FAR else []


def _met(acting: Acting, state: Array, u: Array | None) -> Array:
    """Return the state nearby in which constraints between frames are met, by Newton's method.

    Driven axes stay at their motions. Targets of high priority move only if there is no other way.
    """
    held = [each for each in acting.constraints if isinstance(each, Between | OnCurve)]
    if not held:
        return state
    found, left = state, _gap(acting, state)
    for firm in (True, False):
        if left <= ROUNDING:
            break
        moved = _newton(acting, state, _kept(acting, u, firm=firm))
        if _gap(acting, moved) < left:
            found, left = moved, _gap(acting, moved)
    if left > CLOSED:
        names = ", ".join(repr(each.block.name) for each in held[:5])
        raise InvalidValueError(
            f"the constraints {names} are {left:.2g} rad or m off at the start: change state "
            "targets or motions that cannot be met together"
        )
    acting.moment.move_to(found)
    return found


def _gap(acting: Acting, state: Array) -> float:
    """Return the greatest gap of what has a gap [rad or m]."""
    return float(np.abs(_gaps(acting, state)[0]).max(initial=0.0))


def _gaps(acting: Acting, state: Array) -> Level:
    """Return the gaps of constraints (r,) [rad or m], and their rates per velocity (r, nv)."""
    moment = acting.moment
    moment.move_to(state)
    with_gap = [each for each in acting.constraints if isinstance(each, Between | OnCurve | Welded)]
    return (
        np.concatenate([each.gap(moment) for each in with_gap]),
        np.vstack([each.jacobian(moment) for each in with_gap]),
    )


def _newton(acting: Acting, state: Array, kept: Array) -> Array:
    """Return the state after steps that close the gaps, along velocities that keep some rows."""
    plant, N = acting.plant, null_space(kept, rcond=REDUNDANT)
    for _ in range(STEPS):
        gap, J = _gaps(acting, state)
        if np.abs(gap).max() <= ROUNDING or not N.shape[1]:
            break
        v = N @ np.linalg.lstsq(J @ N, -gap, rcond=REDUNDANT)[0]
        v *= min(1.0, LONGEST / max(float(np.abs(v).max()), LONGEST))
        q = acting.moment.q + plant.MapVelocityToQDot(acting.moment.context, v)
        state = np.concatenate([_normalized(plant, q), np.zeros(plant.num_velocities())])
    return state


def _normalized(plant: MultibodyPlant, q: Array) -> Array:
    """Return positions whose quaternions have length 1."""
    q = q.copy()
    for index in plant.GetJointIndices():
        joint = plant.get_joint(index)
        if joint.type_name() == QuaternionFloatingJoint.kTypeName:
            first = joint.position_start()
            q[first : first + 4] /= np.linalg.norm(q[first : first + 4])
    return q


def _kept(acting: Acting, u: Array | None, *, firm: bool) -> Array:
    """Return the rows (r, nv) of velocities that stay: of motions, and of firm targets."""
    joints = acting.joints
    driven = {motion.axis for motion in joints.motions} if u is not None else set()
    rows = [joints.S[[axis]] for axis in sorted(driven)]
    for number, coordinate in enumerate(acting.coordinates):
        primitive = coordinate.primitive
        if firm and primitive.firm and primitive.target is not None:
            size = (0.0,) * primitive.positions
            rows.append(_target(acting, size, number)[0])
    return np.vstack([np.zeros((0, acting.plant.num_velocities())), *rows])


def prioritized(levels: Iterable[Level], size: int) -> Array:
    """Return the shortest vector that meets each level as well as those before it allow."""
    v, N = np.zeros(size), np.eye(size)
    for rows, values in levels:
        if not len(values):
            continue
        free = rows @ N
        v = v + N @ np.linalg.lstsq(free, values - rows @ v, rcond=REDUNDANT)[0]
        N = N @ null_space(free, rcond=REDUNDANT)
    return v


def _given(acting: Acting, u: Array | None) -> dict[int, float]:
    """Return the positions of motion-driven axes, by their numbers among all positions."""
    if u is None:
        return {}
    first, places = 0, {}
    for coordinate in acting.coordinates:
        if isinstance(coordinate, Axis):
            places[acting.joints.number[id(coordinate)]] = first
        first += coordinate.primitive.positions
    return {places[m.axis]: float(u[m.entries][0]) for m in acting.joints.motions}


def _levels(acting: Acting, u: Array | None) -> Iterator[Level]:
    """List what velocities have to meet, first what is firmest."""
    joints, nv = acting.joints, acting.plant.num_velocities()
    yield _stacked(((c.jacobian(acting.moment), np.zeros(len(c))) for c in acting.constraints), nv)
    motions = joints.motions if u is not None else []
    driven = {motion.axis for motion in motions}
    yield _stacked(((joints.S[[m.axis]], u[m.entries][1:2]) for m in motions if u is not None), nv)
    for firm in (True, False):
        yield _stacked(
            (
                _target(acting, coordinate.primitive.rate, number)
                for number, coordinate in enumerate(acting.coordinates)
                if coordinate.primitive.rate is not None
                and coordinate.primitive.rate_firm is firm
                and not (isinstance(coordinate, Axis) and joints.number[id(coordinate)] in driven)
            ),
            nv,
        )


def _target(acting: Acting, rate: tuple[float, ...], number: int) -> Level:
    coordinate = acting.coordinates[number]
    if isinstance(coordinate, Axis):
        return coordinate.S[np.newaxis], np.array(rate)
    R_BF = coordinate.rotation(acting.moment.q)
    unit = np.eye(acting.plant.num_velocities())
    return np.column_stack([coordinate.in_base(R_BF, each) for each in unit]), np.array(rate)


def _stacked(levels: Iterable[Level], nv: int) -> Level:
    found = list(levels)
    return (
        np.vstack([np.zeros((0, nv)), *(rows for rows, _ in found)]),
        np.concatenate([np.zeros(0), *(values for _, values in found)]),
    )
