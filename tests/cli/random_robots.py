"""Robots of one to eight joints at random, as a person would type them."""

import math

KINDS = {"revolute": 0, "prismatic": 1, "fixed": '"~"'}
COUNTS = (1, 2, 3, 3, 3, 4, 5, 6, 7, 8)  # joints; three are the commonest


def random_robot(seed, rng):
    """Write a robot, and tell how many joints it has.

    Seeds that follow each other take turns in counts of joints, in units, and in conventions.
    """
    count = COUNTS[seed % len(COUNTS)]
    degrees = seed % 3 != 0
    classic = seed % 7 == 3
    lines = [f'name = "chance_{seed}"', f'angles = "{"deg" if degrees else "rad"}"']
    if classic:
        lines.append('convention = "classic"')
    kinds = [rng.choice(["revolute"] * 3 + ["prismatic"]) for _ in range(count)]
    if not classic:
        for _ in range(rng.integers(0, 3)):
            kinds.insert(rng.integers(0, len(kinds) + 1), "fixed")
    for number, kind in enumerate(kinds, start=1):
        lines += _row(number, kind, degrees, classic, rng)
    return "\n".join(lines) + "\n", count


def _row(number, kind, degrees, classic, rng):
    def angle(value):
        return f"{value:.6g}" if degrees else f"{math.radians(value):.9g}"

    alpha = rng.choice([0.0, 90.0, -90.0, 45.0, float(rng.uniform(-180, 180))])
    theta = rng.choice([0.0, 0.0, 90.0, float(rng.uniform(-180, 180))])
    across, along = (rng.choice([0.0, round(float(rng.uniform(0.02, 0.4)), 4)]) for _ in "dr")
    names = ("a", "d") if classic else ("d", "r")
    lines = [
        "[[row]]",
        f"sigma = {KINDS[kind]}",
        f"{names[0]} = {across}",
        f"alpha = {angle(alpha)}",
        f"{names[1]} = {along}",
        f"theta = {angle(theta)}",
    ]
    if kind == "fixed" and rng.random() < 0.6:
        return lines
    lines += [f'joint = "joint_{number}"', f'link = "link_{number}"', *_body(rng)]
    return lines if kind == "fixed" else [*lines, *_acting(kind, angle, rng)]


def _body(rng):
    size = round(float(rng.uniform(0.01, 0.1)), 4)
    inertia = f"{2.0 * size * size:.6g}"
    return {
        0: ["[row.solid]", 'shape = "brick"', f"length = {size}", "width = 0.02", "height = 0.03",
            "density = 2700", f"centre = [{size / 2}, 0, 0]"],
        1: ["[row.solid]", 'shape = "cylinder"', f"radius = {size}", "length = 0.1",
            "density = 1000", "centre = [0, 0.01, 0]"],
        2: ["[row.solid]", 'shape = "sphere"', f"radius = {size}", "density = 500",
            "centre = [0, 0, 0.02]"],
        3: ["[row.inertial]", "mass = 0.4", f"centre = [0, 0, {size}]",
            f"moments = [{inertia}, {inertia}, {inertia}]"],
        4: [],
    }[int(rng.choice(5, p=[0.3, 0.25, 0.2, 0.2, 0.05]))]  # fmt: skip


def _acting(kind, angle, rng):
    turns = kind == "revolute"
    lines = []
    low, high = (-170.0, 170.0) if turns else (-0.3, 0.3)
    if rng.random() < 0.5:
        low, high = (float(rng.uniform(*ends)) for ends in ((low, low / 4), (high / 4, high)))
        bounds = [angle(value) if turns else f"{value:.4g}" for value in (low, high)]
        lines += ["[row.limits]", f"lower = {bounds[0]}", f"upper = {bounds[1]}"]
        if rng.random() < 0.3:
            lines.append("effort = 50")
    if rng.random() < 0.5:
        lines += ["[row.mechanics]", f"damping = {rng.uniform(0.001, 0.1):.4g}"]
        lines.append(f'damping_unit = "{"N*m*s/rad" if turns else "N*s/m"}"')
        if rng.random() < 0.4:
            middle = float(rng.uniform(low / 5, high / 5))
            lines.append(f"position_target = {angle(middle) if turns else f'{middle:.4g}'}")
    return lines
