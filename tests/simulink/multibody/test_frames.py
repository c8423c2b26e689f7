"""Frames of solids' own, as files have them."""

from slx_writer import ModelBuilder

from drake_leg.simulink.multibody.frames import read_frames
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
    blocks = model_of(tmp_path, 1).blocks
    found = {block.name: [frame.name for frame in read_frames(block)] for block in blocks}
    assert found == {"plain": [], "brick0": ["B", "F"]}
