"""Blocks in Python that convert to AutoDiffXd with their diagram, as Drake's own blocks do."""

from __future__ import annotations

from functools import cache, partial
from inspect import signature
from typing import Any

from pydrake.autodiffutils import AutoDiffXd
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import Frame, Joint
from pydrake.systems.framework import LeafSystem, LeafSystem_, SystemScalarConverter

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.loop import KinematicEquation
from drake_leg.kinematics.movable import Movable

_OF_FLOAT_ALONE = ("__dict__", "__weakref__", "ToAutoDiffXd")


class Block(LeafSystem):
    """A LeafSystem that ``ToAutoDiffXd`` converts, alone or in a diagram.

    A subclass is an ordinary LeafSystem for float; its constructor begins with
    ``Block.__init__(self, ...)`` and passes on what it was given. ``differentiable(cls)`` is the
    same class for AutoDiffXd: the same methods, constructed from the same arguments, but a
    converted plant for a plant, its frame or joint for a frame or a joint, and
    ``differentiable()`` of a Movable or a KinematicEquation. The methods therefore take numbers as
    they come; ``scalar`` is their type, float or AutoDiffXd. They do not use ``super()``, since the
    class for AutoDiffXd has other bases. A block with other arguments than the one it extends
    derives from Block instead.
    """

    def __init__(self, *arguments: Any, **options: Any) -> None:  # noqa: ANN401 - of any block
        self.scalar = AutoDiffXd if isinstance(self, LeafSystem_[AutoDiffXd]) else float
        LeafSystem_[self.scalar].__init__(self, converter=_CONVERTER)
        self._made_of = arguments, options

    def ToAutoDiffXd(self) -> Any:  # noqa: ANN401 - a system of another scalar type
        """Convert the block alone; a plant among its arguments is converted for it.

        Raises
        ------
        InvalidValueError
            If the block takes other arguments than the one it extends, or if it cannot be
            constructed again.
        """
        return _in_autodiff(self)


@cache
def differentiable(block: Any) -> type[Any]:  # noqa: ANN401 - a class of blocks
    """Return a block's class for AutoDiffXd."""
    own: dict[str, Any] = {}
    for base in reversed(block.__mro__[: block.__mro__.index(LeafSystem)]):
        own |= {name: value for name, value in vars(base).items() if name not in _OF_FLOAT_ALONE}
    base = LeafSystem_[AutoDiffXd]
    made: type[Any] = type(base)(f"{block.__name__}_[AutoDiffXd]", (base,), own)
    return made


def _in_autodiff(block: Block) -> Any:  # noqa: ANN401 - a system of another scalar type
    kind: Any = type(block)
    _require_own_arguments(kind)
    plants: dict[int, Any] = {}  # a plant and its frames are converted once
    arguments = [_argument_in_autodiff(each, plants) for each in block._made_of[0]]
    options = {
        name: _argument_in_autodiff(each, plants) for name, each in block._made_of[1].items()
    }
    try:
        result = differentiable(kind)(*arguments, **options)
    except TypeError as error:
        raise InvalidValueError(
            f"the block {kind.__name__} cannot be constructed again for AutoDiffXd ({error})",
            advice="let its `__init__` begin with `Block.__init__(self, ...)`, with all of its own "
            "arguments, and use no `super()`",
        ) from error
    result.set_name(block.get_name())
    result._float = block
    return result


def _require_own_arguments(kind: Any) -> None:  # noqa: ANN401 - a class of blocks
    """Refuse a block that passed on the arguments of the block it extends, not its own."""
    bases = kind.__mro__[: kind.__mro__.index(Block)]
    taken = [
        (base.__name__, ", ".join(signature(vars(base)["__init__"]).parameters))
        for base in bases
        if "__init__" in vars(base)
    ]
    for name, arguments in taken[1:]:
        if arguments != taken[0][1]:
            raise InvalidValueError(
                f"the block {taken[0][0]} cannot be constructed again for AutoDiffXd: its "
                f"`__init__` takes ({taken[0][1]}), and that of {name}, which it extends, takes "
                f"({arguments})",
                advice="derive it from Block, and let its `__init__` begin with "
                f"`Block.__init__({taken[0][1]})`",
            )


def _in_float(block: Any) -> Block:  # noqa: ANN401 - a system of another scalar type
    arguments, options = block._float._made_of
    result: Block = type(block._float)(*arguments, **options)
    result.set_name(block.get_name())
    return result


def _argument_in_autodiff(argument: Any, plants: dict[int, Any]) -> Any:  # noqa: ANN401
    of = partial(_argument_in_autodiff, plants=plants)
    match argument:
        case MultibodyPlant():
            if id(argument) not in plants:
                plants[id(argument)] = argument.ToAutoDiffXd()
            return plants[id(argument)]
        case Frame():
            return of(argument.GetParentPlant()).get_frame(argument.index())
        case Joint():
            return of(argument.GetParentPlant()).get_joint(argument.index())
        case Movable() | KinematicEquation():
            return argument.differentiable()
        case list() | tuple():
            return [of(each) for each in argument]
    return argument


def _converter() -> SystemScalarConverter:
    converter = SystemScalarConverter()
    converter._AddConstructor[AutoDiffXd, float](_in_autodiff)
    converter._AddConstructor[float, AutoDiffXd](_in_float)
    return converter


_CONVERTER = _converter()
