import numpy as np
import pytest
from pydrake.multibody.tree import JacobianWrtVariable
from pydrake.systems.analysis import ResetIntegratorFromFlags, Simulator
from pydrake.systems.framework import DiagramBuilder
from pydrake.systems.primitives import ConstantVectorSource, Integrator, VectorLogSink

from drake_leg.errors import SingularConfigurationError
from drake_leg.kinematics.leg import LegGeometry, MovableLeg
from drake_leg.kinematics.scara import MovableScara, ScaraGeometry
from drake_leg.models.plant import build_plant
from drake_leg.robot.robots import LEG_A, LEG_B, SCARA
from drake_leg.systems.inverse_jacobian import InverseJacobian

LEGS = pytest.mark.parametrize("robot", [LEG_A, LEG_B], ids=lambda robot: robot.name)


def leg_block(robot):
    return InverseJacobian(MovableLeg(LegGeometry.from_robot(robot)))


def drake_jacobian(robot, q, qdot):
    """Jacobian of the last frame's origin and the acceleration that is there without qddot."""
    plant = build_plant(robot)
    context = plant.CreateDefaultContext()
    plant.SetPositions(context, q)
    plant.SetVelocities(context, qdot)
    foot = plant.GetFrameByName(f"frame_{len(robot.rows)}")
    world = plant.world_frame()
    arguments = (context, JacobianWrtVariable.kV, foot, [0.0, 0.0, 0.0], world, world)
    J = plant.CalcJacobianTranslationalVelocity(*arguments)
    return J, plant.CalcBiasTranslationalAcceleration(*arguments).ravel()


def regular_postures(rng, count):
    """Legs bent by at least 0.3 rad, the foot at least 5 cm in front of the hip axis."""
    found = []
    while len(found) < count:
        q = rng.uniform(-np.pi, np.pi, 3)
        reach = 0.05 + 0.1 * np.cos(q[1]) + 0.1 * np.cos(q[1] + q[2])
        if abs(np.sin(q[2])) > 0.3 and reach > 0.05:
            found.append(q)
    return found


def evaluated(block, port, **inputs):
    context = block.CreateDefaultContext()
    for name, value in inputs.items():
        block.GetInputPort(name).FixValue(context, value)
    return block.GetOutputPort(port).Eval(context)


def test_its_ports_have_the_names_and_sizes_of_its_table():
    block = leg_block(LEG_B)
    inputs = [block.get_input_port(i) for i in range(block.num_input_ports())]
    outputs = [block.get_output_port(i) for i in range(block.num_output_ports())]
    assert {port.get_name(): port.size() for port in inputs} == {"q": 3, "v": 3, "a": 3, "w": 3}
    assert {port.get_name(): port.size() for port in outputs} == {"qdot": 3, "qddot": 3, "det_j": 1}


@LEGS
def test_rates_and_accelerations_give_the_foot_its_command_by_drakes_jacobian(robot, rng):
    block = leg_block(robot)
    for q in regular_postures(rng, 25):
        v, a = rng.uniform(-1.0, 1.0, (2, 3))
        qdot = evaluated(block, "qdot", q=q, v=v)
        qddot = evaluated(block, "qddot", q=q, v=v, a=a)
        J, bias = drake_jacobian(robot, q, qdot)
        np.testing.assert_allclose(qdot, np.linalg.solve(J, v), rtol=1e-11, atol=1e-12)
        np.testing.assert_allclose(J @ qddot + bias, a, rtol=0.0, atol=1e-10)


@LEGS
def test_det_j_is_the_determinant_of_drakes_jacobian(robot, rng):
    block = leg_block(robot)
    for q in regular_postures(rng, 10):
        J, _ = drake_jacobian(robot, q, np.zeros(3))
        assert evaluated(block, "det_j", q=q)[0] == pytest.approx(np.linalg.det(J), rel=1e-11)


def test_the_scaras_task_is_drakes_jacobian_of_x_y_and_yaw(rng):
    block = InverseJacobian(MovableScara(ScaraGeometry.from_robot(SCARA)))
    for q2 in (0.4, 1.5, -2.0):
        q = np.array([rng.uniform(-3, 3), q2, rng.uniform(-3, 3)])
        v, a = rng.uniform(-1.0, 1.0, (2, 3))
        qdot = evaluated(block, "qdot", q=q, v=v)
        qddot = evaluated(block, "qddot", q=q, v=v, a=a)
        J, bias = drake_jacobian(SCARA, [*q, 0.0], [*qdot, 0.0])
        task = np.vstack([J[:2, :3], np.ones(3)])
        np.testing.assert_allclose(task @ qdot, v, atol=1e-12)
        np.testing.assert_allclose(task @ qddot + [*bias[:2], 0.0], a, atol=1e-11)
        assert evaluated(block, "det_j", q=q)[0] == pytest.approx(np.linalg.det(task), rel=1e-12)


