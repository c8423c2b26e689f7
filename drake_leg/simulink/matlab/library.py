"""The functions and constants that MATLAB text may use by name, and those that are not run."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from drake_leg.simulink.matlab import numeric
from drake_leg.simulink.matlab.algebra import ALGEBRA
from drake_leg.simulink.matlab.arrays import ARRAYS
from drake_leg.simulink.matlab.curves import CURVES
from drake_leg.simulink.matlab.data import (
    Allowance,
    Known,
    array_of,
    numbers_of,
    of_values,
    settled,
)
from drake_leg.simulink.matlab.gathering import GATHERING
from drake_leg.simulink.matlab.inputs import of_array, of_two, scalar, whole
from drake_leg.simulink.matlab.operators import EACH
from drake_leg.simulink.matlab.poles import POLES
from drake_leg.simulink.matlab.quadratic import QUADRATIC
from drake_leg.simulink.matlab.quaternions import QUATERNIONS
from drake_leg.simulink.matlab.records import RECORDS
from drake_leg.simulink.matlab.robot_frames import ROBOT_FRAMES
from drake_leg.simulink.matlab.rotations import ROTATIONS
from drake_leg.simulink.matlab.samples import SAMPLES
from drake_leg.simulink.matlab.seeking import SEEKING
from drake_leg.simulink.matlab.state_spaces import STATE_SPACES
from drake_leg.simulink.matlab.surroundings import SURROUNDINGS
from drake_leg.simulink.matlab.texts import TEXTS
from drake_leg.simulink.matlab.trajectories import TRAJECTORIES
from drake_leg.simulink.matlab.transfers import TRANSFERS
from drake_leg.simulink.matlab.validators import VALIDATORS
from drake_leg.simulink.matlab.whole_numbers import WHOLE_NUMBERS

# ruff: noqa: ANN401 - any value of a script


def _tand(x: Any) -> Any:
    return numeric.sind(x) / numeric.cosd(x)


def _degrees(x: Any) -> Any:
    return (180.0 / math.pi) * x


def _radians(x: Any) -> Any:
    return (math.pi / 180.0) * x


def _round(budget: Allowance, wanted: int, value: Any, digits: Any = 0.0) -> Any:
    places = whole(digits)
    if abs(places) > 300:
        return value
    scale = 10.0**places
    return settled(numeric.rounded(numbers_of(value) * scale) / scale)


def _integer(low: float, high: float) -> Known:
    return of_array(lambda x: np.clip(numeric.rounded(np.nan_to_num(x)), low, high))


def _gamma(x: Any) -> Any:
    def gamma(one: float) -> float:
        try:
            return math.gamma(one)
        except (ValueError, OverflowError):
            return math.inf

    return np.vectorize(gamma, otypes=[float])(x)


def _nchoosek(n: Any, k: Any) -> float:
    return float(math.comb(min(max(whole(n), 0), 1_000), min(max(whole(k), 0), 1_000)))


def _logical(value: Any) -> Any:
    array = array_of(value)
    if np.isnan(array).any():
        raise numeric.MatlabError("NaN is neither true nor false")
    return settled(array != 0)


def _eps(x: Any) -> Any:
    return np.abs(np.spacing(x))


def _wrapped(turn: float) -> Any:
    """Map angles to one turn from zero; positive multiples of it to its end."""
    return lambda x: np.where((x > 0.0) & (np.mod(x, turn) == 0.0), turn, np.mod(x, turn))


def _centred(turn: float) -> Any:
    """Map angles to half a turn on both sides of zero, both ends included."""
    half, whole_turn = turn / 2.0, _wrapped(turn)
    return lambda x: np.where(np.abs(x) <= half, x, whole_turn(x + half) - half)


CONSTANTS: dict[str, Any] = {
    "pi": math.pi,
    "eps": float(np.finfo(float).eps),
    **dict.fromkeys(("inf", "Inf"), math.inf),
    **dict.fromkeys(("nan", "NaN"), math.nan),
    **dict.fromkeys(("i", "j"), 1j),
    "realmax": float(np.finfo(float).max),
    "realmin": float(np.finfo(float).tiny),
    "flintmax": 2.0**53,
    "true": True,
    "false": False,
}
_OF_ONE: dict[str, Any] = {
    "sin": np.sin,
    "cos": np.cos,
    "tan": np.tan,
    "asin": np.emath.arcsin,
    "acos": np.emath.arccos,
    "atan": np.arctan,
    "sec": lambda x: 1 / np.cos(x),
    "csc": lambda x: 1 / np.sin(x),
    "cot": lambda x: 1 / np.tan(x),
    "sind": numeric.sind,
    "cosd": numeric.cosd,
    "tand": _tand,
    "asind": lambda x: _degrees(np.emath.arcsin(x)),
    "acosd": lambda x: _degrees(np.emath.arccos(x)),
    "atand": lambda x: _degrees(np.arctan(x)),
    "asec": lambda x: np.emath.arccos(1 / x),
    "acsc": lambda x: np.emath.arcsin(1 / x),
    "acot": lambda x: np.arctan(1 / x),
    "sech": lambda x: 1 / np.cosh(x),
    "csch": lambda x: 1 / np.sinh(x),
    "coth": lambda x: 1 / np.tanh(x),
    "erf": np.vectorize(lambda x: math.erf(np.real(x)), otypes=[float]),
    "erfc": np.vectorize(lambda x: math.erfc(np.real(x)), otypes=[float]),
    "sinc": np.sinc,
    "sinh": np.sinh,
    "cosh": np.cosh,
    "tanh": np.tanh,
    "asinh": np.arcsinh,
    "acosh": lambda x: np.arccosh(np.asarray(x, complex)),
    "atanh": lambda x: np.arctanh(np.asarray(x, complex)),
    "wrapToPi": _centred(2.0 * math.pi),
    "wrapTo2Pi": _wrapped(2.0 * math.pi),
    "wrapTo180": _centred(360.0),
    "wrapTo360": _wrapped(360.0),
    "deg2rad": _radians,
    "rad2deg": _degrees,
    "degtorad": _radians,
    "radtodeg": _degrees,
    "sqrt": np.emath.sqrt,
    "exp": np.exp,
    "log": np.emath.log,
    "log2": np.emath.log2,
    "log10": np.emath.log10,
    "log1p": np.log1p,
    "expm1": np.expm1,
    "abs": np.abs,
    "sign": np.sign,
    "floor": np.floor,
    "ceil": np.ceil,
    "fix": np.trunc,
    "isnan": np.isnan,
    "isinf": np.isinf,
    "isfinite": np.isfinite,
    "real": np.real,
    "imag": np.imag,
    "conj": np.conj,
    "angle": np.angle,
    "double": np.asarray,
    "single": np.asarray,
    "full": np.asarray,
    "eps": _eps,
    "gamma": _gamma,
    "factorial": lambda x: _gamma(np.asarray(x) + 1.0),
}
_OF_TWO: dict[str, Any] = {
    "atan2": np.arctan2,
    "atan2d": lambda y, x: _degrees(np.arctan2(y, x)),
    "hypot": np.hypot,
    "nthroot": numeric.real_root,
    "mod": numeric.mod,
    "rem": numeric.rem,
    "power": numeric.power,
    "plus": np.add,
    "minus": np.subtract,
    "times": np.multiply,
    "rdivide": np.divide,
    "and": EACH["&"],
    "or": EACH["|"],
    "xor": np.logical_xor,
    "eq": np.equal,
    "ne": np.not_equal,
    "lt": np.less,
    "le": np.less_equal,
    "gt": np.greater,
    "ge": np.greater_equal,
    "complex": lambda a, b: a + 1j * b,
    "idivide": lambda a, b: np.trunc(a / b),
    "bitand": lambda a, b: np.bitwise_and(a.astype(np.int64), b.astype(np.int64)),
    "bitor": lambda a, b: np.bitwise_or(a.astype(np.int64), b.astype(np.int64)),
}
KNOWN: dict[str, Known] = {
    **{name: of_array(function) for name, function in _OF_ONE.items()},
    **{name: of_two(function) for name, function in _OF_TWO.items()},
    "round": _round,
    "not": of_values(lambda value: settled(~array_of(_logical(value)))),
    "logical": of_values(_logical),
    "nchoosek": of_values(_nchoosek),
    **{f"int{n}": _integer(-(2.0 ** (n - 1)), 2.0 ** (n - 1) - 1) for n in (8, 16, 32, 64)},
    **{f"uint{n}": _integer(0.0, 2.0**n - 1) for n in (8, 16, 32, 64)},
    "colon": lambda budget, wanted, *parts: settled(
        numeric.span(
            scalar(parts[0]),
            scalar(parts[1]) if len(parts) == 3 else 1.0,
            scalar(parts[-1]),
            budget.room,
        )
    ),
    **ARRAYS,
    **ALGEBRA,
    **CURVES,
    **QUADRATIC,
    **STATE_SPACES,
    **POLES,
    **TRAJECTORIES,
    **TRANSFERS,
    **RECORDS,
    **{
        name: of_values(function)
        for name, function in (ROTATIONS | QUATERNIONS | ROBOT_FRAMES).items()
    },
    **GATHERING,
    **SAMPLES,
    **WHOLE_NUMBERS,
    **TEXTS,
    **SEEKING,
    **SURROUNDINGS,
    **VALIDATORS,
}

_QUIET = (
    "axis beep box camlight clc close colorbar dbstop disp display drawnow figure format fprintf "
    "graphics_toolkit grid hold legend light more pause pkg printf profile shading title "
    "view warning who whos xlabel ylabel zlabel"
)
QUIET = frozenset(_QUIET.split())  # they only arrange, print or wait
_PICTURES = (
    "addpoints animatedline annotation area bar bode cla clf colormap comet contour errorbar "
    "exportFig exportgraphics fill fill3 gca gcf get getframe histogram histogram2 image imagesc "
    "impulse imread imshow line linkaxes loglog margin mesh movie nichols nyquist patch plot "
    "plot3 plotyy polarplot print pzmap quiver quiver3 rlocus rotate3d saveas savefig scatter "
    "scatter3 semilogx semilogy set sgtitle show stairs stem step subplot surf text trisurf "
    "waitbar xlim xline ylim yline zlim zoom"
)
_MODELS = (
    "add_block add_line bdclose close_system delete_block delete_line find_system gcb gcs "
    "get_param getSimulinkBlockHandle linearize linio load_system mechExplorer new_system "
    "open_system save_system set_param sim simset simulink sldemo slLibraryBrowser smimport"
)
_ASKED = "ginput guide input inputdlg keyboard menu msgbox questdlg uigetdir uigetfile uiputfile"
_SYSTEM = (
    "copyfile csvwrite delete diary dlmwrite doc dos edit exit fclose fgetl fgets fopen fscanf "
    "fwrite getenv javaaddpath javaMethod mex mkdir movefile open publish quit rename rmdir rmpath "
    "save savepath setenv shell system textscan unix urlread urlwrite web webread websave winopen "
    "writecell writematrix writetable xlswrite"
)
_TEXTS = "evalc inline"
_DAYS = "clock cputime date datenum datestr datetime now weekday"
NOT_RUN: dict[str, str] = {
    **dict.fromkeys(_PICTURES.split(), "pictures are not drawn"),
    **dict.fromkeys(_MODELS.split(), "a script does not work on models here"),
    **dict.fromkeys(_ASKED.split(), "a script asks nobody here"),
    **dict.fromkeys(_SYSTEM.split(), "a script reaches neither the system nor files here"),
    **dict.fromkeys(_DAYS.split(), "nothing depends on the time of day here"),
    **dict.fromkeys(_TEXTS.split(), "a text is not run as code"),
}
