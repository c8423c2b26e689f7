"""XML without entities, document types and other surprises, as a tree."""

from __future__ import annotations

from typing import NoReturn
from xml.etree.ElementTree import Element, TreeBuilder
from xml.parsers import expat

from drake_leg.errors import InvalidValueError

DEEPEST = 200
MOST_ELEMENTS = 1_000_000


class _Builder:
    """Builds the tree and refuses what no Simulink file has."""

    def __init__(self, part: str) -> None:
        self._part = part
        self._tree = TreeBuilder()
        self._depth = 0
        self._count = 0

    def parse(self, content: bytes) -> Element:
        parser = expat.ParserCreate()
        parser.buffer_text = True
        parser.StartElementHandler = self._start
        parser.EndElementHandler = self._end
        parser.CharacterDataHandler = self._tree.data
        parser.StartDoctypeDeclHandler = self._refuse
        parser.EntityDeclHandler = self._refuse
        parser.ExternalEntityRefHandler = self._refuse
        parser.Parse(content, True)
        return self._tree.close()

    def _start(self, tag: str, attributes: dict[str, str]) -> None:
        self._depth += 1
        self._count += 1
        if self._depth > DEEPEST or self._count > MOST_ELEMENTS:
            raise InvalidValueError(
                f"its part {self._part} is deeper than {DEEPEST} levels or longer than "
                f"{MOST_ELEMENTS} elements, which no model is"
            )
        self._tree.start(tag, attributes)

    def _end(self, tag: str) -> None:
        self._depth -= 1
        self._tree.end(tag)

    def _refuse(self, *_what: object) -> NoReturn:
        raise InvalidValueError(
            f"its part {self._part} declares a document type or an entity, which no Simulink file "
            "does: save the model again in Simulink"
        )


def parse_markup(content: bytes, part: str) -> Element:
    """Parse one part.

    Parameters
    ----------
    part : str
        Name of the part, for the error's sentence.

    Raises
    ------
    InvalidValueError
        If it is no XML, or has a document type, an entity, or no end.
    """
    try:
        return _Builder(part).parse(content)
    except expat.ExpatError as error:
        raise InvalidValueError(
            f"its part {part} is no XML ({expat.ErrorString(error.code)}, line {error.lineno}): "
            "save the model again in Simulink"
        ) from None
    except (LookupError, UnicodeError) as error:
        raise InvalidValueError(
            f"its part {part} is in an encoding that is not known here ({error}): save the model "
            "again in Simulink"
        ) from None


def parameters(element: Element) -> dict[str, str]:
    """Return the ``<P Name="...">`` that stand directly under an element.

    Parameters
    ----------
    element : Element
        A block, a line, a system, ...

    Returns
    -------
    dict
        Name to text, as it stands; without those whose value lies in another part.
    """
    return {
        child.get("Name", ""): child.text or ""
        for child in element
        if child.tag == "P" and child.get("Ref") is None
    }


def one_line(text: str) -> str:
    """Return a name with its line breaks as blanks."""
    return " ".join(text.splitlines())
