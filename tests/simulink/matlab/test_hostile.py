"""Text that nobody meant: only InvalidValueError comes out, and nothing is executed."""

import ast
import sys
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import drake_leg.simulink.matlab
from drake_leg.errors import InvalidValueError
from drake_leg.simulink.matlab.compiling import compiled
from drake_leg.simulink.matlab.program import program, value

SCRIPT = """function [qd, detJ] = f(u, v)
%#codegen
l = [50; 100; 100]; J = zeros(3);
for i = 1:3
  J(:,i) = cross([0; 0; 1], u(1:3) - i*l);  % a column
  if i == 2 && J(1,i) > 0, J(i,i) = max(l)'; elseif ~any(l), break, else, J(3,i) = -i^2; end
end
while norm(J) > 1e6
  J = J / 2;
end
detJ = det(J);
qd = g(J, v)';
end
function y = g(J, v)
y = pinv(J)*[v(1) -v(2) ...
     v(end)]' + J\\v;
end
"""

SYNTAX = r"""function end if else elseif for while break continue return persistent u y f i sin det
inv zeros ones max size sum norm pinv mod cosd reshape true pi inf nan x1 1 2 0 3 .5 1e4 1e999
100 ( ) [ ] , ; : = == ~= < + - * / \ ^ .* ./ .^ ' .' && || & | ~ " { } @ . ... % %{ %}
(1) (end) (:,1) [1;2;3] u(1) A(2,2)=1; y=1;"""
SIGNS = ["\n", " ", "\t", "\r\n", "\x00", "\u00e9", "\u2212", "0" * 400]
WORDS = st.sampled_from([*SYNTAX.split(), *SIGNS])
TEXTS = st.lists(st.tuples(WORDS, st.sampled_from(["", " ", "\n"])), max_size=40).map(
    lambda words: "".join(word + gap for word, gap in words)
)


def survives(attempt):
    said = "nothing"
    try:
        attempt()
    except InvalidValueError as refusal:
        said = str(refusal)
    assert 0 < len(said) < 1000


@pytest.mark.slow
@settings(max_examples=100)
@given(TEXTS)
def test_random_words_as_a_value(text):
    survives(lambda: value(text, {"u": 3.0, "y": [1.0, 2.0]}))


@settings(max_examples=100)
@given(st.text(max_size=60))
def test_random_signs_as_a_value(text):
    survives(lambda: value(text))


@pytest.mark.slow
@settings(max_examples=100)
@given(TEXTS)
def test_random_words_as_a_script(text):
    survives(lambda: program(f"function y = f(u)\n{text}").call([1.0, 2.0, 3.0]))
    survives(lambda: program(text).call(1.0))


@pytest.mark.slow
@settings(max_examples=50, deadline=None)
@given(TEXTS)
def test_random_words_as_a_script_that_is_compiled(text):
    survives(lambda: compiled(f"function y = f(u)\n{text}").call({}, [1.0, 2.0, 3.0]))


def test_the_good_script_is_good():
    assert len(program(SCRIPT).call([1.0, 2.0, 3.0], [4.0, 5.0, 6.0])) == 2


@pytest.mark.slow
@settings(max_examples=100)
@given(st.data())
def test_a_good_script_with_faults(data):
    script = SCRIPT
    for _ in range(data.draw(st.integers(1, 4))):
        at = data.draw(st.integers(0, len(script)))
        gone = data.draw(st.integers(0, 6))
        script = script[:at] + data.draw(st.just("") | WORDS) + script[at + gone :]
    survives(lambda: program(script).call([1.0, 2.0, 3.0], [4.0, 5.0, 6.0]))
    if data.draw(st.integers(0, 4)) == 0:
        survives(lambda: compiled(script).call({}, [1.0, 2.0, 3.0], [4.0, 5.0, 6.0]))


