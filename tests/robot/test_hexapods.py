import math

import numpy as np
import pytest

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.khalil import base_transforms
from drake_leg.robot.hexapods import HEXABOT, HIPS, Hip, hexapod
from drake_leg.robot.joint_mechanics import starting_posture
from drake_leg.robot.robots import LEG_B
from drake_leg.robot.solids import mass_properties


def test_the_hexabot_is_one_table_of_six_legs_of_report_b():
    assert len(HEXABOT.rows) == 24
    assert list(HEXABOT.tips) == [f"{leg}_foot" for leg in HIPS]
    for first in range(0, 24, 4):
        for own, reports in zip(HEXABOT.rows[first + 1 : first + 4], LEG_B.rows[1:], strict=True):
            assert (own.joint, own.d, own.alpha) == (reports.joint, reports.d, reports.alpha)


def test_hips_are_where_they_are_asked_for_and_legs_point_along_their_yaw():
    X_B = base_transforms(HEXABOT.rows, np.zeros(18))
    for hip, X in zip(HIPS.values(), X_B[::4], strict=True):
        assert X[:3, 3] == pytest.approx([hip.x, hip.y, 0.0], abs=1e-15)
        assert X[:3, 0] == pytest.approx([math.cos(hip.yaw), math.sin(hip.yaw), 0.0], abs=1e-15)
    raised = base_transforms(HEXABOT.rows, np.tile([0.0, 0.3, 0.0], 6))
    assert (raised[3::4, 2, 3] > 0.05).all()


def test_it_weighs_what_its_parts_weigh():
    links = [HEXABOT.base_link, *(segment.link for segment in HEXABOT.segments)]
    masses = [mass_properties(link.solid).mass for link in links]
    assert sum(masses) == pytest.approx(2.16, abs=0.01)


def test_wrong_numbers_are_refused():
    with pytest.raises(InvalidValueError, match=r"length of the femur is -0\.1 m"):
        hexapod(lengths=(0.05, -0.1, 0.1))
    with pytest.raises(InvalidValueError, match="must be three finite numbers"):
        hexapod(lengths=(0.05, 0.1))
    with pytest.raises(InvalidValueError, match=r"the hip a is \(1, 2\); it must be a Hip"):
        hexapod(hips={"a": (1, 2)})
    with pytest.raises(InvalidValueError, match="the height is nan"):
        hexapod(height=math.nan)
    with pytest.raises(InvalidValueError, match="there is no hip"):
        hexapod(hips={})
    with pytest.raises(InvalidValueError, match="yaw of the hip nose is nan"):
        hexapod(hips={"nose": Hip(0.1, 0.0, math.nan)})


def test_it_stands_on_its_feet_at_the_start():
    X_B = base_transforms(HEXABOT.rows, starting_posture(HEXABOT))
    feet = X_B[3::4, :3, 3]
    assert feet[:, 2] == pytest.approx([-0.085] * 6, abs=1e-15)
    for hip, foot in zip(HIPS.values(), feet, strict=True):
        assert math.hypot(foot[0] - hip.x, foot[1] - hip.y) == pytest.approx(0.130, abs=1e-15)
    assert HEXABOT.base_pose[2][3] == 0.085
    with pytest.raises(InvalidValueError, match=r"0\.3 m below its hip .* between 0 and 0\.2 m"):
        hexapod(height=0.3)
