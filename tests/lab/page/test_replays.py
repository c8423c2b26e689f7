"""Replays packed into one page come out as they were."""

import base64
import gzip
import json

import pytest

from drake_leg.lab.page.pieces import UnlikeReplaysError, packed

VIEWER = '<script type="text/javascript">\nlet viewer = "×";\n</script>'
PAGES = {name: f"<html><title>{name}</title>{VIEWER}<p>{name} ≤ 1</p></html>" for name in "ab"}


def inflated(text):
    return gzip.decompress(base64.b64decode(text)).decode()


def test_what_is_packed_can_be_put_together_again():
    read = json.loads(packed(PAGES))
    for name, page in PAGES.items():
        before, after = json.loads(inflated(read["pages"][name]))
        assert before + inflated(read["viewer"]) + after == page


def test_it_is_the_same_every_time_and_safe_inside_a_script():
    text = packed(PAGES)
    assert text == packed(PAGES)
    assert "<" not in text


@pytest.mark.parametrize(
    ("page", "said"),
    [("<p>nothing</p>", "'c' has no viewer"), (VIEWER.replace("×", "÷"), "2 different viewers")],
)
def test_pages_of_another_kind_are_refused(page, said):
    with pytest.raises(UnlikeReplaysError, match=said):
        packed({**PAGES, "c": page})
