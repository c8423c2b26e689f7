import math

import numpy as np
import pytest

from drake_leg.errors import DrakeLegError, InvalidValueError
from drake_leg.robot_file import read_robot
from drake_leg.robots import LEG_B, SCARA
from drake_leg.scene.meshcat import MeshcatError, frame_path, open_meshcat
from drake_leg.scene.motion import still
from drake_leg.scene.scene import scene_of
from drake_leg.scene.viewer import CLEAR, QUIT, START, joint_sliders, open_browser, view_robot

Q = np.radians([90.0, -50.0, -90.0])
LIMITED = """
name = "limited"
angles = "deg"
row = [{ sigma = 0, d = 0.1, alpha = 0, r = 0, theta = 0, limits = { lower = -30, upper = 60 } }]
"""


@pytest.fixture
def meshcat():
    return open_meshcat()


def click(meshcat, label):
    """Send what a browser sends when a button is clicked."""
    name = label.encode()
    meshcat._InjectWebsocketMessage(
        b"\x82\xa4type\xa6button\xa4name" + bytes([0xA0 + len(name)]) + name
    )


def script(*actions):
    """Make a ``wait`` that carries out one action at a time, then quits."""
    left = list(actions)

    def wait(seconds):
        assert 0.0 < seconds < 0.1
        left.pop(0)()

    return wait


def test_sliders_have_the_joints_units_and_limits():
    turn = joint_sliders(LEG_B, Q)[1]
    assert (turn.name, turn.low, turn.high) == ("knee [deg]", -180.0, 180.0)
    assert turn.value == pytest.approx(-50.0)
    assert turn.unit == pytest.approx(math.pi / 180.0)
    lift = joint_sliders(SCARA, [0.0, 0.0, 0.0, 0.06])[3]
    assert (lift.name, lift.unit) == ("lift [mm]", 1e-3)
    assert lift.value == pytest.approx(60.0)
    (limited,) = joint_sliders(read_robot(LIMITED, "limited"), [0.0])
    assert (limited.low, limited.high) == pytest.approx((-30.0, 60.0))


def test_a_posture_outside_the_limits_is_on_the_slider():
    (slider,) = joint_sliders(read_robot(LIMITED, "limited"), [2.0])
    assert slider.high == slider.value == pytest.approx(math.degrees(2.0))


def test_the_sliders_move_the_robot_and_escape_ends(meshcat):
    left = view_robot(
        LEG_B,
        Q,
        meshcat,
        wait=script(
            lambda: meshcat.SetSliderValue("hip [deg]", 45.0),
            lambda: click(meshcat, "Right"),
            lambda: click(meshcat, QUIT),
        ),
    )
    np.testing.assert_allclose(left, np.radians([45.0, -50.0, -90.0]), atol=1e-12)
    assert meshcat.GetSliderNames() == []
    for part in scene_of(still(LEG_B, Q)).parts:
        if "floor" not in part.path:
            assert meshcat.HasPath(f"/drake/{frame_path(part.frame)}/{part.path}")


def test_buttons_take_the_robot_back_and_the_trace_away(meshcat):
    trace = f"/drake/{frame_path(0)}/trace"
    there = []
    left = view_robot(
        LEG_B,
        Q,
        meshcat,
        wait=script(
            lambda: meshcat.SetSliderValue("ankle [deg]", -20.0),
            lambda: there.append(meshcat.HasPath(trace)),
            lambda: click(meshcat, CLEAR),
            lambda: there.append(meshcat.HasPath(trace)),
            lambda: click(meshcat, START),
            lambda: None,
            lambda: click(meshcat, QUIT),
        ),
    )
    assert there == [True, False]
    np.testing.assert_allclose(left, Q, atol=1e-12)


def test_a_taken_port_is_one_sentence(meshcat):
    with pytest.raises(MeshcatError, match=f"port {meshcat.port()}: the port is taken"):
        open_meshcat(port=meshcat.port())
    with pytest.raises(DrakeLegError, match="--port is 80; it must be in 1024"):
        open_meshcat(port=80)


def test_meshcat_serves_this_machine_only(meshcat):
    assert meshcat.web_url().startswith("http://localhost:")


def test_without_a_screen_no_browser_is_opened(monkeypatch):
    monkeypatch.setattr("sys.platform", "linux")
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    assert not open_browser("http://localhost:7000")


def test_a_posture_of_another_size_is_refused(meshcat):
    with pytest.raises(InvalidValueError, match="must be 3 long"):
        view_robot(LEG_B, [0.0], meshcat, once=True)
