"""Geometric and kinematic models of any frame in any frame."""

import numpy as np
import pytest
import sympy as sp
from bodies import FORK, ODD, RX_90, robot_of
from pydrake.multibody.tree import JacobianWrtVariable

from drake_leg import LEG_A, LEG_B, SCARA, build_plant
from drake_leg.errors import InvalidValueError
from drake_leg.kinematics import khalil
from drake_leg.symbolic.catalogue import derived
from drake_leg.symbolic.models import derive_model

ROWS = {"leg_b": LEG_B.rows, "odd": ODD, "fork": FORK}


@pytest.mark.parametrize("name", ROWS)
@pytest.mark.parametrize(("frame", "within"), [(None, 0), (0, 3), (3, 2), (2, 4)])
def test_poses_and_jacobians_are_the_chains(name, frame, within, rng):
    robot = robot_of(ROWS[name], rng)
    frame = len(robot.rows) if frame is None else frame
    q = rng.uniform(-2.0, 2.0, len(robot.moving))
    X = [np.eye(4), *khalil.base_transforms(robot.rows, q)]
    T = derive_model(robot, "geometry", frame=frame, within=within)(q)["T"]
    np.testing.assert_allclose(T, np.linalg.inv(X[within]) @ X[frame], atol=1e-14)
    J = derive_model(robot, "jacobian", frame=frame, within=within)(q)["J"]
    R = X[within][:3, :3].T
    expected = differences(robot, frame, q)
    np.testing.assert_allclose(J, np.vstack([R @ expected[:3], R @ expected[3:]]), atol=1e-8)


def differences(robot, frame, q):
    """Jacobian of a frame in the base by differences of its pose."""

    def pose(at):
        return [np.eye(4), *khalil.base_transforms(robot.rows, at)][frame]

    columns, R = [], pose(q)[:3, :3]
    for step in 1e-6 * np.eye(len(q)):
        rate = (pose(q + step) - pose(q - step)) / 2e-6
        spin = rate[:3, :3] @ R.T
        columns.append([spin[2, 1], spin[0, 2], spin[1, 0], *rate[:3, 3]])
    return np.array(columns).T


@pytest.mark.slow
@pytest.mark.parametrize("name", ["odd", "fork"])
def test_velocities_and_accelerations_are_drakes(name, rng):
    robot = robot_of(ROWS[name], rng)
    q, v, a = rng.uniform(-2.0, 2.0, (3, len(robot.moving)))
    velocity, acceleration = (
        derive_model(robot, "velocity")(q, v),
        derive_model(robot, "acceleration")(q, v, a),
    )
    plant = build_plant(robot)
    context = plant.CreateDefaultContext()
    plant.SetPositions(context, q)
    plant.SetVelocities(context, v)
    torques = plant.CalcMassMatrix(context) @ a + plant.CalcBiasTerm(context)
    torques -= plant.CalcGravityGeneralizedForces(context)
    torques += [s.mechanics.damping for s in robot.moving] * v
    plant.get_applied_generalized_force_input_port().FixValue(context, torques)
    world = plant.world_frame()
    for number in range(1, len(robot.rows) + 1):
        frame = plant.GetFrameByName(f"frame_{number}")
        R = frame.CalcPoseInWorld(context).rotation().matrix()
        V = frame.CalcSpatialVelocityInWorld(context)
        A = frame.CalcSpatialAccelerationInWorld(context)
        np.testing.assert_allclose(R @ velocity[f"w{number}"], V.rotational(), atol=1e-12)
        np.testing.assert_allclose(R @ velocity[f"v{number}"], V.translational(), atol=1e-12)
        np.testing.assert_allclose(R @ acceleration[f"wd{number}"], A.rotational(), atol=1e-9)
        np.testing.assert_allclose(R @ acceleration[f"vd{number}"], A.translational(), atol=1e-9)
        bias = derive_model(robot, "bias-acceleration", frame=number, within=0)(q, v)["a"]
        Jv = plant.CalcBiasSpatialAcceleration(
            context, JacobianWrtVariable.kV, frame, [0, 0, 0], world, world
        )
        np.testing.assert_allclose(bias, [*Jv.rotational(), *Jv.translational()], atol=1e-12)


