from dataclasses import replace

import numpy as np
import pytest
from pydrake.multibody.plant import DiscreteContactApproximation
from pydrake.systems.framework import DiagramBuilder

from drake_leg.errors import InvalidValueError
from drake_leg.models.plant import build_plant
from drake_leg.models.walker import NEAR_RIGID, Contact, add_walker
from drake_leg.robot.hexapods import HEXABOT
from drake_leg.robot.servos import IDEAL


def test_a_walker_is_the_robot_with_servos_and_contact():
    builder = DiagramBuilder()
    walker = add_walker(builder, HEXABOT)
    plant = walker.plant
    assert plant.get_discrete_contact_approximation() == DiscreteContactApproximation.kSap
    assert plant.get_sap_near_rigid_threshold() == NEAR_RIGID
    actuators = [plant.get_joint_actuator(i) for i in plant.GetJointActuatorIndices()]
    assert [a.joint().name() for a in actuators] == [s.joint for s in HEXABOT.moving]
    assert {a.effort_limit() for a in actuators} == {IDEAL.stall_torque}
    assert {a.joint().default_damping() for a in actuators} == {IDEAL.back_emf_damping}
    assert {a.get_controller_gains().p for a in actuators} == {IDEAL.stiffness}
    inspector = walker.scene_graph.model_inspector()
    touching = [
        inspector.GetName(shape)
        for shape in inspector.GetAllGeometryIds()
        if inspector.GetProximityProperties(shape) is not None
    ]
    assert len(touching) == 8  # feet, body, ground


@pytest.mark.parametrize("step", [0.001, 0.005])
def test_its_mass_matrix_is_that_of_the_plain_plant_with_rotors(step):
    """Less the inertia that a discrete plant's damping is: half of it times the time step."""
    builder = DiagramBuilder()
    walker, plain = add_walker(builder, HEXABOT, time_step=step).plant, build_plant(HEXABOT)
    context, other = walker.CreateDefaultContext(), plain.CreateDefaultContext()
    q = np.array([0.9, 0.1, -0.2, 0.3, 0.1, 0.2, 0.3, *np.linspace(-1.0, 1.0, 18)])
    q[:4] /= np.linalg.norm(q[:4])
    walker.SetPositions(context, q)
    plain.SetPositions(other, q)
    rotor = IDEAL.rotor_inertia - IDEAL.back_emf_damping * step / 2.0
    rotors = np.diag([0.0] * 6 + [rotor] * 18)
    np.testing.assert_allclose(
        walker.CalcMassMatrix(context), plain.CalcMassMatrix(other) + rotors, atol=1e-15
    )


def test_a_rotor_is_never_negative():
    light = replace(IDEAL, rotor_inertia=1e-5)
    plant = add_walker(DiagramBuilder(), HEXABOT, servo=light).plant
    actuators = [plant.get_joint_actuator(i) for i in plant.GetJointActuatorIndices()]
    assert {a.default_rotor_inertia() for a in actuators} == {0.0}


@pytest.mark.parametrize(
    ("numbers", "said"),
    [
        ({"stiffness": 0.0}, "the stiffness of a foot's contact is 0"),
        ({"foot_radius": -1e-3}, "the radius of a foot's ball is -0.001"),
    ],
)
def test_a_contact_that_cannot_be_is_refused(numbers, said):
    with pytest.raises(InvalidValueError, match=said):
        Contact(**numbers)
