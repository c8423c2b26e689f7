"""From a robot's Khalil table to a verified, simulated, shown model, on Drake.

A pendulum, the leg of a six-legged robot and a SCARA arm, or a robot of your own: its Khalil
(modified Denavit-Hartenberg) table becomes a Drake plant; blocks named as in Simulink move it; and
every number is compared with its exact value. What follows is all that most people need. Each name
has its own help with an example: ``help(drake_leg.simulate)``. Wrong values are refused in a
sentence that says what to do, as a ``drake_leg.errors.DrakeLegError``.

A step of the leg, its foot 140 mm forward and back, in ten lines::

    from math import radians
    from drake_leg import HexabotLegConfig, SineStep, block_diagram, build_hexabot_leg, simulate

    q0 = (radians(90), radians(-50), radians(-90))  # hip, knee, ankle
    config = HexabotLegConfig(q0=q0, motion=SineStep(amplitude=0.070))  # of leg B
    diagram = build_hexabot_leg(config)  # a Drake Diagram
    block_diagram(diagram).write("step.svg")  # its picture, as Simulink would draw it
    result = simulate(diagram, duration=20.0)
    print(result.scopes["foot positions"][-1])  # [m]

Or the same as a named run, compared with the exact motion: ``run("leg-b").figures["step"]``.

**Robots** (lengths in m, angles in rad)

- ``PENDULUM``, ``LEG_A``, ``LEG_B``, ``SCARA``: the robots of the two reports, each a ``Robot``.
- ``HEXABOT``: a body with six of report B's legs, one table of 24 rows.
- ``Robot``: a robot as data, one segment for each row of its table, which may have branches.
- ``load_robot``: a robot from a TOML file or a ``.par`` file of SYMORO.
- ``build_plant``: a robot as Drake's ``MultibodyPlant``.
- ``prove``: compare a robot's foot and Jacobian by its chain, SymPy, Drake and differences.
- ``examine_posture``: a posture's rank, nearest singularity, strokes and inverse kinematics.
- ``inverse_geometry``: all postures for a pose of the foot, in closed form where there is one.
- ``derive``: a robot's transforms, Jacobian and singularities in symbols.

**Diagrams** (Drake's, wired as in Simulink; each has a configuration)

- ``build_pendulum``, ``PendulumConfig``: a pendulum released from rest.
- ``build_hexabot_leg``, ``HexabotLegConfig``: a straight step of the leg, or of any chain.
- ``build_kinematic_loop``: the leg's or the SCARA's joints without their plant, as one block.
- ``build_ellipse``, ``EllipseConfig``: the leg's foot on an ellipse.
- ``build_scara``, ``ScaraConfig``: the SCARA's tool on a straight line.
- ``SineStep``, ``EllipticStep``: the motion of a foot or a tool.

**Blocks**, for diagrams of your own

- ``InverseJacobian``: joint velocities for a commanded velocity of the foot.
- ``movable``: a robot whose foot can be commanded; what an ``InverseJacobian`` inverts.
- ``PrescribedMotion``: the torques that make joints follow a motion.
- ``FrameSensor``: where a frame is and how it moves.
- ``DriftCorrection``: a commanded velocity, pulled back to where it should have led.
- ``InputFilter``: a signal smoothed until it has derivatives.
- ``JointStops``: joint limits that push back.
- ``EnergySensor``: the mechanical energy of a plant.
- ``add_scope``: record a signal at every time step.

**Simulation**

- ``simulate``: run a diagram and collect its scopes; stops before a singularity.
- ``run``: carry out a named run and compare it with its exact motion.
- ``gradient``: the derivatives of a run's result by its options, through the run.
- ``sweep``: carry out many runs, over grids or samples of whatever a run takes.
- ``Recording``: named columns with units, to CSV; ``Recording.read_csv`` reads one back.

**Pictures** (a notebook shows them)

- ``block_diagram``: any Drake diagram as an SVG block diagram.
- ``frames_drawing``: a robot with its frames, lengths and forces.
- ``still``: a robot, or any plant, in 3D, as a picture.
- ``replay``: a recorded motion in 3D, as a page that plays it.
- ``write_video``: the same as an MP4 or GIF.
- ``view``: a robot, or any plant, in the browser, with a slider for every joint.

**The two reports**

- ``report``: all their figures, tables and equations on one page.
- ``errata``: their errors: what is printed, what is right, and the effect in numbers.

Names are loaded when they are used, so that ``import drake_leg`` is quick and needs no Drake. In a
notebook, robots, diagnoses, proofs, equations, recordings, results and Drake diagrams show
themselves.
"""

