"""Frames on features of CAD programs' files: placed by a person, or the only ones of their kind."""

import numpy as np
import pytest
from cad_files import FEATURE, PART, frame, open_cascade, write
from mechanism_models import pendulum

from drake_leg.errors import InvalidValueError, UnplacedFeatureError
from drake_leg.simulink.dynamics.system import mechanism_dynamics
from drake_leg.simulink.multibody.step_places import only_place
from drake_leg.simulink.running.ported import mechanism_from
from drake_leg.simulink.running.porting.mechanism import mechanism_data


def legs(*names, **more):
    """Solids of one file that hang on a pendulum by frames on a feature of it."""
    built = pendulum()
    for name in names:
        built.body("File Solid", name, SerializedFrames=frame(**more), **PART)
        built.meet("Down", f"{name} lconn:1")
    return built


def center(mechanism):
    """Return where the reference frame of the solid A is in its body, (4, 4) [m]."""
    solids = mechanism.bodies[1].solids
    return next(X_BR for solid, X_BR in solids if solid.block.name == "A")


def test_a_feature_is_where_a_person_says(tmp_path):
    there = {f"leg.step:{FEATURE}": [0.1, 0.0, 0.02]}
    without = legs("A").mechanism(tmp_path, features={f"Leg.STEP:{FEATURE}": [0.0, 0.0, 0.0]})
    moved = center(legs("A").mechanism(tmp_path, features=there)) - center(without)
    np.testing.assert_allclose(np.linalg.norm(moved[:3, 3]), np.hypot(0.1, 0.02))


def test_a_frame_along_a_feature_takes_its_direction(tmp_path):
    built = legs("A", primary=FEATURE)
    name = f"leg.step:{FEATURE}"
    with pytest.raises(InvalidValueError, match=r"give a place and a direction to 'Leg\.STEP:cyl"):
        built.mechanism(tmp_path, features={name: [0.0, 0.0, 0.0]})
    straight = center(built.mechanism(tmp_path, features={name: [0, 0, 0, 0, 0, 2]}))
    turned = center(built.mechanism(tmp_path, features={name: [0, 0, 0, 0, 1, 0]}))
    R = straight[:3, :3].T @ turned[:3, :3]
    np.testing.assert_allclose(R @ [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], atol=1e-12)


def test_all_that_are_not_placed_are_named_once(tmp_path):
    with pytest.raises(InvalidValueError) as caught:
        legs("A", "B").mechanism(tmp_path)
    assert str(caught.value) == (
        "'A', 'B' have a frame on 'cylindrical surface 6' of 'Leg.STEP', which takes a CAD program "
        "to find: give a place to 'Leg.STEP:cylindrical surface 6' in the solid's reference frame"
        "\n      its places are listed where it lies beside the model or in a given folder"
    )
    error = UnplacedFeatureError(file="a.step", feature="f", directed=True)
    assert (error.file, error.feature, error.directed) == ("a.step", "f", True)


@pytest.mark.parametrize(
    ("name", "numbers", "sentence"),
    [
        (f"log.step:{FEATURE}", [0, 0, 0], "did you mean leg.step"),
        ("leg.step:segment 3", [0, 0, 0], "no frame of a solid is on the feature"),
        (f"leg.step:{FEATURE}", [0, 0], "is placed at 2 numbers: give a point"),
        (f"leg.step:{FEATURE}", [0, 0, 0, 0, 0, 0], "the direction of the feature .* is 0"),
    ],
)
def test_a_place_that_means_nothing_is_refused(tmp_path, name, numbers, sentence):
    with pytest.raises(InvalidValueError, match=sentence):
        legs("A").model(tmp_path, features={name: numbers})


def test_a_feature_is_placed_once(tmp_path):
    """Windows does not tell the letters of files apart."""
    places = {f"{file}:{FEATURE}": [0, 0, 0] for file in ("leg.step", "Leg.STEP")}
    with pytest.raises(InvalidValueError, match="is placed twice: keep one"):
        legs("A").model(tmp_path, features=places)


def test_a_script_knows_the_places(tmp_path):
    features = {f"leg.step:{FEATURE}": (0.1, 0.0, 0.02)}
    model = legs("A").model(tmp_path, features=features)
    data = mechanism_data(model, "smooth")
    assert data["features"] == {f"leg.step:{FEATURE}": [0.1, 0.0, 0.02]}
    ours, theirs = mechanism_dynamics(model), mechanism_from(data)
    systems = [each.CreateDefaultContext() for each in (ours, theirs)]
    found = [
        system.EvalTimeDerivatives(context).CopyToVector()
        for system, context in zip((ours, theirs), systems, strict=True)
    ]
    np.testing.assert_array_equal(*found)


@pytest.mark.slow
def test_the_only_one_of_its_kind_is_found_and_told(tmp_path):
    open_cascade()
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox, BRepPrimAPI_MakeCylinder
    from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt

    def drilled(*holes):
        shape = BRepPrimAPI_MakeBox(100.0, 40.0, 20.0).Shape()
        for x in holes:
            axis = gp_Ax2(gp_Pnt(x, 20.0, 0.0), gp_Dir(0, 0, 1))
            hole = BRepPrimAPI_MakeCylinder(axis, 5.0, 20.0).Shape()
            shape = BRepAlgoAPI_Cut(shape, hole).Shape()
        return shape

    path = write(tmp_path / "leg.step", drilled(30.0))
    np.testing.assert_allclose(only_place(path, FEATURE), [0.03, 0.02, 0.01], atol=1e-12)
    assert only_place(path, "planar surface 2") is None
    assert only_place(path, "circular curve 1") is None  # two rims
    assert only_place(path, "spherical surface 1") is None
    mechanism = legs("A").mechanism(tmp_path)
    ((name, point),) = mechanism.connections.only.items()
    assert name == f"Leg.STEP:{FEATURE}"
    np.testing.assert_allclose(point, [0.03, 0.02, 0.01], atol=1e-12)
    by_hand = {f"leg.step:{FEATURE}": [0.0, 0.0, 0.0]}
    assert not legs("A").mechanism(tmp_path, features=by_hand).connections.only
    two = write(tmp_path / "two.step", drilled(30.0, 70.0))
    assert only_place(two, FEATURE) is None
