"""What keeps foreign text in its place: one error without a place, and limits."""

from __future__ import annotations

VALUE_LENGTH = 20_000  # characters of a parameter
SCRIPT_LENGTH = 200_000  # characters of a function block's code
ELEMENTS = 10_000  # of one array
NESTING = 48  # operators, brackets and blocks inside one another, in one function
CALLS = 120  # the same, over all functions that wait for another
OPERATIONS = 1_000_000  # of one call: statements' nodes, and elements of arrays
CALL = 10  # operations that a function costs at least
FACTOR = 5  # operations for each element that linear algebra works on
EXPONENT = 1_000  # of a matrix


class MatlabError(Exception):
    """What is wrong with MATLAB text, before it is said where.

    Attributes
    ----------
    line : int or None
        Line of the text, from 1, where it is known.
    """

    def __init__(self, reason: str, line: int | None = None) -> None:
        self.line = line
        super().__init__(reason)


class Budget:
    """Operations that one call may still take."""

    def __init__(self, operations: int = OPERATIONS) -> None:
        self._left = operations

    def spend(self, operations: int) -> None:
        """Count operations.

        Raises
        ------
        MatlabError
            If there are none left.
        """
        self._left -= operations
        if self._left < 0:
            raise MatlabError(
                f"it takes more than {OPERATIONS} operations: shorten its loops or its arrays"
            )


def require_room(rows: int, columns: int) -> None:
    """Check the size of an array before it is made.

    Raises
    ------
    MatlabError
        If it is too large.
    """
    if rows * columns > ELEMENTS or max(rows, columns) > ELEMENTS:
        raise MatlabError(
            f"an array of {rows:.7g}×{columns:.7g} is larger than {ELEMENTS} elements"
        )
