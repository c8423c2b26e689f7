"""Helpers of the tests of mechanisms in motion: wires, runs, and what is sensed."""

from mechanism_models import MechanismBuilder
from pydrake.systems.analysis import Simulator

from drake_leg.simulink.dynamics.system import mechanism_dynamics

GRAVITY = 9.80665
FORCES = "sm_lib/Forces and Torques/"
CURVES = "sm_lib/Curves and Surfaces/"
LAW = {
    "NormalStiffness": "1e4", "NormalDamping": "30", "NormalTransitionRegionWidth": "1e-3",
    "SenseNormalForceMagnitude": "on", "SenseSeparationDistance": "on",
}  # fmt: skip


def with_gravity(built, **texts):
    built.add_library("sm_lib/Utilities/Mechanism Configuration", "Gravity", texts)
    built.physical(f"{built.sid('Gravity')}#rconn:1", f"{built.sid('World')}#rconn:1")
    return built


def wired(built, block, *places):
    """Wire signals: what enters comes from a Simulink-PS Converter, what leaves goes to one."""
    for place in places:
        inward = place.startswith("lconn")
        kind = "Simulink-PS Converter" if inward else "PS-Simulink Converter"
        name = f"{block} {place}"
        built.add_library(f"nesl_utility/{kind}", name)
        end = "rconn:1" if inward else "lconn:1"
        built.physical(f"{built.sid(block)}#{place}", f"{built.sid(name)}#{end}")
    return built


def dynamics(built, folder, **more):
    return mechanism_dynamics(built.model(folder), **more)


def port(built, text):
    block, place = text.rsplit(" ", 1)
    return f"{built.sid(block)}#{place}"


def sensed(system, context, built, text):
    """Evaluate what leaves a block at a port."""
    key = port(built, text)
    vector = "sensed" if key in system.sensed else "efforts"
    values = system.GetOutputPort(vector).Eval(context)[getattr(system, vector)[key]]
    return values.reshape(system.shapes[key])


def run(system, until, accuracy=1e-7, u=None):
    context = system.CreateDefaultContext()
    if u is not None:
        system.GetInputPort("u").FixValue(context, u)
    simulator = Simulator(system, context)
    simulator.get_mutable_integrator().set_target_accuracy(accuracy)
    simulator.AdvanceTo(until)
    return context


def energy(system, context):
    plant = system.plant
    own = plant.GetMyContextFromRoot(context)
    return plant.CalcPotentialEnergy(own) + plant.CalcKineticEnergy(own)


def falling(height, *, solid="Spherical Solid", texts=None, floor="Infinite Plane", **more):
    """A free body above a floor; where it is, how far from the floor and how it is pushed."""
    built = with_gravity(MechanismBuilder())
    targets = {"PzPositionTargetSpecify": "on", "PzPositionTargetValue": str(height)}
    built.joint("6-DOF", "Free", **targets, **more)
    shape = {"ExportEntireGeometry": "on"} | (texts or {"SphereRadius": "0.1"})
    built.body(solid, "Body", **shape)
    built.add_library(CURVES + floor, "Floor")
    built.add_library(FORCES + "Spatial Contact Force", "Contact", LAW)
    built.meet("World", "Free lconn:1", "Floor lconn:1")
    built.meet("Free", "Body")
    built.meet("Floor", "Contact lconn:1")
    built.meet("Body lconn:1", "Contact")
    return wired(built, "Contact", "rconn:2", "rconn:3")
