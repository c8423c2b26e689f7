"""What a walk will meet: each sentence has the greatest value that works, and it does."""

import math
import re
from dataclasses import replace

import numpy as np
import pytest

from drake_leg.diagrams.hexapod import HexapodConfig, build, start_walking
from drake_leg.errors import ImpossibleWalkError, InvalidValueError
from drake_leg.kinematics.walking.demands import BEHIND, lags
from drake_leg.kinematics.walking.foresight import foresee_walk
from drake_leg.kinematics.walking.gait import GAITS, Gait
from drake_leg.kinematics.walking.gaits import Attitude, Command, Walk
from drake_leg.kinematics.walking.lateness import LATE, late_times, position_errors
from drake_leg.kinematics.walking.legs import Legs
from drake_leg.robot.ground import Ground, Steps
from drake_leg.robot.hexapods import HEXABOT, Hip, hexapod
from drake_leg.robot.joint_mechanics import JointMechanics, starting_posture
from drake_leg.robot.servos import IDEAL
from drake_leg.simulation.run import simulate

FORWARD = Command(forward=0.1, start=1.0)
TRIPOD = GAITS["tripod"]


def walk_of(*commands, robot=HEXABOT, attitudes=(), height=None, gait=TRIPOD, period=1.0, **others):
    feet = Legs.of(robot).feet(np.reshape(starting_posture(robot), (-1, 3)))
    height = -feet[:, 2].mean() if height is None else height
    feet[:, 2] = 0.0
    standing = Attitude(shift=(0.0, 0.0, height), start=-1.0)
    return Walk(
        gait=gait, period=period, neutral=feet, commands=commands,
        attitudes=(standing, *attitudes), **others,
    )  # fmt: skip


def says(foresight, pattern):
    """The numbers in the refusal, which must match a pattern."""
    found = re.fullmatch(pattern + "; `force=True` goes on", foresight.refusal)
    assert found, foresight.refusal
    return [float(group) for group in found.groups()]


@pytest.fixture(scope="module")
def forward():
    return foresee_walk(HEXABOT, walk_of(FORWARD), IDEAL)


def test_a_walk_that_works_is_described_by_its_margins(forward):
    found = forward
    assert found.refusal is None
    assert found.remedy is None
    found.require_walkable()
    static = found.demand("static margin")
    assert static.value == pytest.approx(0.078, abs=1e-4)
    assert static.value > 0.075
    assert found.demand("dynamic margin").value == pytest.approx(0.078, abs=5e-4)
    assert found.demand("gap between legs").value == pytest.approx(0.0634, abs=1e-3)
    assert found.demand("sigma_min").where in Legs.of(HEXABOT).names
    assert found.demand("joint speed").value == pytest.approx(3.58, abs=0.02)
    assert found.demand("torture") is None
    assert any(line.startswith("static margin: 0.07") for line in found.lines())


@pytest.mark.parametrize("gait", ["ripple", "ripple-pairs", "wave"])
def test_every_gait_is_supported_through_its_whole_cycle(gait):
    walk = walk_of(Command(forward=0.033, start=3.0), gait=GAITS[gait], period=3.0)
    found = foresee_walk(HEXABOT, walk, IDEAL)
    assert found.refusal is None
    assert found.demand("static margin").value > 0.074


@pytest.mark.slow
def test_the_greatest_speed_works_and_a_little_more_does_not(forward):
    found = forward
    assert found.greatest_stride == found.greatest_speed
    for factor, works in ((1.0, True), (1.02, False)):
        fast = Command(forward=factor * found.greatest_speed, start=1.0)
        assert (foresee_walk(HEXABOT, walk_of(fast), IDEAL).refusal is None) == works
    turning = foresee_walk(HEXABOT, walk_of(Command(turning=0.2, start=1.0)), IDEAL)
    assert turning.greatest_speed == 0.0
    assert turning.greatest_turning > 0.2
    standing = foresee_walk(HEXABOT, walk_of(), IDEAL)
    assert standing.greatest_speed == pytest.approx(found.greatest_speed, abs=0.0015)  # rounded