from __future__ import annotations

import sys
from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pydrake.systems.framework import Diagram

    from drake_leg.diagrams import ellipse as _ellipse
    from drake_leg.diagrams import hexabot_leg as _hexabot_leg
    from drake_leg.diagrams import kinematic_loop as _kinematic_loop
    from drake_leg.diagrams import pendulum as _pendulum
    from drake_leg.diagrams import scara as _scara
    from drake_leg.diagrams.ellipse import EllipseConfig as EllipseConfig
    from drake_leg.diagrams.hexabot_leg import HexabotLegConfig as HexabotLegConfig
    from drake_leg.diagrams.mechanism import add_scope as add_scope
    from drake_leg.diagrams.pendulum import PendulumConfig as PendulumConfig
    from drake_leg.diagrams.scara import ScaraConfig as ScaraConfig
    from drake_leg.kinematics.chain import movable as movable
    from drake_leg.kinematics.inverse.geometry import inverse_geometry as inverse_geometry
    from drake_leg.kinematics.motions import EllipticStep as EllipticStep
    from drake_leg.kinematics.motions import SineStep as SineStep
    from drake_leg.lab.shown import errata as errata
    from drake_leg.lab.shown import report as report
    from drake_leg.models.plant import build_plant as build_plant
    from drake_leg.models.proof import prove as prove
    from drake_leg.pictures.block_diagram import block_diagram as block_diagram
    from drake_leg.pictures.plots import free_body as _free_body
    from drake_leg.robot.hexapods import HEXABOT as HEXABOT
    from drake_leg.robot.robot import Robot as Robot
    from drake_leg.robot.robot_file import load_robot as load_robot
    from drake_leg.robot.robots import LEG_A as LEG_A
    from drake_leg.robot.robots import LEG_B as LEG_B
    from drake_leg.robot.robots import PENDULUM as PENDULUM
    from drake_leg.robot.robots import SCARA as SCARA
    from drake_leg.runs.named import run as run
    from drake_leg.scene.media import still as still
    from drake_leg.scene.media import write_video as write_video
    from drake_leg.scene.replays import replay as replay
    from drake_leg.scene.viewer import view as view
    from drake_leg.simulation.recording import Recording as Recording
    from drake_leg.simulation.run import simulate as simulate
    from drake_leg.singularity.doctor import examine_posture as examine_posture
    from drake_leg.studies.gradient import gradient as gradient
    from drake_leg.studies.sweep import sweep as sweep
    from drake_leg.symbolic.catalogue import derive as derive
    from drake_leg.systems.drift_correction import DriftCorrection as DriftCorrection
    from drake_leg.systems.energy_sensor import EnergySensor as EnergySensor
    from drake_leg.systems.frame_sensor import FrameSensor as FrameSensor
    from drake_leg.systems.input_filter import InputFilter as InputFilter
    from drake_leg.systems.inverse_jacobian import InverseJacobian as InverseJacobian
    from drake_leg.systems.joint_stops import JointStops as JointStops
    from drake_leg.systems.prescribed_motion import PrescribedMotion as PrescribedMotion

    build_ellipse = _ellipse.build
    build_hexabot_leg = _hexabot_leg.build
    build_kinematic_loop = _kinematic_loop.build
    build_pendulum = _pendulum.build
    build_scara = _scara.build
    frames_drawing = _free_body.free_body

