"""What makes no sense is refused in a sentence before Drake sees it."""

import pytest
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant

from drake_leg.errors import InvalidValueError
from drake_leg.models.plant import build_plant
from drake_leg.models.sdf import sdf_text
from drake_leg.robot.joint_mechanics import JointMechanics, StateTarget
from drake_leg.robot.robots import LEG_A, LEG_B
from drake_leg.systems.frame_sensor import FrameSensor
from drake_leg.systems.input_filter import InputFilter
from drake_leg.systems.joint_stops import JointStops
from drake_leg.systems.prescribed_motion import PrescribedMotion

LEG = build_plant(LEG_B)


def discrete():
    plant = MultibodyPlant(0.001)
    Parser(plant).AddModelsFromString(sdf_text(LEG_B), "sdf")
    plant.Finalize()
    return plant


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: InputFilter(0), "size is 0"),
        (lambda: InputFilter(1.5), "size is 1.5"),
        (lambda: InputFilter(2, initial="a"), "'a'"),
        (lambda: PrescribedMotion(MultibodyPlant(0.0)), "not finalized"),
        (lambda: PrescribedMotion(MultibodyPlant(0.0), ["j"]), "not finalized"),
        (lambda: PrescribedMotion(None), "None"),
        (lambda: PrescribedMotion(discrete(), ["hip"]), "discrete"),
        (lambda: PrescribedMotion(LEG, [0]), "0 is not a joint"),
        (
            lambda: PrescribedMotion(LEG, [build_plant(LEG_A).GetJointByName("hip")]),
            "not a joint of the plant",
        ),
        (lambda: JointStops(MultibodyPlant(0.0), {"hip": JointMechanics()}), "not finalized"),
        (lambda: JointStops(LEG, {"hip": 3}), "'hip' are 3"),
        (lambda: FrameSensor(LEG, "foot"), "'foot' is not a frame"),
        (lambda: StateTarget(value="30"), "'30'"),
        (lambda: StateTarget(value=None), "None"),
        (lambda: JointMechanics(lower="a"), "'a'"),
        (lambda: JointMechanics(damping="x"), "'x'"),
    ],
)
def test_nonsense_is_one_sentence(make, said):
    with pytest.raises(InvalidValueError, match=said) as caught:
        make()
    assert "\n" not in str(caught.value)


def test_one_name_is_no_list_of_letters():
    assert PrescribedMotion(LEG, "hip").GetInputPort("q").size() == 1
