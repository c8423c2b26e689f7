"""Rigid Transform blocks against SciPy's rotations and against each other."""

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.mechanism import about, inverse, pose, rigid_transform, rotation_text
from drake_leg.simulink.model import Block


def transform(**parameters):
    block = Block(
        sid="1",
        name="Rigid Transform",
        type="Reference",
        source="sm_lib/Frames and Transforms/Rigid Transform",
        system="",
        parameters=parameters,
    )
    return rigid_transform(block)


def quarter(axis):
    return Rotation.from_euler(axis, 90, degrees=True).as_matrix()


def test_nothing_is_the_identity():
    np.testing.assert_array_equal(transform(), np.eye(4))


@pytest.mark.parametrize("axis", ["+X", "-X", "+Y", "-Y", "+Z", "-Z"])
def test_standard_axis(axis):
    R = transform(
        RotationMethod="StandardAxis", RotationStandardAxis=axis, RotationAngle=math.pi / 2
    )[:3, :3]
    expected = quarter(axis[1].lower())
    np.testing.assert_allclose(R, expected if axis[0] == "+" else expected.T, atol=1e-15)
    along = transform(
        TranslationMethod="StandardAxis",
        TranslationStandardAxis=axis,
        TranslationStandardOffset=2.0,
    )
    assert along[:3, 3] @ np.eye(3)["XYZ".index(axis[1])] == (2.0 if axis[0] == "+" else -2.0)


def test_all_ways_to_say_a_quarter_turn_about_x_agree():
    ways = [
        {
            "RotationMethod": "StandardAxis",
            "RotationStandardAxis": "+X",
            "RotationAngle": math.pi / 2,
        },
        {
            "RotationMethod": "ArbitraryAxis",
            "RotationArbitraryAxis": (3.0, 0.0, 0.0),
            "RotationAngle": math.pi / 2,
        },
        {
            "RotationMethod": "AlignedAxes",
            "FollAlignAxisA": "+Z",
            "BaseAlignAxisA": "-Y",
            "FollAlignAxisB": "+X",
            "BaseAlignAxisB": "+X",
        },
        {
            "RotationMethod": "RotationSequence",
            "RotationSequence": "XYZ",
            "RotationSequenceAngles": (math.pi / 2, 0.0, 0.0),
        },
        {
            "RotationMethod": "RotationMatrix",
            "RotationMatrix": ((1.0, 0.0, 0.0), (0.0, 0.0, -1.0), (0.0, 1.0, 0.0)),
        },
        {"RotationMethod": "Quaternion", "RotationQuaternion": (1.0, 1.0, 0.0, 0.0)},
    ]
    for way in ways:
        np.testing.assert_allclose(transform(**way)[:3, :3], quarter("x"), atol=1e-15)


def test_sequences_are_about_the_follower_or_the_base():
    angles = (0.3, -0.5, 0.9)
    common = {"RotationMethod": "RotationSequence", "RotationSequence": "ZYX"}
    common["RotationSequenceAngles"] = angles
    follower = transform(**common, RotationSequenceAxes="FollowerAxes")[:3, :3]
    base = transform(**common, RotationSequenceAxes="BaseAxes")[:3, :3]
    turns = [
        Rotation.from_euler(axis, angle).as_matrix()
        for axis, angle in zip("zyx", angles, strict=True)
    ]
    np.testing.assert_allclose(follower, turns[0] @ turns[1] @ turns[2], atol=1e-15)
    np.testing.assert_allclose(base, turns[2] @ turns[1] @ turns[0], atol=1e-15)


def test_cylindrical_translation():
    X = transform(
        TranslationMethod="Cylindrical",
        TranslationCylindricalRadius=2.0,
        TranslationCylindricalTheta=math.pi / 3,
        TranslationCylindricalZOffset=0.5,
    )
    np.testing.assert_allclose(X[:3, 3], [1.0, math.sqrt(3.0), 0.5], atol=1e-15)


def test_translation_comes_before_the_turn():
    X = transform(
        TranslationMethod="Cartesian",
        TranslationCartesianOffset=(1.0, 2.0, 3.0),
        RotationMethod="StandardAxis",
        RotationStandardAxis="+Z",
        RotationAngle=math.pi / 2,
    )
    np.testing.assert_array_equal(X[:3, 3], [1.0, 2.0, 3.0])


def test_inverse(rng):
    X = pose(Rotation.random(random_state=1).as_matrix(), rng.normal(size=3))
    np.testing.assert_allclose(inverse(X) @ X, np.eye(4), atol=1e-15)


def test_rotation_text():
    assert rotation_text(np.eye(3)) == "no rotation"
    assert rotation_text(about("y", -math.pi / 2)[:3, :3]) == "90 deg about -y"
    assert rotation_text(Rotation.from_rotvec([0.1, 0.1, 0]).as_matrix()).startswith("8.1")


@pytest.mark.parametrize(
    "parameters",
    [
        {"RotationMethod": "Telepathy"},
        {"TranslationMethod": "Telepathy"},
        {"RotationMethod": "StandardAxis", "RotationStandardAxis": "+W"},
        {"RotationMethod": "ArbitraryAxis", "RotationArbitraryAxis": (0.0, 0.0, 0.0)},
        {"RotationMethod": "Quaternion", "RotationQuaternion": (0.0, 0.0, 0.0, 0.0)},
        {"RotationMethod": "RotationMatrix", "RotationMatrix": ((1.0, 0.0), (0.0, 1.0))},
        {"RotationMethod": "RotationSequence", "RotationSequence": "XQZ"},
        {"TranslationMethod": "Cartesian", "TranslationCartesianOffset": (1.0, 2.0)},
        {
            "RotationMethod": "AlignedAxes",
            "FollAlignAxisA": "+Z",
            "BaseAlignAxisA": "+Z",
            "FollAlignAxisB": "+Z",
            "BaseAlignAxisB": "+X",
        },
    ],
)
def test_what_makes_no_rotation_is_refused_by_name(parameters):
    if parameters.get("RotationMethod") == "RotationSequence":
        parameters = parameters | {"RotationSequenceAngles": (0.1, 0.2, 0.3)}
    with pytest.raises(InvalidValueError, match=r"'Rigid Transform' \(SID 1\)"):
        transform(**parameters)
