"""``drake-leg derive --model``: a geometric, kinematic or dynamic model, as formulas or code."""

from __future__ import annotations

import argparse

from drake_leg.cli.inputs import ParSource, RobotSource
from drake_leg.cli.terminal import STOPPED_EARLY, fail, refuse_ignored
from drake_leg.errors import InvalidValueError, TimeBudgetError, did_you_mean
from drake_leg.progress import ProgressBar, TimeBudget
from drake_leg.symbolic.models import (
    BASE_PARAMETERS,
    MODELS,
    frame_number,
    model_of_table,
)

ALL = (*MODELS, BASE_PARAMETERS)
OF_MODELS = ("frame", "within", "grouped", "all_parameters", "code")


def add_model(parser: argparse.ArgumentParser) -> None:
    """Add the option that chooses a model, and those that it takes."""
    group = parser.add_argument_group("models of the whole table, with intermediate results")
    group.add_argument("--model", metavar="MODEL", help=f"one of {', '.join(ALL)}")
    group.add_argument(
        "--frame",
        metavar="J",
        help="frame of geometry, jacobian, determinant, bias-acceleration: its number, or its link "
        "(default: the last)",
    )
    group.add_argument(
        "--in",
        dest="within",
        metavar="K",
        help="frame along whose axes it is (default: 0, the base)",
    )
    group.add_argument(
        "--grouped",
        action="store_true",
        help="base parameters in place of the links': fewer operations, a regressor of full rank",
    )
    group.add_argument(
        "--all-parameters",
        action="store_true",
        help="name the dynamic parameters of a .par file that are 0 there, too; a robot with "
        "numbers has all in identification and base-parameters",
    )
    group.add_argument(
        "--code", metavar="LANGUAGE", help="write a function: numpy, c, matlab or julia"
    )


def refuse_without_model(chosen: argparse.Namespace) -> None:
    """Refuse the options of models where none is chosen."""
    options = {_option(name): bool(getattr(chosen, name)) for name in OF_MODELS}
    refuse_ignored(options, "means nothing without --model")


def _option(name: str) -> str:
    return "--in" if name == "within" else f"--{name.replace('_', '-')}"


def require_meaning(chosen: argparse.Namespace) -> None:
    """Refuse a model that is not there, and what the chosen one does not take."""
    name = chosen.model
    if name not in ALL:
        raise InvalidValueError(
            f"there is no model {name!r}",
            advice=did_you_mean(name, ALL, f"the models are {', '.join(ALL)}"),
        )
    grouping = name in MODELS and MODELS[name].grouped
    of_frame = name in MODELS and MODELS[name].of_frame
    meaningless = {
        "--frame": chosen.frame is not None and not of_frame,
        "--in": chosen.within is not None and not of_frame,
        "--grouped": chosen.grouped and not grouping,
        "--all-parameters": chosen.all_parameters and not grouping and name != BASE_PARAMETERS,
        "--code": chosen.code is not None and name == BASE_PARAMETERS,
    }
    refuse_ignored(meaningless, f"means nothing to the model {name}")
    if chosen.code is not None:
        from drake_leg.symbolic.languages import require_language

        require_language(chosen.code)
        refuse_ignored({"--latex": chosen.latex}, "means nothing with --code")


def derive_model(
    source: RobotSource, chosen: argparse.Namespace, budget: TimeBudget, bar: ProgressBar
) -> int:
    """Derive one model and print it."""
    bar.turn_to(chosen.model)
    try:
        text = budget.spend(lambda: _derived(source, chosen))
    except TimeBudgetError:
        return fail(
            f"{chosen.model} is not derived within {budget.seconds:g} s: give it more with "
            "--budget",
            STOPPED_EARLY,
        )
    bar.wipe()
    print(text, flush=True)
    return 0


def _derived(source: RobotSource, chosen: argparse.Namespace) -> str:
    from drake_leg.symbolic.base_parameters import group_parameters
    from drake_leg.symbolic.languages import code, latex, text
    from drake_leg.symbolic.regressor import with_all_parameters

    table = source.table()
    identified = chosen.grouped or chosen.model in (BASE_PARAMETERS, "identification")
    if chosen.all_parameters or (identified and not isinstance(source, ParSource)):
        table = with_all_parameters(table)
    heading = f"{source.title}, {chosen.model} derived from its table"
    if chosen.model == BASE_PARAMETERS:
        found = group_parameters(table)
        return f"% {heading}\n{found.latex()}" if chosen.latex else f"{heading}\n\n{found}"
    program = model_of_table(
        table,
        chosen.model,
        frame=_frame(source, "--frame", chosen.frame),
        within=_frame(source, "--in", chosen.within),
        grouped=chosen.grouped,
    )
    if chosen.code is not None:
        return code(program, chosen.code).rstrip()
    if chosen.latex:
        return f"% {heading}\n{latex(program)}"
    return f"{heading}\n\n{text(program)}"


def _frame(source: RobotSource, option: str, text: str | None) -> int | None:
    """Read the number of a frame, or the name of its link where links have names."""
    if text is None or text.isdecimal():
        return None if text is None else int(text)
    if isinstance(source, ParSource):
        raise InvalidValueError(f"{option} is {text!r}; it must be the number of a frame")
    return frame_number(source.robot(), text)
