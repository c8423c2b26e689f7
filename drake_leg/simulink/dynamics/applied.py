"""Gathers the forces of a model's blocks, and what they sense."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Literal, TypeVar

import numpy as np

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.dynamics.constraints import Distance, OnCurve, angle_of
from drake_leg.simulink.dynamics.contact import Contact, ContactLaw, Side
from drake_leg.simulink.dynamics.contact_sensing import MEASURES, sensed_of_contact
from drake_leg.simulink.dynamics.curves import curve_of
from drake_leg.simulink.dynamics.drake_contact import DrakeContact
from drake_leg.simulink.dynamics.forces import (
    ExternalForce,
    Field,
    Gravity,
    InputForce,
    InternalForce,
    InverseSquare,
    SpringDamper,
    StateForce,
    Weights,
)
from drake_leg.simulink.dynamics.gears import gear_of
from drake_leg.simulink.dynamics.given_contact import BY_INPUT, GivenContact, is_given
from drake_leg.simulink.dynamics.moment import Moment, Place, Places
from drake_leg.simulink.dynamics.ports import Layout
from drake_leg.simulink.dynamics.sensing import Ports, Quantity
from drake_leg.simulink.dynamics.shapes import (
    Ground,
    Plane,
    Points,
    Rim,
    corners_of,
    surface_of,
)
from drake_leg.simulink.dynamics.solver import Constraint
from drake_leg.simulink.dynamics.sphere_forces import SPHERE_FORCES, SphereForce
from drake_leg.simulink.dynamics.wrenches import Wrenches
from drake_leg.simulink.mechanism import BASE, FOLLOWER, Frame, PhysicalNetwork
from drake_leg.simulink.model import Block, invalid_parameter, is_on, number, split_port, vector
from drake_leg.simulink.multibody.bodies import Mechanism
from drake_leg.simulink.multibody.connections import CONSTRAINTS, FORCES, is_multibody
from drake_leg.simulink.multibody.mass import Array
from drake_leg.simulink.multibody.meshes import FileMeshes
from drake_leg.simulink.multibody.solids import Solid

T = TypeVar("T")
LawOfContact = Literal["smooth", "pulling", "drake"]

GEARS = (
    "Common Gear Constraint", "Bevel Gear Constraint", "Rack and Pinion Constraint",
    "Worm and Gear Constraint",
)  # fmt: skip
HELD: Mapping[str, Callable[[Block, Place, Place], Constraint]] = {
    "Distance Constraint": Distance,
    "Angle Constraint": angle_of,
}
ON_CURVE = "Point on Curve Constraint"
CONTACT = "Spatial Contact Force"


class Applied:
    """The forces between bodies, and on them."""

    def __init__(
        self,
        network: PhysicalNetwork,
        mechanism: Mechanism,
        places: Places,
        moment: Moment,
        inputs: Layout,
        *,
        files: FileMeshes,
        contact: LawOfContact = "smooth",
    ) -> None:
        self.problems: list[str] = []
        self.left_out: dict[str, list[str]] = {}
        self.quantities: list[Quantity] = []
        self.constraints: list[Constraint] = []
        self._of_state: list[StateForce] = []
        self._of_input: list[InputForce] = []
        self._network, self._places, self._inputs = network, places, inputs
        self._law_of_contact = contact
        self._files, self._weights = files, Weights(moment)
        self._solids = {
            solid.block.sid: (solid, Place(body=number_, X_BF=X_BR))
            for number_, body in enumerate(mechanism.bodies)
            for solid, X_BR in body.solids
        }
        self._touching = {port: node for node in network.geometries for port in node}
        for block in network.blocks.values():
            if is_multibody(block):
                try:
                    self._add(block)
                except InvalidValueError as error:
                    self.problems.append(str(error))

    @property
    def touches(self) -> bool:
        """Whether two bodies may touch."""
        return any(isinstance(force, Contact | SphereForce) for force in self._of_state)

    @property
    def is_idle(self) -> bool:
        """Whether no force acts."""
        return not (self._of_state or self._of_input)

    def generalized(self, moment: Moment, u: Array) -> Array:
        """Return the generalized forces of all forces, (nv,)."""
        wrenches = Wrenches(self.of_state(moment))
        for force in self._of_input:
            force.act(moment, u, wrenches)
        return moment.generalized(wrenches.by_body)

    def of_state(self, moment: Moment) -> dict[int, Array]:
        """Return the wrenches of forces that depend on the state alone, once for a state."""
        found = moment.memo.get(self)
        if not isinstance(found, dict):
            wrenches = Wrenches()
            for force in self._of_state:
                force.act(moment, wrenches)
            found = moment.memo[self] = wrenches.by_body
        return found

    def wrenches(self, moment: Moment, u: Array) -> dict[int, Array]:
        """Return the wrenches on bodies."""
        wrenches = Wrenches(self.of_state(moment))
        for force in self._of_input:
            force.act(moment, u, wrenches)
        return wrenches.by_body

    # --- blocks ------------------------------------------------------------------------------

    def _add(self, block: Block) -> None:
        kind = block.kind
        if kind == "External Force and Torque":
            self._of_input += [
                ExternalForce(block, place, self._inputs) for place in self._frames(block, FOLLOWER)
            ]
        elif kind == "Gravitational Field":
            self._of_state += [
                Field(block, place, self._weights)
                for port in self._network.ports.get(block.sid, ())[:1]
                for place in self._frames(block, port.partition("#")[2])
            ]
        elif kind == "Mechanism Configuration":
            if block.parameters.get("UniformGravity") == "TimeVarying":
                self._of_input.append(Gravity(block, self._weights, self._inputs))
        elif kind in ("Internal Force", "Spring and Damper Force", "Inverse Square Law Force"):
            self._add_pair(block)
        elif kind == CONTACT:
            self._add_contact(block)
        elif kind in SPHERE_FORCES:
            self._add_sphere_force(block)
        elif kind in GEARS:
            places = self._frames(block, BASE, FOLLOWER)
            self.constraints += [gear_of(block, *places)] if places else []
        elif kind in HELD:
            places = self._frames(block, BASE, FOLLOWER)
            self.constraints += [HELD[kind](block, *places)] if places else []
        elif kind == ON_CURVE:
            self._add_on_curve(block)
        elif kind in (*FORCES, *CONSTRAINTS):
            self._leave_out(block)

    def _leave_out(self, block: Block) -> None:
        self.left_out.setdefault(block.kind, []).append(block.name)

    def _frames(self, block: Block, *sides: str) -> list[Place]:
        """Return the places of a block's frames; none where one is not on a body."""
        frames: list[Frame] = [self._network.frame(f"{block.sid}#{side}") for side in sides]
        found = [self._places.at(frame) for frame in frames]
        if any(place is None for place in found):
            self._leave_out(block)
            return []
        return [place for place in found if place is not None]

    def _add_on_curve(self, block: Block) -> None:
        """Add the constraint of a point on a Spline."""
        ends = self._touching.get(f"{block.sid}#{BASE}", ())
        others = (self._network.blocks[split_port(end)[0]] for end in ends)
        curves = [other for other in others if other.kind == "Spline"]
        if not curves:
            self._leave_out(block)
            return
        base = self._places.at(self._network.frame(f"{curves[0].sid}#{BASE}"))
        follower = self._places.at(self._network.frame(f"{block.sid}#{FOLLOWER}"))
        if base is None or follower is None:
            self._leave_out(block)
            return
        self.constraints.append(OnCurve(block, base, follower, curve_of(curves[0])))

    def _add_pair(self, block: Block) -> None:
        places = self._frames(block, BASE, FOLLOWER)
        if not places:
            return
        base, follower = places
        if block.kind == "Internal Force":
            self._of_input.append(InternalForce(block, base, follower, self._inputs))
            return
        law = SpringDamper if block.kind == "Spring and Damper Force" else InverseSquare
        pair = law(block, base, follower)
        self._of_state.append(pair)
        self.quantities.append(Quantity(port=Ports(block).next(), of_state=pair.force))

    def _add_sphere_force(self, block: Block) -> None:
        places = self._frames(block, BASE, FOLLOWER)
        if places:
            follower, base = places
            force = SPHERE_FORCES[block.kind](block, base, follower)
            self._of_state.append(force)
            self.quantities.append(force.quantity(block))

    # --- contact -----------------------------------------------------------------------------

    def _add_contact(self, block: Block) -> None:
        sides = [self._side(block, port) for port in (BASE, FOLLOWER)]
        base, follower = sides
        if base is None or follower is None:
            self._leave_out(block)
            return
        measures = any(is_on(block, switch) for switch in MEASURES)
        given = is_given(block)
        touch = DrakeContact if self._law_of_contact == "drake" and not given else Contact
        law = self._law(block)
        contact = _of(block, touch, base, follower, law, measures=measures)
        if not contact.pairs:
            raise InvalidValueError(
                f"the block {block.name!r} (SID {block.sid}) lets two geometries touch of which "
                "none has an inside: connect a solid, a plane or a grid at one side"
            )
        self._of_state.append(contact)
        if given:
            self._of_input.append(GivenContact(block, contact, law, self._inputs))
        self.quantities += sensed_of_contact(block, contact)

    def _law(self, block: Block) -> ContactLaw:
        for name, known in (
            ("NormalForceType", ("SmoothSpringDamper", BY_INPUT)),
            ("FrictionType", ("SmoothStickSlip", "None", BY_INPUT)),
        ):
            if block.parameters.get(name, known[0]) not in known:
                raise invalid_parameter(block, name, f"it must be {' or '.join(known)}")
        get = block.parameters.get
        slips = get("FrictionType", "SmoothStickSlip") == "SmoothStickSlip"
        pushes = get("NormalForceType") != BY_INPUT
        width = number(get("NormalTransitionRegionWidth"))
        critical = number(get("FrictionalCriticalVelocity"))
        for name, value in (
            ("NormalTransitionRegionWidth", width),
            ("FrictionalCriticalVelocity", critical),
        ):
            if not value > 0.0:
                raise invalid_parameter(block, name, "it must be a positive number")
        return ContactLaw(
            stiffness=number(get("NormalStiffness")) if pushes else 0.0,
            damping=number(get("NormalDamping")) if pushes else 0.0,
            width=width,
            static=number(get("CoefficientOfStaticFriction")) if slips else 0.0,
            dynamic=number(get("CoefficientOfDynamicFriction")) if slips else 0.0,
            critical=critical,
            pulls=self._law_of_contact == "pulling",
        )

    def _side(self, contact: Block, port: str) -> Side | None:
        """Return the geometry at a port of a contact; None where none is connected."""
        node = self._touching.get(f"{contact.sid}#{port}", ())
        blocks = (self._network.blocks[split_port(end)[0]] for end in node)
        others = [block for block in blocks if block.kind != CONTACT]
        return self._geometry(others[0], contact) if others else None

    def _of_solid(self, solid: Solid, place: Place, contact: Block) -> Side | None:
        shape = solid.shape
        if shape is None:
            raise InvalidValueError(
                f"the block {contact.name!r} (SID {contact.sid}) lets {solid.block.name!r} touch, "
                "which has no geometry: connect a solid"
            )
        surface = _of(solid.block, surface_of, shape, self._files)
        if surface is None:
            return None
        return Side(place=place, surface=surface, corners=corners_of(surface))

    def _geometry(self, block: Block, contact: Block) -> Side | None:
        if block.sid in self._solids:
            solid, place = self._solids[block.sid]
            return self._of_solid(solid, place, contact)
        place_ = self._places.at(self._network.frame(f"{block.sid}#{BASE}"))
        if place_ is None:
            return None
        if block.kind == "Infinite Plane":
            return Side(place=place_, surface=Plane(), corners=None)
        if block.kind == "Point":
            return Side(place=place_, surface=None, corners=Points(points=np.zeros((1, 3))))
        if block.kind == "Disk":
            radius = number(block.parameters.get("Radius"))
            if not radius > 0.0:
                raise invalid_parameter(block, "Radius", "it must be a positive number")
            return Side(place=place_, surface=None, corners=Rim(rim=radius))
        if block.kind == "Point Cloud":
            points = np.array(block.parameters.get("CoordinatesMatrix"), dtype=float)
            if points.ndim != 2 or points.shape[1] != 3:
                raise invalid_parameter(block, "CoordinatesMatrix", "it must be points, n x 3")
            return Side(place=place_, surface=None, corners=Points(points=points))
        if block.kind == "Grid Surface":
            x, y = (np.array(vector(block.parameters.get(f"{axis}GridVector"))) for axis in "XY")
            heights = np.array(block.parameters.get("ZHeights"), dtype=float)
            return Side(place=place_, surface=_of(block, Ground, x, y, heights), corners=None)
        raise InvalidValueError(
            f"the block {contact.name!r} (SID {contact.sid}) lets a {block.kind} touch, which is "
            "not supported: use a solid, an Infinite Plane, a Point Cloud or a Grid Surface"
        )


def _of(block: Block, make: Callable[..., T], *arguments: object, **more: object) -> T:
    """Make a surface or a contact, and say of which block an error speaks."""
    try:
        return make(*arguments, **more)
    except InvalidValueError as error:
        raise InvalidValueError(
            f"the block {block.name!r} (SID {block.sid}): {error.problem}", advice=error.advice
        ) from None
