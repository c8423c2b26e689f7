"""Drives a robot that walks, in its simulation, as fast as foresight allows."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property
from threading import Thread
from typing import Literal

import numpy as np
from pydrake.systems.analysis import Simulator
from pydrake.systems.primitives import VectorLogSink

from drake_leg.diagrams.hexapod import HexapodConfig, build_driven, start_walking
from drake_leg.diagrams.wiring import plant_of
from drake_leg.errors import DrakeLegError, InvalidValueError, did_you_mean
from drake_leg.kinematics.khalil import Array
from drake_leg.kinematics.walking.foresight import foresee_walk
from drake_leg.kinematics.walking.gait import GAITS, Gait, usual_period
from drake_leg.kinematics.walking.gaits import Command
from drake_leg.kinematics.walking.live import LiveWalk
from drake_leg.kinematics.walking.live_loads import live_torques
from drake_leg.kinematics.walking.plan import walk_of
from drake_leg.robot.ground import FLAT
from drake_leg.robot.robot import Robot
from drake_leg.robot.servos import IDEAL
from drake_leg.scene.footing import Footing
from drake_leg.scene.walked import foot_forces

State = Literal["free", "near", "slowed", "stopped"]
WAYS = ("forward", "sideways", "turning")
SLOW = 0.01  # [m/s, rad/s], at which foresight begins to look for the greatest speed
USED = 0.95  # of the greatest speed that foresight finds
NARROW = 0.02  # [m], a support margin at which the robot is near its fall
OVERTURNED = math.cos(math.radians(45.0))  # cosine of the tilt of a robot that has fallen
FELL = "the robot has fallen; it stands again with To the start"
FREE = 0.995  # share of the commanded speed from which on the robot counts as free
FINEST = 0.005  # [m], between heights


@dataclass(frozen=True, kw_only=True)
class WalkStep:
    """The result of one step."""

    time: float  # [s], simulated
    positions: Array  # of the shown plant: (7 + 3 n,)
    footing: Footing  # one row
    velocity: Array  # (3,), allowed: forward, sideways, turning [m/s, rad/s]
    share: float | None  # of the commanded velocity, 0 to 1; None at rest
    limit: str  # nearest limit of the legs, in words
    state: State
    sentence: str  # to be shown; empty if nothing is in the way


class DrivenWalk:
    """A robot on level ground, ready to be driven: the diagram of a walk, stepped by a Simulator.

    Its gait is a ``LiveWalk``, its servos are ideal. Foresight finds the greatest speeds of a gait
    at a height along each of the three ways; of a mixture, the shares of these add up to 1 at most.

    Parameters
    ----------
    robot : Robot
        With legs of three joints on a floating body.
    """

    def __init__(self, robot: Robot) -> None:
        walk = walk_of(robot)
        self.robot = robot
        self._config = HexapodConfig(robot=robot, walk=walk, servo=IDEAL)
        self.legs = self._config.legs
        self.height = float(walk.body(0.0).value[2, 3])  # [m], at the start
        self.live = LiveWalk(
            walk.gait,
            period=walk.period,
            neutral=np.asarray(walk.neutral),
            height=self.height,
            step=self._config.time_step,
            torques=live_torques(robot, IDEAL),
        )
        self._diagram = build_driven(self._config, self.live)
        self._plant = plant_of(self._diagram)
        self._instance = self._plant.GetBodyByName(robot.base_name).model_instance()
        self._logs = [one for one in self._diagram.GetSystems() if isinstance(one, VectorLogSink)]
        self._foreseen: dict[tuple[str, float], Array] = {}
        self._refused, self._wished = "", (walk.gait.name, self.height)
        self._search: Thread | None = None
        self.limits = self._foresee(walk.gait, self.height)
        self.restart()

    def restart(self) -> None:
        """Let the robot stand where it began."""
        self.live.reset()
        self._simulator = Simulator(self._diagram)
        self._root = self._simulator.get_mutable_context()
        start_walking(self._config)(self._diagram, self._root)
        self._simulator.Initialize()
        self._steps, self._asked, self._fallen = 0, 0.0, False
        self._stood = np.ones((1, self.legs.count), dtype=bool)  # of the last step
        self.limits = self._foresee(self.live.gait, self.height)
        self._refused, self._wished = "", (self.live.gait.name, self.height)

    # --- gait and height ---

    def wish(self, gait: str, height: float) -> None:
        """Ask for a gait by its name and a height [m]; it comes when foresight knows its speeds."""
        if gait not in GAITS:
            raise InvalidValueError(
                f"there is no gait {gait!r}; the gaits are {', '.join(GAITS)}",
                advice=did_you_mean(gait, GAITS),
            )
        height = round(height / FINEST) * FINEST if height != self.height else height
        if (gait, height) == self._wished:
            return
        if (gait, height) in self._foreseen:
            self._take(GAITS[gait], height)
        elif self._search is None or not self._search.is_alive():
            self._search = Thread(target=self._look, args=(GAITS[gait], height), daemon=True)
            self._search.start()

    def _look(self, gait: Gait, height: float) -> None:
        try:
            self._foresee(gait, height)
        except DrakeLegError as error:
            self._refused = str(error)
            self._foreseen[gait.name, height] = np.zeros(3)

    def _take(self, gait: Gait, height: float) -> None:
        speeds = self._foreseen[gait.name, height]
        self._wished = gait.name, height
        if not speeds.all():
            self._refused = self._refused or f"{gait.name} does not work at {1e3 * height:.0f} mm"
            return
        self._refused = ""
        self.live.change_gait(gait, usual_period(gait))
        self.live.height = height
        self.limits = speeds

    def _foresee(self, gait: Gait, height: float) -> Array:
        """Greatest speeds along the three ways, (3,) [m/s, rad/s]."""
        key = (gait.name, height)
        if key not in self._foreseen:
            period, speeds = usual_period(gait), []
            for way in WAYS:
                command = Command(**{way: SLOW}, start=period)
                walk = walk_of(self.robot, gait, period=period, height=height, commands=(command,))
                found = foresee_walk(self.robot, walk, IDEAL, duration=2.0 * period)
                speeds.append(USED * SLOW * found.greatest_scale)
            self._foreseen[key] = np.array(speeds)
        return self._foreseen[key]

    # --- steps ---

    def step(self, velocity: Array, duration: float) -> WalkStep:
        """Command forward, sideways, turning, (3,) [m/s, rad/s], and go on for a time [s]."""
        asked = float((np.abs(velocity) / np.maximum(self.limits, 1e-9)).sum())
        share = min(1.0, 1.0 / asked) if asked > 0.0 else None
        self.live.command = velocity * (share or 0.0)
        if not self._fallen:
            self._asked += duration
            self._steps = math.floor(self._asked / self.live.step + 1e-9)
            self._simulator.AdvanceTo(self._steps * self.live.step)
            for log in self._logs:
                log.FindMutableLog(self._root).Clear()
        return self._seen(share)

    def _seen(self, share: float | None) -> WalkStep:
        context = self._plant.GetMyContextFromRoot(self._root)
        positions = self._plant.GetPositions(context, self._instance)
        body, q = positions[:7], positions[7:]
        port = self._plant.get_generalized_contact_forces_output_port(self._instance)
        torques = port.Eval(context)[np.newaxis, 6:]
        forces = foot_forces(self.legs, body[np.newaxis], q[np.newaxis], torques)
        time = self._steps * self.live.step
        footing = Footing.of(
            self.robot, np.array([time]), body[np.newaxis], q[np.newaxis], forces, FLAT
        )
        # The contact of a foot that has just touched down may open again for a moment.
        stands = footing.stands
        footing, self._stood = replace(footing, stands=stands | self._stood), stands
        x, y = body[1:3]
        self._fallen = self._fallen or 1.0 - 2.0 * (x * x + y * y) < OVERTURNED
        state, sentence = self._guard(share, float(footing.margins[0]))
        return WalkStep(
            time=time,
            positions=positions,
            footing=footing,
            velocity=self.live.now.velocity,
            share=share,
            limit=self._nearest_limit(q.reshape(-1, 3)),
            state=state,
            sentence=sentence,
        )

    def _guard(self, share: float | None, margin: float) -> tuple[State, str]:
        if self._fallen:
            return "stopped", FELL
        if self._refused:
            return "near", self._refused
        if self._search is not None and self._search.is_alive():
            return "near", "foresight looks for the speeds of that gait and height"
        if self.live.is_changing:
            return "near", "the robot stops for another gait"
        if share is not None and share < FREE:
            return "slowed", f"faster than foresight allows: at most {self.in_words(self.limits)}"
        if margin < NARROW:
            return "near", "the center of mass is near the edge of the support"
        return "free", ""

    @staticmethod
    def in_words(speeds: Array) -> str:
        """Say speeds along the three ways."""
        forward, sideways, turning = speeds.tolist()
        return (
            f"{1e3 * forward:.0f} mm/s forward, {1e3 * sideways:.0f} mm/s sideways, "
            f"{math.degrees(turning):.0f} deg/s"
        )

    @cached_property
    def _names(self) -> list[str]:
        return [name.replace("_", " ") for leg in self.legs.joint_names for name in leg]

    def _nearest_limit(self, q: Array) -> str:
        low, high = self.legs.limits[..., 0], self.legs.limits[..., 1]
        room = np.minimum(q - low, high - q).ravel()
        nearest = int(room.argmin())
        if math.isfinite(room[nearest]):
            return f"{math.degrees(room[nearest]):.0f}° to the limit of {self._names[nearest]}"
        sigmas = self.legs.sigma_mins(q)
        leg = self.legs.names[int(sigmas.argmin())].replace("_", " ")
        return f"σ min {1e3 * float(sigmas.min()):.0f} mm, {leg}"
