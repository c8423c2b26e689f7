"""One link of a plant as Simscape would draw its subsystem."""

from __future__ import annotations

from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import BodyIndex

from drake_leg.drawings.chain import Chain, connection_of, solid_of
from drake_leg.drawings.picture import Picture
from drake_leg.errors import InvalidValueError
from drake_leg.names import PLACES, place_name


def link_picture(plant: MultibodyPlant, link: str, *, title: str, shape: str = "solid") -> Picture:
    """Read one link of a plant with the frames that ``models.sdf`` writes; not yet laid out.

    Its frames are at its base, its centre of gravity and its end: report B, figure 5, the thigh.

    Raises
    ------
    InvalidValueError
        If the plant has no such link, or the link has no such frames.
    """
    names = [place_name(link, place) for place in PLACES]
    if not plant.HasBodyNamed(link) or not all(map(plant.HasFrameNamed, names)):
        bodies = [plant.get_body(BodyIndex(index)).name() for index in range(plant.num_bodies())]
        known = [name for name in bodies if plant.HasFrameNamed(place_name(name, PLACES[0]))]
        raise InvalidValueError(
            f"{plant.get_name()} has no link {link!r}; its links are {', '.join(known)}"
        )
    body = plant.GetBodyByName(link)
    base, cog, end = (plant.GetFrameByName(name).GetFixedPoseInBodyFrame() for name in names)
    chain = Chain()
    start = chain.add(connection_of(names[0]))
    chain.label(start, names[0])
    centre = chain.transform(start, base.inverse() @ cog, f"{link} to its centre of gravity")
    chain.label(centre, names[1])
    if body.default_mass() > 0.0:
        chain.add(solid_of(body, shape), centre)
    chain.add(connection_of(names[1]), centre)
    tip = chain.transform(centre, cog.inverse() @ end, f"{link} to its end")
    chain.label(tip, names[2])
    chain.add(connection_of(names[2]), tip)
    return chain.picture(title)
