"""How far a foot driven by hand follows its command."""

import numpy as np
import pytest

from drake_leg.errors import SingularConfigurationError
from drake_leg.kinematics.chain import movable
from drake_leg.kinematics.leg import LegGeometry
from drake_leg.robot.robots import LEG_B
from drake_leg.singularity.look_ahead import SLOW, STOP, braked, room

LEG = movable(LEG_B)


def bent(ankle):
    """Return a posture whose smallest singular value the ankle alone makes small."""
    return [np.pi / 2, -0.5, ankle]


def along_the_leg(q):
    leg = LegGeometry.from_robot(LEG_B)
    knee = np.array([0.0, leg.l1, 0.0])
    way = LEG.foot(q) - knee
    return way / np.linalg.norm(way)


def ankle_where_sigma_is(share):
    angles = np.linspace(-0.001, -1.0, 4000)
    sigma = np.array([LEG.sigma_min(bent(angle)) for angle in angles]) / LEG.length
    return float(angles[np.abs(sigma - share).argmin()])


def test_far_from_singularities_and_slowly_all_of_a_command_acts():
    assert braked(LEG, bent(-1.5), [0.01, 0.02, 0.0]) == (1.0, "")


def test_no_joint_goes_faster_than_it_may():
    q, v = bent(-1.5), [0.0, 3.0, 0.0]
    share, obstacle = braked(LEG, q, v, fastest=2.0)
    assert share * np.abs(LEG.rates(q, v)).max() == pytest.approx(2.0)
    assert obstacle == "a joint is at its greatest speed"


def test_near_a_singularity_what_goes_nearer_is_slowed_and_what_leaves_it_is_not():
    q = bent(ankle_where_sigma_is((STOP + SLOW) / 2.0))
    out = (0.001 * along_the_leg(q)).tolist()
    share, obstacle = braked(LEG, q, out)
    assert share == pytest.approx(room(LEG, LEG.sigma_min(q)))
    assert share == pytest.approx(0.5, abs=0.01)
    assert obstacle == "the leg is nearly stretched"
    assert braked(LEG, q, [-part for part in out]) == (1.0, "")


def test_nearest_to_a_singularity_nothing_goes_nearer():
    q = bent(ankle_where_sigma_is(0.9 * STOP))
    assert braked(LEG, q, (0.001 * along_the_leg(q)).tolist()).share == 0.0


def test_a_singular_posture_is_refused():
    with pytest.raises(SingularConfigurationError):
        braked(LEG, bent(0.0), [0.0, 0.0, 0.01])


def test_a_foot_at_rest_is_not_braked():
    assert braked(LEG, bent(-1.0), [0.0, 0.0, 0.0]) == (1.0, "")