@pytest.mark.slow
def test_a_stride_out_of_reach_is_refused_with_the_greatest_one():
    walk = walk_of(replace(FORWARD, forward=0.5))
    found = foresee_walk(HEXABOT, walk)
    far, speed, stride = says(
        found,
        r"the foot of \w+ would be ([\d.]+) m from its knee at t = [\d.]+ s, [\d.]+ of the cycle, "
        r"and femur and tibia reach at most 0\.2 m: a speed of ([\d.]+) m/s \(a stride of "
        r"([\d.]+) m\) is the greatest that works",
    )
    assert far > 0.2
    assert stride == speed
    assert foresee_walk(HEXABOT, walk_of(replace(FORWARD, forward=speed))).refusal is None
    assert foresee_walk(HEXABOT, walk_of(replace(FORWARD, forward=1.02 * speed))).unmet
    with pytest.raises(ImpossibleWalkError, match="is the greatest that works") as caught:
        found.require_walkable()
    assert caught.value.limit == pytest.approx(0.2, abs=1e-15)
    assert caught.value.where in Legs.of(HEXABOT).names


@pytest.mark.slow
def test_a_speed_that_the_servo_cannot_follow_is_refused_with_the_greatest_one():
    walk = walk_of(replace(FORWARD, forward=0.5), period=0.4)
    behind, rate, torque, most, stall, speed = says(
        foresee_walk(HEXABOT, walk, IDEAL),
        r"the joint \w+ would be ([\d.]+) deg behind its plan at t = .* s, .* of the cycle, its "
        r"foot on the ground, because it is to turn at ([\d.]+) rad/s and give ([\d.]+) N\*m, and "
        r"the servo 'ideal' turns at most at ([\d.]+) rad/s and gives at most ([\d.]+) N\*m: a "
        r"speed of ([\d.]+) m/s .* works",
    )
    assert math.radians(behind) > BEHIND
    assert rate > most == pytest.approx(IDEAL.no_load_speed, abs=1e-3)
    assert torque > stall == IDEAL.stall_torque
    slower = walk_of(replace(FORWARD, forward=speed), period=0.4)
    assert foresee_walk(HEXABOT, slower, IDEAL).refusal is None
    assert foresee_walk(HEXABOT, walk).refusal is None  # without a servo


@pytest.mark.slow
def test_a_robot_that_is_too_heavy_for_its_servos_is_refused():
    heavy = hexapod(name="heavy", body_mass=6.0)
    found = foresee_walk(heavy, walk_of(FORWARD, robot=heavy), IDEAL)
    assert "no slower or lower walk of these feet works" in found.refusal
    assert found.unmet[0].what == "lag"
    assert found.demand("torque").value > IDEAL.stall_torque


@pytest.mark.slow
def test_the_speed_limit_of_a_joint_itself_counts():
    slow = hexapod(mechanics=JointMechanics(velocity=3.0))
    (speed,) = says(
        foresee_walk(slow, walk_of(FORWARD, robot=slow)),
        r"the joint \w+ would turn at 3\.5\d+ rad/s at .*, and its limit is 3 rad/s: a speed of "
        r"([\d.]+) m/s .* works",
    )
    slower = walk_of(replace(FORWARD, forward=speed), robot=slow)
    assert foresee_walk(slow, slower).refusal is None


def test_a_servo_is_behind_by_what_its_line_lacks_and_catches_up():
    """A load of 2 N*m for 0.1 s, then of 0.5 N*m, on a motor of 1.5 N*m that has 0.25 N*m*s/rad."""
    times = np.linspace(0.0, 0.4, 401)
    torques = np.where(times < 0.1, 2.0, 0.5)[:, np.newaxis] * [1.0, -1.0]
    behind = lags(times, torques, np.array([1.5, 1.5]), 0.25)
    growing, falling = 0.5 / 0.25, 1.0 / 0.25  # [rad/s]
    expected = np.minimum(growing * times, growing * 0.1 - falling * (times - 0.1))
    assert behind[:, 0] == pytest.approx(np.maximum(expected, 0.0), abs=4e-3)
    assert behind[:, 1].tolist() == (-behind[:, 0]).tolist()
    again = lags(np.append(times[:50], times[:50] + 3.0), torques[:100], np.full(2, 1.5), 0.25)
    assert again[50].tolist() == [0.0, 0.0]  # after a gap


