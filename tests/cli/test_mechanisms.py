"""``drake-leg sdf`` and ``view`` of Simulink models."""

import pytest
from mechanism_models import MechanismBuilder, four_bar, pendulum
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant

from drake_leg.cli import main
from drake_leg.cli.mechanisms import mechanism_in_3d
from drake_leg.scene.motion import at_rest
from drake_leg.scene.scene import scene_of


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def run(capsys, *words):
    status = main([*map(str, words)])
    return (status, *capsys.readouterr())


def test_a_mechanism_is_written_and_drake_reads_it(here, capsys):
    pendulum().write(here / "m.slx")
    status, out, err = run(capsys, "sdf", "m.slx", "--out", "m.sdf")
    assert (status, err) == (0, "")
    assert out.startswith("wrote m.sdf: 1 body, 1 joint, 0.4 kg; 6 frames and the inertia of 1 ")
    plant = MultibodyPlant(0.0)
    Parser(plant).AddModels("m.sdf")
    assert run(capsys, "sdf", "m.slx")[1] == (here / "m.sdf").read_text(encoding="utf-8")


def test_what_is_not_in_the_sdf_is_said(here, capsys):
    built = four_bar()
    built.add_library("sm_lib/Forces and Torques/External Force and Torque", "Push")
    built.body("Spherical Solid", "Ball", SphereRadius="1")
    built.transform("Beside")
    built.meet("Ball", "Beside lconn:1")
    built.write(here / "m.slx")
    status, _, err = run(capsys, "sdf", "m.slx", "--out", "m.sdf")
    assert status == 0
    assert "left out, as SDF has no such element: External Force and Torque (1)" in err
    assert "the tree that is cut at D, with the two frames" in err
    assert "so they float: Ball" in err


def test_all_that_is_missing_is_said_with_the_file(here, capsys):
    pendulum(SpringStiffness="stiff").set("Rod", Density="heavy").write(here / "m.slx")
    for words in (("sdf", "m.slx", "--out", "m.sdf"), ("view", "m.slx", "--still", "m.png")):
        status, out, err = run(capsys, *words)
        assert (status, out) == (2, "")
        assert err.startswith("drake-leg: m.slx: 2 things are missing for a mechanism\n")
        assert "'stiff'" in err
        assert "'heavy'" in err
    assert [path.name for path in here.iterdir()] == ["m.slx"]


def test_a_value_is_set_once(here, capsys):
    pendulum().set("Rod", Density="rho").write(here / "m.slx")
    for words in (("--set", "rho=1", "--set", "rho=2"), ("--set", "rho=1,rho=2")):
        status, _, err = run(capsys, "sdf", "m.slx", *words)
        assert (status, err) == (2, "drake-leg: --set gives rho twice: keep one of the values\n")


def test_values_come_from_the_script_that_a_person_would_run(here, capsys):
    pendulum().set("Rod", Density="rho").write(here / "m.slx")
    assert run(capsys, "sdf", "m.slx", "--set", "rho=500")[0] == 0
    assert run(capsys, "sdf", "m.slx", "--out", "m.sdf")[0] == 2
    (here / "setup.m").write_text("clear all\nrho = 2000;\n", encoding="utf-8")
    status, out, err = run(capsys, "sdf", "m.slx", "--out", "m.sdf")
    assert (status, "0.8 kg" in out) == (0, True)
    assert "rho taken from" in err
    assert "setup.m: give --init to choose another file" in err
    (here / "other.m").write_text("rho = 3000;\n", encoding="utf-8")
    err = run(capsys, "sdf", "m.slx")[2]
    assert "rho taken from" in err
    assert "setup.m would set as many)" in err
    words = ("--out", "m.sdf", "--overwrite", "--init", "other.m")
    status, out, err = run(capsys, "sdf", "m.slx", *words)
    assert (status, "1.2 kg" in out, err) == (0, True, "")