def test_the_acceleration_may_be_left_unconnected_by_who_wants_rates_only():
    block = leg_block(LEG_B)
    q, v = [0.3, -0.9, -1.5], [0.1, 0.0, 0.0]
    J, _ = drake_jacobian(LEG_B, q, np.zeros(3))
    np.testing.assert_allclose(evaluated(block, "qdot", q=q, v=v), np.linalg.solve(J, v))
    with pytest.raises(RuntimeError, match=r"InputPort\[2\] \(a\) .* is not connected"):
        evaluated(block, "qddot", q=q, v=v)


def test_rates_do_not_wait_for_the_acceleration():
    block = leg_block(LEG_B)
    fed = {
        (name, output)
        for name in ("q", "v", "a")
        for output in ("qdot", "qddot", "det_j")
        if block.HasDirectFeedthrough(
            block.GetInputPort(name).get_index(), block.GetOutputPort(output).get_index()
        )
    }
    rates, accelerations = {("q", "qdot"), ("v", "qdot")}, {(i, "qddot") for i in ("q", "v", "a")}
    assert fed == rates | accelerations | {("q", "det_j")}


# Stretched; folded; the foot on the hip axis: l1 + l2 c2 + l3 c23 = 50 + 0 - 50 mm.
SINGULAR = [(0.4, -0.7, 0.0), (0.4, -0.7, np.pi), (0.4, np.pi / 2, np.pi / 6)]


@pytest.mark.parametrize("q", SINGULAR, ids=("stretched", "folded", "on the hip axis"))
def test_every_singular_family_raises_with_posture_and_singular_value(q):
    with pytest.raises(SingularConfigurationError) as caught:
        evaluated(leg_block(LEG_B), "qdot", q=q, v=[0.1, 0.2, 0.3])
    assert caught.value.q == pytest.approx(q)
    assert caught.value.sigma_min == pytest.approx(0.0, abs=1e-15)
    assert caught.value.time == 0.0


def test_the_normalised_determinant_is_zero_where_singular_and_never_more_than_one(rng):
    block = leg_block(LEG_B)
    context = block.CreateDefaultContext()

    def at(q):
        block.GetInputPort("q").FixValue(context, q)
        return block.robot.normalised_determinant(block.posture(context))

    assert [at(q) for q in SINGULAR] == pytest.approx([0.0, 0.0, 0.0], abs=1e-15)
    values = [abs(at(q)) for q in rng.uniform(-np.pi, np.pi, (300, 3))]
    assert max(values) <= 1.0


def test_a_singularity_met_while_simulating_carries_its_time_and_posture():
    builder = DiagramBuilder()
    block = builder.AddNamedSystem("inverseJacobian", leg_block(LEG_B))
    ankle = builder.AddNamedSystem("ankle", ConstantVectorSource([0.0, 0.0, 0.25]))
    q = builder.AddNamedSystem("q", Integrator([0.5, -0.5, -0.25]))
    v = builder.AddNamedSystem("v", ConstantVectorSource([0.1, 0.0, 0.0]))
    log = builder.AddNamedSystem("log", VectorLogSink(3))
    builder.Connect(ankle.get_output_port(), q.get_input_port())
    builder.Connect(q.get_output_port(), block.GetInputPort("q"))
    builder.Connect(v.get_output_port(), block.GetInputPort("v"))
    builder.Connect(block.GetOutputPort("qdot"), log.get_input_port())
    simulator = Simulator(builder.Build())
    ResetIntegratorFromFlags(simulator, "explicit_euler", 0.125)  # all numbers are binary
    with pytest.raises(SingularConfigurationError) as caught:
        simulator.AdvanceTo(3.0)
    assert caught.value.time == 1.0
    assert caught.value.q == (0.5, -0.5, 0.0)
    assert caught.value.sigma_min == pytest.approx(0.0, abs=1e-15)
    assert "t = 1 s" in str(caught.value)
