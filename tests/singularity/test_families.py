"""Families have their names once: near a singularity everything that names one names the same."""

import math

import numpy as np
import pytest

from drake_leg.kinematics.chain import geometry_of
from drake_leg.kinematics.leg import LegGeometry, MovableLeg
from drake_leg.robot.robots import LEG_A, LEG_B, PENDULUM, SCARA
from drake_leg.singularity.doctor import examine_posture
from drake_leg.singularity.families import families_of, singular_words
from drake_leg.singularity.forecast import encounter_at


@pytest.mark.slow
@pytest.mark.parametrize("robot", [LEG_A, LEG_B], ids=["A", "B"])
def test_doctor_encounter_and_words_name_one_family(rng, robot):
    leg = MovableLeg(LegGeometry.from_robot(robot))
    near = [q for q in rng.uniform(-math.pi, math.pi, (4000, 3)) if leg.sigma_min(q) < 0.0025]
    assert len(near) > 50
    named = set()
    for q in near:
        family = families_of(leg.geometry).nearness(q)[0].family
        assert encounter_at(leg, q, 0.0).family == family
        on_axis = singular_words(leg.geometry, q) == "the foot is nearly on the hip axis"
        assert on_axis == (family == "hip-axis")
        named.add(family)
    assert named == {"stretch", "hip-axis"}
    for q in near[:5]:
        family = families_of(leg.geometry).nearness(q)[0].family
        assert examine_posture(robot, q.tolist()).as_json()["nearest_family"] == family


def test_what_has_no_named_family_is_just_singular():
    assert families_of(geometry_of(PENDULUM)) is None
    assert singular_words(geometry_of(PENDULUM), [0.1]) == "the robot is nearly singular"
    assert singular_words(geometry_of(PENDULUM), [0.1], "") == "the robot is singular"
    assert singular_words(geometry_of(SCARA), [0.1, np.pi, 0.3]) == "the arm is nearly folded"
