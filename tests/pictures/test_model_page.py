"""The page about a model; that of a run is tested with ``drake-leg run``."""

import numpy as np
import pytest

from drake_leg.pictures.model_page import value_in_words
from drake_leg.simulink.matlab.data import Cell, Struct, Structs


@pytest.mark.parametrize(
    ("value", "words"),
    [
        (0.1 + 0.2, "0.3"),
        (True, "1"),
        (np.array([[2.0]]), "2"),
        (np.array([[1.0, 2.5], [3.0, 4.0]]), "[1 2.5; 3 4]"),
        (np.zeros((4, 5)), "4 × 5 numbers"),
        (np.zeros((0, 0)), "0 × 0 numbers"),
        ("abc", "'abc'"),
        ("a" * 99, f"'{'a' * 58}…"),
        (Struct(mass=1.0, length=2.0), "struct with mass, length"),
        (Structs(items=np.empty((1, 2), object), names=("m",)), "struct with m"),
        (Cell(items=np.empty((2, 3), object)), "cell, 2 × 3"),
        (None, ""),
    ],
)
def test_values_are_short(value, words):
    assert value_in_words(value) == words
