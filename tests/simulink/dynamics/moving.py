"""Helpers of the tests of mechanisms in motion: wires, runs, and what is sensed."""

from pydrake.systems.analysis import Simulator

from drake_leg.simulink.dynamics.system import mechanism_dynamics

GRAVITY = 9.80665
FORCES = "sm_lib/Forces and Torques/"


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


def dynamics(built, folder):
    return mechanism_dynamics(built.model(folder))


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