@pytest.mark.slow
def test_swings_that_servos_cannot_follow_are_refused_with_the_greatest_lift():
    """In the simulation, at 0.2 m/s and a period of 0.3 s a hexabot loses 6 % of its way."""
    walk = walk_of(replace(FORWARD, forward=0.2), period=0.3)
    part, torque, stall, lift = says(
        foresee_walk(HEXABOT, walk, IDEAL),
        r"feet would come late to their places, and stand out of them for (\d+) % of a period, "
        r"worst of all right_rear at .*, because in its swing the joint right_rear_\w+ is to give "
        r"([\d.]+) N\*m, and the servo 'ideal' gives at most ([\d.]+) N\*m: a lift of ([\d.]+) m "
        r"is the greatest that works",
    )
    assert part > 100.0 * LATE
    assert torque > stall == IDEAL.stall_torque
    for share, refused in ((1.0, False), (1.2, True)):
        lower = walk_of(replace(FORWARD, forward=0.2), period=0.3, lift=share * lift)
        assert (foresee_walk(HEXABOT, lower, IDEAL).refusal is not None) is refused
    calmer = walk_of(replace(FORWARD, forward=0.2), period=0.4)
    assert foresee_walk(HEXABOT, calmer, IDEAL).refusal is None


def test_a_position_controller_brings_a_late_rotor_back():
    """A load of 2 N*m for 0.1 s, then of 0.5 N*m, on a servo that drives with 1.5 N*m at most."""
    times = np.linspace(0.0, 0.6, 6001)
    torques = np.where(times < 0.1, 2.0, 0.5)[:, np.newaxis] * [1.0, -1.0]
    stall, emf, rotor = IDEAL.stall_torque, IDEAL.back_emf_damping, IDEAL.rotor_inertia
    error = position_errors(times, torques, np.full(2, stall), IDEAL)
    assert error[:, 1].tolist() == (-error[:, 0]).tolist()
    rising = times[:1000]  # inertia e'' + emf e' = 0.5
    lag = (rising - rotor / emf * -np.expm1(-rising * emf / rotor)) * 0.5 / emf
    assert error[:1000, 0] == pytest.approx(lag, abs=1e-4)
    assert error[1000:, 0].max() < 1.3 * lag[-1]
    assert abs(error[-1, 0]) < 1e-3 * lag[-1]
    assert not position_errors(times, torques[::-1] / 2.0, np.full(2, stall), IDEAL).any()


def test_a_foot_is_late_while_it_stands_out_of_its_place():
    times = np.array([0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 9.0])
    off = np.array([1.0, 1.0, 1.0, 1.0, 0.0, 1.0, 1.0])[:, np.newaxis] * [1e-3, 1e-4]
    down = np.array([1, 0, 1, 1, 1, 1, 1], dtype=bool)[:, np.newaxis] & [True, True]
    late = late_times(times, off, down)
    assert late[:, 0] == pytest.approx([0.0, 0.0, 0.0, 0.1, 0.2, 0.2, 0.2])
    assert not late[:, 1].any()


@pytest.mark.slow
def test_a_turn_rate_and_a_speed_are_scaled_together():
    command = Command(forward=0.05, turning=1.6, start=1.0)
    speed, rate = says(
        foresee_walk(HEXABOT, walk_of(command), IDEAL),
        r".*: a speed of ([\d.]+) m/s .* with a turn rate of ([\d.]+) deg/s is .* works",
    )
    assert math.radians(rate) / speed == pytest.approx(32.0, rel=0.01)


@pytest.mark.slow
def test_a_lift_that_fails_at_every_speed_is_refused_with_the_greatest_lift(forward):
    walk = walk_of(FORWARD, lift=0.19)
    (lift,) = says(foresee_walk(HEXABOT, walk, IDEAL), r".*: a lift of ([\d.]+) m is the .* works")
    assert foresee_walk(HEXABOT, replace(walk, lift=lift), IDEAL).refusal is None
    assert foresee_walk(HEXABOT, replace(walk, lift=1.02 * lift), IDEAL).unmet
    # Workspaces alone would allow more.
    assert forward.greatest_lift > lift


@pytest.mark.slow
def test_heights_that_work_are_those_of_workspace_and_ground(forward):
    found = forward
    least, most = found.heights
    assert found.height == pytest.approx(0.085)
    assert least == pytest.approx(0.020, abs=1e-4)  # the body's underside is 20 mm lower
    for height, works in ((least, True), (most, True), (1.01 * most, False)):
        assert (foresee_walk(HEXABOT, walk_of(FORWARD, height=height)).refusal is None) == works
    refused = foresee_walk(HEXABOT, walk_of(FORWARD, height=0.25))
    (height,) = says(refused, r"the foot .*: a height of the body of ([\d.]+) m is the greatest .*")
    assert height == pytest.approx(most, rel=0.02)
    assert foresee_walk(HEXABOT, walk_of(FORWARD, height=height)).refusal is None
    low = foresee_walk(HEXABOT, walk_of(FORWARD, height=0.01))
    assert "the body would be 10 mm in the ground at t = 0 s" in low.refusal


