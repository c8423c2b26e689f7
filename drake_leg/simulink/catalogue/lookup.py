"""From a block's type and source to its parameters."""

from __future__ import annotations

from drake_leg.simulink.catalogue.libraries import LIBRARIES
from drake_leg.simulink.catalogue.parameter import Parameters
from drake_leg.simulink.catalogue.signals import BUILT_IN, WITHOUT_PARAMETERS


def known_parameters(block_type: str, source: str) -> Parameters | None:
    """Return the parameters of a kind of block.

    Parameters
    ----------
    block_type : str
        ``BlockType`` in the file.
    source : str
        Library path of a ``Reference``; otherwise "".

    Returns
    -------
    tuple of Parameter, or None
        None where such a block is not known. Folders of a library do not count: blocks have moved
        between them from release to release.
    """
    if block_type == "Reference":
        return LIBRARIES.get(source.split("/", 1)[0], {}).get(source.rsplit("/", 1)[-1])
    if block_type in WITHOUT_PARAMETERS:
        return ()
    return BUILT_IN.get(block_type)
