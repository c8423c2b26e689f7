"""MATLAB text cut into tokens; spaces inside brackets become the commas that they mean."""

from __future__ import annotations

import re
from typing import NamedTuple

from drake_leg.simulink.matlab.numeric import MatlabError

BLOCKS = ("function", "if", "elseif", "else", "end", "for", "while", "parfor")
CHOICES = ("switch", "case", "otherwise", "try", "catch")
JUMPS = ("break", "continue", "return")
DECLARATIONS = ("persistent", "global")
CLASS, REFUSED = "classdef", ("spmd",)
KEYWORDS = frozenset((*BLOCKS, *CHOICES, *JUMPS, *DECLARATIONS, CLASS, *REFUSED))
COMMANDS = frozenset(  # words whose rest of the line may be text, whatever sign it begins with
    [
        "addpath",
        "axis",
        "box",
        "cd",
        "clc",
        "clear",
        "clearvars",
        "close",
        "colormap",
        "disp",
        "format",
        "grid",
        "hold",
        "load",
        "more",
        "open",
        "pkg",
        "print",
        "rmpath",
        "run",
        "save",
        "syms",
        "warning",
        "who",
        "whos",
    ]
)

_PATTERN = re.compile(
    r"""
    (?P<blank>[ \t\f\v\u00a0]+ | \.\.\.[^\n]*\n?)
    | (?P<comment>%[^\n]*)
    | (?P<newline>\n)
    | (?P<number>(?:\d+(?:\.(?![*/\\^']|\.\.)\d*)?|\.\d+)(?:[eEdD][+-]?\d+)?(?:[ij](?!\w))?)
    | (?P<name>[A-Za-z]\w*)
    | (?P<symbol>\.[*/\\^'] | [=~<>!]= | && | \|\| | [-+*/\\^<>&|~!=()\[\],;:'"{}@.])
    """,
    re.VERBOSE | re.ASCII,
)
_LETTERS = re.compile(r"\w+")
_LOOSE = re.compile(r"[ \t\f\v\n]|\.\.\.|$")  # after a sign that joins two operands
_TEXTS = {"'": re.compile(r"'((?:[^'\n]|'')*)'"), '"': re.compile(r'"((?:[^"\n]|"")*)"')}
_OPENING = {")": "(", "]": "[", "}": "{"}
_COMMAND = re.compile(r"(?P<name>[A-Za-z]\w*)[ \t]+(?P<rest>[^\n=;,%(][^\n;,%]*)", re.ASCII)
_OPTION = re.compile(r"-[A-Za-z]\w*[ \t]+\w")  # of a command; no expression goes on so
_BLOCK = re.compile(r"[ \t]*(\([^()\n]*\))?[ \t]*(%[^\n]*)?\n")  # after ``arguments``
_SHELL = re.compile(r"!(?P<rest>[^\n]*)")


class Token(NamedTuple):
    """A piece of text that means something."""

    kind: str  # "number", "name", "keyword", "text", "string" (of double quotes), "symbol",
    # "command" (a word and the text after it); "stop" after the last one
    text: str  # of a symbol at a line's end: "\n"; of a text: without its quotes
    line: int  # from 1


def tokenize(text: str) -> list[Token]:
    """Cut MATLAB text into tokens.

    Comments and continuations are left out. Inside brackets a line break is a semicolon, and
    spaces between two elements are a comma: ``[1 -2]`` has two elements, ``[1 - 2]`` has one. The
    last token is of kind ``"stop"``.
    """
    return _Scanner(_without_block_comments(text)).scan()


def _without_block_comments(text: str) -> str:
    lines, opened = [], 0
    for line in text.removeprefix("\ufeff").replace("\r\n", "\n").replace("\r", "\n").split("\n"):
        mark = line.strip()
        opened += mark == "%{"
        lines.append("" if opened else line)
        opened -= mark == "%}" and opened > 0
    return "\n".join(lines)