@pytest.mark.slow
def test_a_joint_limit_is_named_with_the_greatest_speed_or_attitude():
    limited = hexapod(mechanics=JointMechanics(lower=-2.22, upper=0.5))
    walk = walk_of(replace(FORWARD, forward=0.15), robot=limited)
    value, low, high, speed = says(
        foresee_walk(limited, walk),
        r"the joint \w+ would be at ([-\d.]+) deg at t = .*, outside its limits ([-\d.]+) \.\.\. "
        r"([-\d.]+) deg: a speed of ([\d.]+) m/s .* works",
    )
    assert not low <= value <= high
    slower = walk_of(replace(FORWARD, forward=speed), robot=limited)
    assert foresee_walk(limited, slower).refusal is None
    leaning = Attitude(roll=0.9, start=1.0)
    (degrees,) = says(
        foresee_walk(HEXABOT, walk_of(attitudes=[leaning])),
        r".*: a roll of ([\d.]+) deg is the greatest that works",
    )
    part = replace(leaning, roll=math.radians(degrees))
    assert foresee_walk(HEXABOT, walk_of(attitudes=[part])).refusal is None


@pytest.mark.slow
def test_legs_that_would_collide_are_named():
    hips = {
        f"{side}_{leg}": Hip(x, sign * 0.08, sign * math.pi / 2)
        for side, sign in (("left", 1.0), ("right", -1.0))
        for leg, x in (("front", 0.07), ("middle", 0.0), ("rear", -0.07))
    }
    narrow = hexapod(name="narrow", hips=hips)
    found = foresee_walk(narrow, walk_of(replace(FORWARD, forward=0.15), robot=narrow))
    deep, speed = says(
        found,
        r"\w+ and \w+ would collide at t = .* s, .* of the cycle, ([\d.]+) mm in each other: a "
        r"speed of ([\d.]+) m/s .* works",
    )
    one, other = found.unmet[0].where.split(", ")
    assert one.rpartition("_")[0] != other.rpartition("_")[0]
    assert deep > 0.0
    slower = walk_of(replace(FORWARD, forward=speed), robot=narrow)
    assert foresee_walk(narrow, slower).demand("gap between legs").value >= 0.0


@pytest.mark.slow
def test_on_too_steep_a_slope_the_center_of_mass_is_not_supported():
    steep = Ground(slope=math.radians(58.0), across=math.radians(40.0), friction=3.0)
    found = foresee_walk(HEXABOT, walk_of(FORWARD), IDEAL, ground=steep)
    assert re.match(
        r"the center of mass would be [\d.]+ mm outside of the support by [34] feet at t",
        found.refusal,
    )
    assert "works" in found.refusal
    dynamic = foresee_walk(HEXABOT, walk_of(FORWARD), ground=steep, dynamic=True)
    assert dynamic.refusal is None
    assert dynamic.demand("static margin").value < 0.0
    hill = Ground(slope=math.radians(10.0), across=math.radians(-5.0))
    uphill = foresee_walk(HEXABOT, walk_of(FORWARD), IDEAL, ground=hill)
    assert uphill.refusal is None
    assert 0.05 < uphill.demand("static margin").value < 0.07


def test_where_feet_slide_no_walk_works():
    icy = Ground(slope=math.radians(6.0), friction=0.1)
    says(
        foresee_walk(HEXABOT, walk_of(FORWARD), ground=icy),
        r"the ground slopes by 6 deg, and with a friction of 0\.1 feet slide from 5\.711 deg on: "
        "no slower or lower walk of these feet works",
    )
    assert foresee_walk(HEXABOT, walk_of(FORWARD), ground=Ground(friction=0.05)).refusal is None


@pytest.mark.slow
def test_gaits_that_do_not_suit_the_robot_are_refused():
    five = hexapod(hips={f"leg{i}": Hip(0.1 * math.cos(i), 0.1 * math.sin(i), i) for i in range(5)})
    with pytest.raises(InvalidValueError, match="'tripod' is for 6 legs, and 'hexabot' has 5"):
        foresee_walk(five, walk_of(FORWARD))
    trot = Gait(name="trot", phases=(0.0, 0.5, 0.0, 0.5, 0.0, 0.5), duty=0.45, source="")
    with pytest.raises(
        InvalidValueError,
        match=r"'trot' has only 0 of 6 feet down .*: a duty factor of 0\.5 keeps three; `dynamic",
    ):
        foresee_walk(HEXABOT, walk_of(FORWARD, gait=trot))
    slow = replace(FORWARD, forward=0.02)
    flying = foresee_walk(HEXABOT, walk_of(slow, gait=trot), IDEAL, dynamic=True)
    assert flying.refusal is None
    assert flying.as_json()["worst"]["static margin"]["value"] is None  # no foot is down