@pytest.mark.slow
def test_a_mechanism_stands_at_its_targets(here, capsys):
    pendulum(PositionTargetSpecify="on", PositionTargetValue="30").write(here / "m.slx")
    assert run(capsys, "view", "m.slx", "--still", "m.png") == (0, "wrote m.png\n", "")
    assert (here / "m.png").stat().st_size > 5000
    status, out, _ = run(capsys, "view", "m.slx", "--once")
    assert status == 0
    assert out.startswith("m: http://localhost:")


@pytest.mark.parametrize(
    "words",
    [
        ("sdf", "m.slx", "--toml"),
        ("sdf", "m.slx", "--par"),
        ("view", "m.slx", "--q", "0"),
        ("sdf", "leg-b", "--path", "."),
        ("view", "leg-b", "--variant", "A=B"),
        ("view", "leg-b", "--init", "setup.m"),
    ],
)
def test_options_of_the_other_kind_are_refused(here, capsys, words):
    pendulum().write(here / "m.slx")
    status, out, err = run(capsys, *words)
    assert (status, out) == (2, "")
    assert err.startswith(f"drake-leg: {words[2]} ")


def test_a_feature_of_a_cad_program_is_placed_by_an_option(here, capsys):
    built = pendulum()
    on = "<Source>GeometricFeature</Source><FeatureName>segment 3</FeatureName>"
    frame = (
        f"<Frames><Frame><Name>F1</Name><Origin>{on}</Origin><PrimaryAxis>{on}"
        "<DefinedDirection>+Z</DefinedDirection></PrimaryAxis><SecondaryAxis>"
        "<Source>ReferenceFrame</Source><SourceDirection>+X</SourceDirection>"
        "<DefinedDirection>+X</DefinedDirection></SecondaryAxis></Frame></Frames>"
    )
    given = {"ExtGeomFileName": "leg.step", "InertiaType": "PointMass", "Mass": "1"}
    built.body("File Solid", "Leg", SerializedFrames=frame, DoExposeReferenceFrame="off", **given)
    built.meet("Down", "Leg lconn:1")
    built.write(here / "m.slx")
    status, _, err = run(capsys, "sdf", "m.slx")
    assert (status, err.partition(": give ")[2]) == (
        2, "--feature 'leg.step:segment 3=X,Y,Z,DX,DY,DZ' [m], in the solid's reference frame\n"
           "      its places are listed where it lies beside the model or in a given folder\n"
    )  # fmt: skip
    for words in (("sdf",), ("port", "--out", "p.py"), ("run", "--out", "r", "--duration", "0.01")):
        command, *more = words
        place = ("--feature", "leg.step:segment 3=0,0,0.1,0,0,1")
        assert run(capsys, command, "m.slx", *place, *more)[0] == 0
    for wrong, said in (("leg.step=0,0,0", "names no feature"), ("leg.step:segment 3=a", "number")):
        status, _, err = run(capsys, "sdf", "m.slx", "--feature", wrong)
        assert (status, said in err) == (2, True)


def test_a_picture_names_the_shapes_that_it_lacks(here):
    built = pendulum()
    given = {"ExtGeomFileName": "leg.step", "InertiaType": "PointMass", "Mass": "1"}
    built.body("File Solid", "Leg", **given)
    built.meet("Down", "Leg lconn:1")
    with mechanism_in_3d(built.mechanism(here), [here]) as shown:
        assert shown.notes[0] == "not shown, as no such file was found: leg.step"
        assert not shown.shows_frames
        assert scene_of(at_rest(shown)).notes[0] == shown.notes[0]


def test_a_picture_names_no_bodies_for_which_no_rods_stand(here):
    """The links between the axes of one joint have no length."""
    built = MechanismBuilder()
    built.joint("Planar", "Sliding")
    built.body("Spherical Solid", "Ball", SphereRadius="0.1")
    built.meet("World", "Sliding lconn:1")
    built.meet("Sliding", "Ball")
    with mechanism_in_3d(built.mechanism(here), [here]) as shown:
        assert shown.notes == ()
