import numpy as np
import pytest

from drake_leg.kinematics.leg import LegGeometry, MovableLeg
from drake_leg.kinematics.loop import FLOATS, KinematicEquation
from drake_leg.kinematics.motions import EllipticStep, SineStep
from drake_leg.kinematics.scara import MovableScara, ScaraGeometry
from drake_leg.robot.robots import LEG_A, LEG_B, SCARA

Q0 = (0.3, -0.6, -1.3)  # [rad]
TIME = 0.7  # [s]
ROBOTS = {
    "leg A": MovableLeg(LegGeometry.from_robot(LEG_A)),
    "leg B": MovableLeg(LegGeometry.from_robot(LEG_B)),
    "SCARA": MovableScara(ScaraGeometry.from_robot(SCARA)),
}
MOTIONS = {"line": SineStep(amplitude=0.05), "ellipse": EllipticStep(amplitude=0.05, lift=0.02)}
WAYS = {
    "exactly": {},
    "corrected": {"correction": 3.0},
    "filtered": {"time_constant": 0.05},
    "filtered, not sensed": {"time_constant": 0.05, "senses": False},
}


def equation(robot, motion, way):
    return KinematicEquation(robot=ROBOTS[robot], motion=MOTIONS[motion], q0=Q0, **WAYS[way])


def state_of(law):
    """Some state, off the one in which the command starts."""
    return [value + 0.01 * index for index, value in enumerate(law.start(Q0))]


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("motion", MOTIONS)
@pytest.mark.parametrize("robot", ROBOTS)
class TestEquation:
    def test_its_formula_is_its_derivative(self, robot, motion, way):
        law = equation(robot, motion, way)
        state = state_of(law)
        formula = law.formula(TIME, state, FLOATS)
        assert formula == pytest.approx(law.derivative(TIME, state), rel=1e-12, abs=1e-12)

    def test_its_formula_takes_arrays(self, robot, motion, way):
        law = equation(robot, motion, way)
        state = state_of(law)
        many = law.formula(np.array([TIME, 2.0]), np.array([state, state]).T, (np.cos, np.sin))
        assert [part[0] for part in many] == pytest.approx(law.derivative(TIME, state), abs=1e-12)

    def test_accelerations_are_derivatives_of_velocities(self, robot, motion, way, derivative):
        law = equation(robot, motion, way)
        state = np.array(state_of(law))
        rate = np.array(law.derivative(TIME, state.tolist()))

        def velocity(step):
            moved = (state + step * rate).tolist()
            return np.array(law.joint_motion(TIME + step, moved)[1])

        _, _, qddot = law.joint_motion(TIME, state.tolist())
        assert np.array(qddot) == pytest.approx(derivative(velocity), abs=1e-8)
        formula = law.motion_formula(TIME, state.tolist(), FLOATS)
        assert np.array(formula[2]) == pytest.approx(np.array(qddot), abs=1e-12)


@pytest.mark.parametrize("motion", MOTIONS)
def test_parts_of_a_motion_add_up_to_it(motion):
    law = equation("leg B", motion, "exactly")
    at = law.instant(TIME, list(Q0))
    assert at.v == pytest.approx(MOTIONS[motion].velocity([TIME])[0], abs=1e-15)
    assert at.a == pytest.approx(MOTIONS[motion].acceleration([TIME])[0], abs=1e-15)


def test_a_start_off_the_path_is_drawn_back():
    law = equation("leg B", "line", "corrected")
    off = [value + 0.02 for value in Q0]
    goal = ROBOTS["leg B"].foot(Q0) + law.motion.displacement([TIME])[0]
    error = ROBOTS["leg B"].foot(off) - goal
    moved = ROBOTS["leg B"].jacobian(off) @ law.derivative(TIME, off)
    assert moved - law.motion.velocity([TIME])[0] == pytest.approx(-3.0 * error)
