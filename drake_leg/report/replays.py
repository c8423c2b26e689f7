"""The replays inside the page: their common viewer once, compressed, and the rest of each."""

from __future__ import annotations

import base64
import gzip
import json
import re
from collections.abc import Mapping

from drake_leg.errors import DrakeLegError

VIEWER = re.compile(r'<script type="text/javascript">.*?</script>', re.DOTALL)


class UnlikeReplaysError(DrakeLegError):
    """Replays do not have one viewer, so that it cannot be kept once for all."""


def packed(pages: Mapping[str, str]) -> str:
    """Pack pages that play motions with the same viewer; ``report.js`` puts them together again.

    Parameters
    ----------
    pages : mapping
        Name -> HTML, as ``scene.replay.replay`` makes it.

    Returns
    -------
    str
        JSON: ``viewer``, and under ``pages`` what stands before and after it on each; both are
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