class _Scanner:
    def __init__(self, text: str) -> None:
        self._text, self._at, self._line = text, 0, 1
        self._found: list[Token] = []
        self._open: list[Token] = []  # brackets
        self._gap = False  # whether spaces came before the next token
        self._heads: set[int] = set()  # tokens that close the parameters of @(...)
        self._declares = False  # inside a block of arguments or properties: it has no commands
        self._in_class = False

    def scan(self) -> list[Token]:
        while self._at < len(self._text):
            self._take()
        if self._open:
            raise MatlabError(f"'{self._open[-1].text}' is never closed", self._open[-1].line)
        return [*self._found, Token("stop", "", self._line)]

    def _take(self) -> None:
        if command := self._command():
            self._found.append(Token("command", command[0], self._line))
            self._at = command.end()
            return
        match = _PATTERN.match(self._text, self._at)
        if match is None:
            raise MatlabError(f"{self._text[self._at]!r} is not used in MATLAB", self._line)
        kind, text = str(match.lastgroup), match[0]
        if kind == "symbol" and text in _TEXTS and not self._is_transpose(text):
            match = self._quoted(text)
            kind = "text" if text == "'" else "string"
            text = match[1].replace(text * 2, text)
        self._at = match.end()
        if kind == "blank":
            self._gap = True
            self._line += text.count("\n")
        elif kind != "comment":
            self._add(kind, text)
            self._gap = False

    def _add(self, kind: str, text: str) -> None:
        if kind == "number" and (wrong := _LETTERS.match(self._text, self._at)):
            raise MatlabError(f"'{text}{wrong[0]}' is not a number", self._line)
        if kind == "symbol" and text in ("!", "!="):
            text = text.replace("!", "~")
        if kind == "name" and text in KEYWORDS and not (text == "end" and self._open):
            kind = "name" if self._after_dot() else "keyword"
        if self._in_matrix() and self._gap and self._ends_operand() and self._starts(kind, text):
            self._found.append(Token("symbol", ",", self._line))
        if kind == "newline":
            self._found.append(Token("symbol", ";" if self._in_matrix() else "\n", self._line))
            self._line += 1
            return
        token = Token(kind, text, self._line)
        blocks = ("arguments", "properties") if self._in_class else ("arguments",)
        if kind == "name" and text in blocks and self._begins_statement():
            self._declares = bool(_BLOCK.match(self._text, self._at))
        elif kind == "keyword":
            self._declares = False
            self._in_class |= text == CLASS
        self._found.append(token)
        if kind == "symbol":
            self._count(token)

    def _count(self, token: Token) -> None:
        if token.text in ("(", "[", "{"):
            handle = token.text == "(" and len(self._found) > 1 and self._found[-2].text == "@"
            self._open.append(token._replace(kind="head") if handle else token)
            return
        opening = _OPENING.get(token.text)
        if not opening:
            return
        if not self._open or self._open[-1].text != opening:
            raise MatlabError(f"'{token.text}' closes nothing", token.line)
        if self._open.pop().kind == "head":
            self._heads.add(len(self._found) - 1)

    def _command(self) -> re.Match[str] | None:
        """Match a statement that is a word and text, such as ``hold on``, if one begins here."""
        if self._open or self._declares or not self._begins_statement():
            return None
        if shell := _SHELL.match(self._text, self._at):
            return shell
        found = _COMMAND.match(self._text, self._at)
        if not found or found["name"] in KEYWORDS:
            return None
        first, after = found["rest"][0], self._text[found.end() : found.end() + 1]
        if found["name"] in COMMANDS:
            return found if not re.match(r"[-+*/^<>&|~]\s", found["rest"]) else None
        if _OPTION.match(found["rest"]):
            return found
        plain = first.isalnum() and not re.match(r"\w+\s*[.(=]", found["rest"])
        return found if plain and after != "(" and "=" not in found["rest"] else None

    def _begins_statement(self) -> bool:
        if not self._found:
            return True
        kind, text, _ = self._found[-1]
        ends = kind == "symbol" and text in (";", ",", "\n")
        return ends or kind == "command" or (kind == "keyword" and text in ("else", "try"))

    def _after_dot(self) -> bool:
        return bool(self._found) and self._found[-1][:2] == ("symbol", ".")

    def _in_matrix(self) -> bool:
        return bool(self._open) and self._open[-1].text in ("[", "{")

    def _ends_operand(self) -> bool:
        if not self._found or len(self._found) - 1 in self._heads:
            return False
        kind, text, _ = self._found[-1]
        return kind in ("number", "name", "text", "string") or (
            kind == "symbol" and text in (")", "]", "}", "'", ".'")
        )

    def _starts(self, kind: str, text: str) -> bool:
        """Tell whether a token after a space begins an element of a matrix."""
        if text in ("+", "-") and kind == "symbol":
            return not _LOOSE.match(self._text, self._at)
        return kind in ("number", "name", "text", "string") or text in ("(", "[", "{", "~", "@")

    def _is_transpose(self, quote: str) -> bool:
        return quote == "'" and self._ends_operand() and not (self._gap and self._in_matrix())

    def _quoted(self, quote: str) -> re.Match[str]:
        match = _TEXTS[quote].match(self._text, self._at)
        if match is None:
            raise MatlabError("a text is not closed with its quote", self._line)
        return match