@pytest.mark.slow
def test_an_rx_90s_determinant_is_the_textbooks(rng):
    model = derive_model(robot_of(RX_90, rng), "determinant")
    (determinant,) = model.outputs[0].value
    expression = dict(model.assignments)[determinant]
    q2, q3, q5 = (sp.Symbol(f"q{n}", real=True) for n in (2, 3, 5))
    D3, RL4 = sp.Symbol("l1", positive=True), sp.Symbol("h", positive=True)
    reach = RL4 * sp.sin(q2 + q3) - D3 * sp.cos(q2)
    right = D3 * RL4 * sp.cos(q3) * sp.sin(q5) * reach
    assert sp.expand(expression - right) == 0


@pytest.mark.parametrize(("robot", "name"), [(LEG_A, "leg-a"), (SCARA, "scara")])
def test_determinants_are_those_of_the_derivation(robot, name, rng):
    model = derive_model(robot, "determinant")
    q = rng.uniform(-2.0, 2.0, len(robot.moving))
    J = derive_model(robot, "jacobian")(q)["J"]
    rows = [2, 3, 4, 5] if name == "scara" else [3, 4, 5]
    assert model(q)["det"][0] == pytest.approx(np.linalg.det(J[rows]), abs=1e-15)
    assert (
        derived(name).determinant.free_symbols
        == dict(model.assignments)[model.outputs[0].value[0]].free_symbols
    )


def test_a_floating_bases_columns_come_first(rng):
    robot = robot_of(FORK, rng, floating=True)
    q, qdot = rng.uniform(-1.0, 1.0, (2, len(robot.moving)))
    w0, v0 = rng.uniform(-1.0, 1.0, (2, 3))
    velocity = derive_model(robot, "velocity")(q, qdot, w0, v0)
    J = derive_model(robot, "jacobian", frame=4, within=4)(q)["J"]
    expected = np.concatenate([velocity["w4"], velocity["v4"]])
    np.testing.assert_allclose(J @ [*w0, *v0, *qdot], expected, atol=1e-14)


def test_frames_are_given_by_number_or_by_link(rng):
    q = rng.uniform(-1.0, 1.0, 3)
    link = LEG_B.segments[1].link.name
    by_name = derive_model(LEG_B, "geometry", frame=link)(q)["T"]
    np.testing.assert_array_equal(by_name, derive_model(LEG_B, "geometry", frame=2)(q)["T"])
    assert derive_model(LEG_B, "geometry", frame="base")(q)["T"] == pytest.approx(np.eye(4))


def test_what_cannot_be_derived_is_refused(rng):
    fork = robot_of(FORK, rng)
    with pytest.raises(InvalidValueError, match=r"has branches.* its last frames are 2, 4, 5"):
        derive_model(fork, "jacobian")
    with pytest.raises(InvalidValueError, match="has no frame 9; its frames are 0 to 4"):
        derive_model(LEG_B, "geometry", frame=9)
    with pytest.raises(InvalidValueError, match="no frame 'femmur'"):
        derive_model(LEG_B, "geometry", frame="femmur")
    with pytest.raises(InvalidValueError, match="no rows that make it square"):
        derive_model(fork, "determinant", frame=2)
    with pytest.raises(InvalidValueError, match="'dynamics' is of all frames"):
        derive_model(LEG_B, "dynamics", frame=1)
    with pytest.raises(InvalidValueError, match="no dynamic parameters to group"):
        derive_model(LEG_B, "velocity", grouped=True)
    with pytest.raises(InvalidValueError, match=r"'dynamic'.*did you mean dynamics"):
        derive_model(LEG_B, "dynamic")