def test_feet_that_are_not_on_the_ground_at_the_start_are_refused():
    walk = walk_of(FORWARD)
    with pytest.raises(InvalidValueError, match=r"the foot of left_front is 6 mm in the ground"):
        foresee_walk(HEXABOT, walk, foot_height=0.006)

    step = Ground(steps=Steps(height=-0.03, start=0.1))
    with pytest.raises(InvalidValueError, match="foot of left_front is 30 mm above the ground"):
        foresee_walk(HEXABOT, replace(walk, commands=()), ground=step)


def test_a_joint_at_its_limit_is_within_it():
    knee = starting_posture(HEXABOT)[1]
    for beyond, works in ((5e-7, True), (5e-6, False)):
        segments = [
            replace(one, mechanics=JointMechanics(upper=knee - beyond))
            if one.joint.endswith("knee")
            else one
            for one in HEXABOT.segments
        ]
        robot = replace(HEXABOT, segments=tuple(segments))
        assert (foresee_walk(robot, walk_of()).refusal is None) == works


@pytest.mark.slow
def test_the_greatest_speed_is_that_of_the_body_as_it_is_held_in_the_end():
    low = Attitude(shift=(0.0, 0.0, 0.06), start=9.0)
    raised = foresee_walk(HEXABOT, walk_of(FORWARD, attitudes=[low]), IDEAL)
    already = foresee_walk(HEXABOT, walk_of(FORWARD, height=0.145), IDEAL)
    assert raised.height == pytest.approx(0.145)
    assert raised.greatest_speed == pytest.approx(already.greatest_speed, rel=0.02)
    assert raised.greatest_speed < 0.9 * foresee_walk(HEXABOT, walk_of(), IDEAL).greatest_speed


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"robot": "hexabot"}, "robot is 'hexabot'; it must be a Robot"),
        ({"walk": 3}, "walk is 3; it must be a Walk"),
        ({"servo": "ideal"}, "servo is 'ideal'; it must be a Servo or None"),
        ({"ground": 0.8}, "ground is 0.8; it must be a Ground"),
        ({"gravity": -9.81}, "gravity, by which feet stand, is -9.81 m/s"),
        ({"duration": 0.0}, "the duration is 0.0 s; it must be positive"),
        ({"duration": math.nan}, "the duration is nan s"),
        ({"foot_height": math.inf}, "height of a standing foot is inf"),
    ],
)
def test_wrong_arguments_are_refused(change, said):
    with pytest.raises(InvalidValueError, match=said):
        foresee_walk(**{"robot": HEXABOT, "walk": walk_of(FORWARD), **change})


def test_only_the_time_of_the_run_counts():
    late = Attitude(roll=0.9, start=20.0)
    assert foresee_walk(HEXABOT, walk_of(attitudes=[late])).unmet
    assert not foresee_walk(HEXABOT, walk_of(attitudes=[late]), duration=10.0).unmet


@pytest.mark.slow
def test_numbers_of_the_summary(forward):
    entries = forward.as_json()
    assert entries["refusal"] is None
    assert entries["greatest_speed_m_s"] == entries["greatest_stride_m"]
    assert entries["worst"]["static margin"]["unit"] == "m"
    assert entries["worst"]["dynamic margin"]["limit"] is None


@pytest.mark.slow
def test_a_walk_that_works_keeps_its_course_in_the_simulation_and_a_refused_one_does_not():
    """With contact and torque limits: the greatest speed, and one that the servos cannot follow."""
    fast = walk_of(replace(FORWARD, forward=0.5), period=0.4)
    foresight = foresee_walk(HEXABOT, fast, IDEAL)
    speed = 0.5 * foresight.remedy.share

    def lost(forward):
        command = Command(forward=forward, start=0.5, ramp=1.0, end=3.0)
        config = HexapodConfig(walk=walk_of(command, period=0.4))
        run = simulate(build(config), 4.5, start=start_walking(config), max_step=config.time_step)
        pose = run.scopes["body pose"]
        return 1.0 - (pose[-1, 4] - pose[0, 4]) / (2.5 * forward)

    assert foresight.unmet[0].what == "lag"
    assert lost(0.5) > 0.05
    assert abs(lost(speed)) < 0.045