# Where each name comes from: its module, and its own name there. There is no ``__all__``, so that
# ``help(drake_leg)`` prints the text above and not the help of every name.
_HOMES = {
    "DriftCorrection": ("drake_leg.systems.drift_correction", "DriftCorrection"),
    "EllipseConfig": ("drake_leg.diagrams.ellipse", "EllipseConfig"),
    "EllipticStep": ("drake_leg.kinematics.motions", "EllipticStep"),
    "EnergySensor": ("drake_leg.systems.energy_sensor", "EnergySensor"),
    "FrameSensor": ("drake_leg.systems.frame_sensor", "FrameSensor"),
    "HEXABOT": ("drake_leg.robot.hexapods", "HEXABOT"),
    "HexabotLegConfig": ("drake_leg.diagrams.hexabot_leg", "HexabotLegConfig"),
    "InputFilter": ("drake_leg.systems.input_filter", "InputFilter"),
    "InverseJacobian": ("drake_leg.systems.inverse_jacobian", "InverseJacobian"),
    "JointStops": ("drake_leg.systems.joint_stops", "JointStops"),
    "LEG_A": ("drake_leg.robot.robots", "LEG_A"),
    "LEG_B": ("drake_leg.robot.robots", "LEG_B"),
    "PENDULUM": ("drake_leg.robot.robots", "PENDULUM"),
    "PendulumConfig": ("drake_leg.diagrams.pendulum", "PendulumConfig"),
    "PrescribedMotion": ("drake_leg.systems.prescribed_motion", "PrescribedMotion"),
    "Recording": ("drake_leg.simulation.recording", "Recording"),
    "Robot": ("drake_leg.robot.robot", "Robot"),
    "SCARA": ("drake_leg.robot.robots", "SCARA"),
    "ScaraConfig": ("drake_leg.diagrams.scara", "ScaraConfig"),
    "SineStep": ("drake_leg.kinematics.motions", "SineStep"),
    "add_scope": ("drake_leg.diagrams.mechanism", "add_scope"),
    "block_diagram": ("drake_leg.pictures.block_diagram", "block_diagram"),
    "build_ellipse": ("drake_leg.diagrams.ellipse", "build"),
    "build_hexabot_leg": ("drake_leg.diagrams.hexabot_leg", "build"),
    "build_kinematic_loop": ("drake_leg.diagrams.kinematic_loop", "build"),
    "build_pendulum": ("drake_leg.diagrams.pendulum", "build"),
    "build_plant": ("drake_leg.models.plant", "build_plant"),
    "build_scara": ("drake_leg.diagrams.scara", "build"),
    "derive": ("drake_leg.symbolic.catalogue", "derive"),
    "errata": ("drake_leg.lab.shown", "errata"),
    "examine_posture": ("drake_leg.singularity.doctor", "examine_posture"),
    "frames_drawing": ("drake_leg.pictures.plots.free_body", "free_body"),
    "gradient": ("drake_leg.studies.gradient", "gradient"),
    "inverse_geometry": ("drake_leg.kinematics.inverse.geometry", "inverse_geometry"),
    "load_robot": ("drake_leg.robot.robot_file", "load_robot"),
    "movable": ("drake_leg.kinematics.chain", "movable"),
    "prove": ("drake_leg.models.proof", "prove"),
    "replay": ("drake_leg.scene.replays", "replay"),
    "report": ("drake_leg.lab.shown", "report"),
    "run": ("drake_leg.runs.named", "run"),
    "simulate": ("drake_leg.simulation.run", "simulate"),
    "still": ("drake_leg.scene.media", "still"),
    "sweep": ("drake_leg.studies.sweep", "sweep"),
    "view": ("drake_leg.scene.viewer", "view"),
    "write_video": ("drake_leg.scene.media", "write_video"),
}

__version__: str

if not TYPE_CHECKING:  # so that a misspelt name is an error to type checkers

    def __getattr__(name: str) -> object:
        if name == "__version__":
            from importlib.metadata import version

            return version("drake-leg")
        if name not in _HOMES:
            from drake_leg.errors import did_you_mean

            question = "" if name.startswith("_") else did_you_mean(name, _HOMES)
            raise AttributeError(
                f"module {__name__!r} has no attribute {name!r}{f': {question}' * bool(question)}"
            )
        module, own_name = _HOMES[name]
        value: object = getattr(import_module(module), own_name)
        globals()[name] = value  # found without this function from now on
        return value


def __dir__() -> list[str]:
    return [*_HOMES, "__version__"]


def _svg(diagram: Diagram) -> str:
    from drake_leg.pictures.block_diagram import block_diagram

    return block_diagram(diagram, accelerations=False).svg


def _show_diagrams_in_notebooks() -> None:
    """Let a notebook that is running draw Drake diagrams, which are C++ objects."""
    ipython = sys.modules.get("IPython")
    shell = ipython and ipython.get_ipython()
    if shell:
        svg = shell.display_formatter.formatters["image/svg+xml"]
        svg.for_type_by_name("pydrake.systems.framework", "Diagram", _svg)


_show_diagrams_in_notebooks()