@pytest.mark.parametrize(
    "text",
    [
        "(" * 9000,
        "(" * 5000 + "1" + ")" * 5000,
        "[" * 5000 + "1" + "]" * 5000,
        "-" * 19000 + "1",
        "1" + "'" * 19000,
        "1" + "+1" * 9000,
        "1" + "^1" * 9000,
        "1" + ":1" * 9000,
        "1" + "||1" * 6000,
        "sin(" * 4000 + "1" + ")" * 4000,
        "9" * 19000,
        "1e" + "9" * 19000,
        "[" + "1 " * 9990 + "]",
        "[" + "1 " * 9990 + "]'*[" + "1" + "]",
        "'" * 19000,
        "1" * 20001,
        "reshape(1:10000, 100, 100)^999",
        "pinv(ones(100))",
        "1" + "^9" * 1000,
        " " * 19000 + "x",
        "%{\n" * 6000,
    ],
)
def test_long_and_deep_values(text):
    survives(lambda: value(text))


@pytest.mark.parametrize(
    "body",
    [
        "if u," * 20000,
        "if u\n" * 60 + "y = 1;\n" + "end\n" * 60,
        "y = " + "[min(-" * 30 + "u" + ",2)]" * 30,
        "y = " + "-" * 150000 + "u;",
        pytest.param("y = [" + "1 " * 90000 + "];", marks=pytest.mark.slow),
        pytest.param("[a] = a;" * 20000, marks=pytest.mark.slow),
        "y = u;\n" + "function y = g(u)\n" * 9000,
        "y = u" + "(1)" * 30000,
        " " * 250000,
        "while 1\nwhile 1\nend\nend",
        "y = f(f(f(u)));",
    ],
)
def test_long_and_deep_scripts(body):
    survives(lambda: program(f"function y = f(u)\n{body}").call(1.0))


def test_the_deepest_that_is_taken_leaves_the_stack_alone():
    """It needs less than a third of Python's frames, so that it may be called from anywhere."""

    def deepest(make):
        taken = [0]
        for depth in range(1, 60):
            try:
                program(make(depth)).call(4.0)
            except InvalidValueError:
                break
            taken.append(depth)
        return make(taken[-1])

    codes = [
        deepest(lambda n: "function y = f(a)\ny=" + "[min(-" * n + "1" + ",2)]" * n),
        deepest(lambda n: "function y = f(a)\ny = 0;\n" + "if a\n" * n + "y = 1;" + "\nend" * n),
        deepest(lambda n: "function y=f(a)\ny=" + "1||1&&1|1&1==1+1*-1^(" * n + "a" + ")" * n),
        deepest(lambda n: f"function y = f(a)\nif a < 4 - {n}\ny = 0;\nelse\ny = -[-f(a-1)];\nend"),
    ]
    limit, depth = sys.getrecursionlimit(), len(_frames())
    sys.setrecursionlimit(depth + 333)
    try:
        for code in codes:
            assert len(program(code).call(4.0)) == 1
    finally:
        sys.setrecursionlimit(limit)


def _frames():
    frame, frames = sys._getframe(), []
    while frame:
        frames.append(frame)
        frame = frame.f_back
    return frames


@pytest.mark.slow
def test_the_interpreter_runs_no_python():
    """No file of the room names eval, exec, compile, __import__, open or getattr.

    One makes functions of the source that this project writes: that from checked trees.
    """
    libraries = {"math", "operator", "re", "io", "struct", "warnings", "zlib", "numpy"}
    libraries |= {"scipy.linalg", "h5py"}  # which reads .mat files of version 7.3
    forbidden = {"eval", "exec", "compile", "__import__", "open", "getattr", "globals", "vars"}
    for file in Path(drake_leg.simulink.matlab.__file__).parent.rglob("*.py"):
        tree = ast.parse(file.read_text(encoding="utf-8"))
        names = {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)}
        assert names & forbidden == ({"compile", "exec"} if file.name == "variants.py" else set())
        for node in ast.walk(tree):
            if isinstance(node, ast.Import):
                assert {name.name for name in node.names} <= libraries
