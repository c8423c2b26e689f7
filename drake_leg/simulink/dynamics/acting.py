"""All that acts on a mechanism and senses it, gathered from the blocks of its model."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.dynamics.applied import Applied, LawOfContact
from drake_leg.simulink.dynamics.coordinates import Axis, coordinates_of
from drake_leg.simulink.dynamics.crossing import Crossing, sensed_of_crossing
from drake_leg.simulink.dynamics.inertia_sensing import InertiaSensor
from drake_leg.simulink.dynamics.joints import Joints
from drake_leg.simulink.dynamics.masses import reflect, rotors
from drake_leg.simulink.dynamics.moment import Moment, Place, Places
from drake_leg.simulink.dynamics.opening import opened, with_acting
from drake_leg.simulink.dynamics.ports import Layout
from drake_leg.simulink.dynamics.relative import sensed_of_joint, sensed_of_transform
from drake_leg.simulink.dynamics.sensing import (
    Ports,
    Quantity,
    Response,
    sensed_of_axis,
    sensed_of_ball,
)
from drake_leg.simulink.dynamics.solver import Constraint, Solution, Solver
from drake_leg.simulink.dynamics.welds import Welded
from drake_leg.simulink.dynamics.wrenches import Wrenches
from drake_leg.simulink.mechanism import network_of
from drake_leg.simulink.model import Block, Model, split_port
from drake_leg.simulink.multibody.bodies import Mechanism
from drake_leg.simulink.multibody.mass import Array
from drake_leg.simulink.multibody.meshes import FileMeshes
from drake_leg.simulink.multibody.plant import mechanism_plant
from drake_leg.simulink.networks.reflection import Reflected
from drake_leg.simulink.wiring import physical_part

T = TypeVar("T")
Law = Callable[[T], float | Array]


class Acting:
    """The plant of a mechanism without loops, what acts on it, and what is sensed of it."""

    def __init__(
        self,
        model: Model,
        mechanism: Mechanism,
        *,
        where: Sequence[Path] = (),
        contact: LawOfContact = "smooth",
        reflected: Sequence[Reflected] = (),
    ) -> None:
        self.problems: list[str] = []
        self.contact = contact
        self.network = network_of(physical_part(model))
        mechanism = with_acting(mechanism)
        self.tree, welds = opened(mechanism)
        self.plant = mechanism_plant(self.tree)
        self.inputs, self.sensed, self.efforts = Layout(), Layout(), Layout()
        self.coordinates = coordinates_of(self.tree, self.plant)
        nq, nv = self.plant.num_positions(), self.plant.num_velocities()
        self.joints = Joints(self.coordinates, self.inputs, nq, nv)
        self.problems += self.joints.problems
        self.problems += reflect(self.plant, self.joints, self.inputs, reflected)
        self._rotors = self._attempt(np.zeros(len(self.joints.motions)), rotors)
        self.moment = Moment(self.tree, self.plant)
        self.constraints: list[Constraint] = [Welded(weld) for weld in welds]
        self.mechanism, self._places = mechanism, Places(mechanism)
        self.applied = Applied(
            self.network,
            mechanism,
            self._places,
            self.moment,
            self.inputs,
            files=FileMeshes(where),
            contact=contact,
        )
        self.problems += self.applied.problems
        self.constraints += self.applied.constraints
        self._solver = Solver(self.joints, self.constraints, self._rotors, nv)
        self.left_out: Mapping[str, tuple[str, ...]] = {
            kind: tuple(names) for kind, names in self.applied.left_out.items()
        }
        self._wired = {port for node in self.network.signals for port in node}
        self.problems += [
            f"the block {block.name!r} (SID {block.sid}) takes its mode from an input, which does "
            "not run: set its mode to Normal"
            for block in self.network.blocks.values()
            if block.kind.endswith("Joint")
            and block.parameters.get("JointMode") == "ProvidedByInput"
        ]
        self._add_sensing()
        self._require_felt(reflected)

    def _require_felt(self, reflected: Iterable[Reflected]) -> None:
        """Refuse inertias at one joint that follow the velocity of another one."""
        axes, nq = {entry: axis for axis, entry in self.joints.forced}, self.plant.num_positions()
        for one in reflected:
            if one.driven not in self.inputs.slices or one.sensed not in self.sensed.slices:
                continue
            axis = axes.get(self.inputs.slices[one.driven].start)
            row = self._linear[self.sensed.slices[one.sensed].start, nq:]
            if axis is not None and not np.array_equal(row, self.joints.S[axis]):
                self.problems.append(
                    f"a network that follows {one.sensed} adds an inertia at {one.driven}: let it "
                    "follow the velocity of the same axis"
                )

    def _attempt(self, otherwise: Array, work: Callable[..., Array]) -> Array:
        try:
            carriers = sum(body.properties.carrier for body in self.tree.bodies)
            return work(self.plant, self.joints, self.coordinates, carriers)
        except InvalidValueError as error:
            self.problems.append(str(error))
            return otherwise

    def require_finite(self, u: Array) -> None:
        """Refuse inputs that are not finite, as Drake ends Python at such positions."""
        if math.isfinite(u.sum()) or np.isfinite(u).all():
            return
        blocks = self.network.blocks
        names = [
            f"{blocks[split_port(port)[0]].name!r} ({port})"
            for port, entries in self.inputs.slices.items()
            if not np.isfinite(u[entries]).all()
        ]
        raise InvalidValueError(f"what enters the mechanism at {', '.join(names)} is not finite")

    # --- what is sensed ----------------------------------------------------------------------

    def sense(self, state: Array) -> Array:
        """Return what depends on the state alone, at the moment of that state."""
        return self._sensed(state, self._of_state)

    def sense_now(self, state: Array) -> Array:
        """Return what depends on the state alone, as `sense`, but only what is read at once."""
        return self._sensed(state, self._now)

    @property
    def reads_places(self) -> bool:
        """Whether what is read at once is more than positions and velocities of joints."""
        return bool(self._now)

    @property
    def sensing(self) -> NDArray[np.bool_]:
        """Which entries of what is read at once may depend on which entries of the state."""
        found: NDArray[np.bool_] = self._linear != 0.0
        for entries, _ in self._now:
            found[entries] = True
        return found

    def read_at_once(self, ports: frozenset[str]) -> None:
        """Say which ports are read while the mechanism moves; others are only shown."""
        starts = {self.sensed.slices[port].start for port in ports if port in self.sensed.slices}
        self._now = [(entries, law) for entries, law in self._of_state if entries.start in starts]

    def _sensed(
        self, state: Array, laws: Iterable[tuple[slice, Callable[[Moment], float | Array]]]
    ) -> Array:
        out: Array = self._linear @ state + self._offset
        for entries, law in laws:
            out[entries] = law(self.moment)
        return out

    def respond(self, u: Array, vdot: Array) -> Array:
        """Return what depends on the inputs, too."""
        out = np.zeros(self.efforts.size)
        if not len(out):
            return out
        solution = self.solved(u)
        response = Response(
            moment=self.moment,
            u=u,
            vdot=vdot,
            driving=solution.driving,
            wrenches=self._wrenches(u, solution.multipliers) if self._carries else {},
        )
        for entries, law in self._of_response:
            out[entries] = law(response)
        return out

    def accelerations(self, u: Array) -> Array:
        """Return the accelerations (nv,) of the plant at the moment's state."""
        moment = self.moment
        force = self.solved(u).force
        held = moment.unforced(np.zeros(len(force)))
        vdot: Array = np.asarray(np.linalg.solve(moment.mass_matrix, force - held), dtype=float)
        return vdot

    def _add_sensing(self) -> None:
        self._carries = False  # whether a joint puts out what it carries
        self._of_state: list[tuple[slice, Callable[[Moment], float | Array]]] = []
        self._of_response: list[tuple[slice, Callable[[Response], float | Array]]] = []
        linear: list[tuple[slice, Array, float]] = []
        for quantity in self._quantities():
            if quantity.port not in self._wired and not quantity.bus:
                continue
            if quantity.of_response is not None:
                entries = self.efforts.add(quantity.port, quantity.shape)
                self._of_response.append((entries, _flat(quantity.of_response, quantity.shape)))
                continue
            entries = self.sensed.add(quantity.port, quantity.shape)
            if quantity.bus:
                self.sensed.buses[quantity.port] = quantity.bus
            if quantity.linear is not None:
                linear.append((entries, *quantity.linear))
            elif quantity.of_state is not None:
                self._of_state.append((entries, _flat(quantity.of_state, quantity.shape)))
        self._now = self._of_state
        self._linear = np.zeros((self.sensed.size, self.plant.num_multibody_states()))
        self._offset = np.zeros(self.sensed.size)
        for entries, row, offset in linear:
            self._linear[entries], self._offset[entries] = row, offset

    def _quantities(self) -> Iterable[Quantity]:
        ports: dict[str, Ports] = {}
        crossing = Crossing(self.tree, np.array(self.mechanism.connections.gravity))
        for coordinate in self.coordinates:
            block = coordinate.joint.block
            own = ports.setdefault(block.sid, Ports(block))
            if isinstance(coordinate, Axis):
                yield from sensed_of_axis(self.joints, coordinate, own)
            else:
                yield from sensed_of_ball(self.joints, coordinate, own)
        for joint in self.tree.joints:
            own_ones = [each for each in self.coordinates if each.joint is joint]
            own = ports.setdefault(joint.block.sid, Ports(joint.block))
            found = list(sensed_of_crossing(joint, own_ones, crossing, own))
            self._carries = self._carries or bool(found)
            yield from found
        for joint in self.mechanism.sensors:
            base = Place(body=joint.base, X_BF=joint.X_PB)
            follower = Place(body=joint.follower, X_BF=joint.X_CF)
            yield from sensed_of_joint(joint, base, follower, Ports(joint.block))
        for block in self.network.blocks.values():
            if block.kind == "Transform Sensor" and block.source.startswith("sm_lib/"):
                yield from self._of_transform_sensor(block)
            if block.kind == "Inertia Sensor" and block.sid in self.network.sensed:
                yield from self._of_inertia_sensor(block)
        yield from self.applied.quantities

    def _of_transform_sensor(self, block: Block) -> list[Quantity]:
        places = [self._places.at(frame) for frame in self.network.ends(block)]
        base, follower = places
        if block.sid not in self.network.sensed:
            return []
        if base is None or follower is None:
            self.problems.append(
                f"the block {block.name!r} (SID {block.sid}) has a frame that is on no body and "
                "not on the world: connect both of its frames"
            )
            return []
        try:
            return sensed_of_transform(block, base, follower, Ports(block))
        except InvalidValueError as error:
            self.problems.append(str(error))
            return []

    def _of_inertia_sensor(self, block: Block) -> list[Quantity]:
        try:
            sensor = InertiaSensor(block, self.network, self.mechanism, self._places)
        except InvalidValueError as error:
            self.problems.append(str(error))
            return []
        return list(sensor.quantities())

    def _wrenches(self, u: Array, multipliers: Array) -> Mapping[int, Array]:
        """Return the wrenches of forces and constraints on bodies."""
        wrenches = Wrenches(self.applied.wrenches(self.moment, u))
        first = 0
        for constraint in self.constraints:
            last = first + len(constraint)
            constraint.act(self.moment, multipliers[first:last], wrenches)
            first = last
        return wrenches.by_body

    # --- what acts ---------------------------------------------------------------------------

    def solved(self, u: Array) -> Solution:
        """Return the forces on the plant at the moment's state, once for equal inputs."""
        key = u.tobytes()
        found = self.moment.memo.get(key)
        if not isinstance(found, Solution):
            moment = self.moment
            force = self.joints.internal(moment) + self.joints.actuation(moment, u)
            if not self.applied.is_idle:
                force += self.applied.generalized(moment, u)
            found = self.moment.memo[key] = self._solver.solve(moment, force, u)
        return found


def _flat(
    law: Callable[[T], float | Array], shape: tuple[int, ...]
) -> Callable[[T], float | Array]:
    """Return a law whose matrix is a vector, row after row."""
    return law if len(shape) < 2 else lambda at: np.ravel(law(at))
