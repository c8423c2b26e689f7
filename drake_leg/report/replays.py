"""The replays inside the page, compressed: their common viewer once, and the rest of each."""

from __future__ import annotations

import base64
import gzip
import json
import re
from collections.abc import Mapping

from drake_leg.errors import DrakeLegError

VIEWER = re.compile(r'<script type="text/javascript">.*?</script>', re.DOTALL)


class UnlikeReplaysError(DrakeLegError):
    """The replays have different viewers, so one copy cannot serve all."""


def packed(pages: Mapping[str, str]) -> str:
    """Pack pages (name -> HTML) that play motions with the same viewer; ``report.js`` unpacks them.

    The JSON has ``viewer`` and, under ``pages``, what is before and after it on each; both are
    compressed by gzip and in base64.

    Raises
    ------
    UnlikeReplaysError
        If a page has no viewer or another one.
    """
    viewers, rests = set(), {}
    for name, page in pages.items():
        found = VIEWER.search(page)
        if found is None:
            raise UnlikeReplaysError(f"the replay {name!r} has no viewer in it")
        viewers.add(found[0])
        rests[name] = _compressed(json.dumps([page[: found.start()], page[found.end() :]]))
    if not pages:
        return json.dumps({"viewer": "", "pages": {}})
    if len(viewers) != 1:
        raise UnlikeReplaysError(f"{len(pages)} replays have {len(viewers)} different viewers")
    return json.dumps({"viewer": _compressed(viewers.pop()), "pages": rests})


def _compressed(text: str) -> str:
    return base64.b64encode(gzip.compress(text.encode(), mtime=0)).decode("ascii")
