"""Frames of solids' own, as files have them."""

import pytest
from slx_writer import ModelBuilder

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.multibody.frames import own_frames, require_no_own_frames
from drake_leg.simulink.reader import read_model

BRICK = "sm_lib/Body Elements/Brick Solid"


def frames(*names):
    return "".join(
        f"<Frame><Id>Frame{place}</Id><Value><Name>{name}</Name><Origin>"
        "<Source>GeometricFeature</Source><FeatureName>+z surface</FeatureName></Origin>"
        "</Value></Frame>"
        for place, name in enumerate(names, 1)
    )


def model_of(path, count):
    builder = ModelBuilder()
    builder.add_library(BRICK, "plain", {"SerializedFrames": "<Frames/>"})
    for place in range(count):
        texts = {"SerializedFrames": f"<Frames>{frames('B', 'F')}</Frames>"}
        builder.add_library(BRICK, f"brick{place}", texts)
    return read_model(builder.write(path / "m.slx"))


def test_names_are_in_the_order_of_the_file(tmp_path):
    found = {block.name: own_frames(block) for block in model_of(tmp_path, 1).blocks}
    assert found == {"plain": (), "brick0": ("B", "F")}


def test_all_solids_with_frames_are_listed_at_once_up_to_a_screen(tmp_path):
    require_no_own_frames(model_of(tmp_path, 0))
    with pytest.raises(InvalidValueError, match="3 solids have") as caught:
        require_no_own_frames(model_of(tmp_path, 3))
    assert [f"'brick{place}'" in str(caught.value) for place in range(3)] == [True] * 3
    with pytest.raises(InvalidValueError, match="and 2 more"):
        require_no_own_frames(model_of(tmp_path, 22))
