"""Programs: names, counts, and code that computes what they do."""

import ctypes
import doctest
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
import sympy as sp
from bodies import FORK, RX_90, robot_of

from drake_leg import LEG_B
from drake_leg.errors import InvalidValueError
from drake_leg.robot.symoro.as_robot import numbers_of
from drake_leg.robot.symoro.reader import load_par
from drake_leg.symbolic import models
from drake_leg.symbolic.base_parameters import group_parameters
from drake_leg.symbolic.decimals import latex_text, plain_text
from drake_leg.symbolic.languages import LANGUAGES, code, latex, text
from drake_leg.symbolic.models import derive_model
from drake_leg.symbolic.par_table import table_of_par
from drake_leg.symbolic.programs import (
    Input,
    Output,
    Program,
    Steps,
    own_operations,
)

RX90 = Path(__file__).parents[2] / "examples" / "symoro" / "rx90.par"
A, B, C = sp.symbols("a b c", real=True)


def test_the_examples_hold():
    assert doctest.testmod(models).failed == 0


def test_an_expression_has_one_name():
    steps = Steps(["a", "b", "c"])
    first = steps.name("x", A * B)
    assert steps.name("y", A * B) == first
    assert steps.name("y", -A * B) == -first
    assert steps.name("z", -A) == -A
    assert steps.name("a", A + C).name == "a_"
    assert len(list(steps)) == 2


def test_what_no_output_needs_is_left_out():
    steps = Steps([])
    used, _ = steps.name("x", A * B), steps.name("y", A * C)
    output = Output(name="z", value=sp.Matrix([steps.result("z", used + 1)]), meaning="")
    assert [str(name) for name, _ in steps.needed([output])] == ["x", "z"]


@pytest.mark.parametrize(
    ("expression", "counts"),
    [
        (A * B + C, [1, 1, 0]),
        (A - B, [0, 1, 0]),
        (-A * B, [1, 0, 0]),
        (A**2 + A**3, [3, 1, 0]),
        (2 * A * B, [2, 0, 0]),
        (1 / A, [1, 0, 0]),
        (B / A, [1, 0, 0]),
        (sp.cos(A + B), [0, 1, 1]),
        (sp.sqrt(2) / 2, [0, 0, 0]),
    ],
)
def test_operations_are_counted(expression, counts):
    assert own_operations(expression) == counts


def test_the_naive_count_writes_every_name_out():
    steps = Steps([])
    x = steps.name("x", A * B)
    y = steps.name("y", x * x)
    value = sp.Matrix([steps.result("z", y + y * x)])
    output = Output(name="z", value=value, meaning="")
    program = Program(
        name="f", title="f", inputs=(), assignments=steps.needed([output]), outputs=(output,)
    )
    # (a b)(a b) + (a b)(a b)(a b)
    assert program.naive_operations.multiplications == 3 + 5
    assert program.operations.multiplications == 3


@pytest.fixture(scope="module")
def programs():
    rng = np.random.default_rng(1)
    arm = robot_of(RX_90, rng)
    tree = robot_of(FORK[:3], rng, floating=True)
    return [
        derive_model(arm, "dynamics"),
        derive_model(arm, "inertia"),
        derive_model(LEG_B, "geometry", within=2),
        derive_model(LEG_B, "velocity"),
        derive_model(LEG_B, "identification", grouped=True),
        derive_model(tree, "direct"),
    ]


def inputs_of(program, rng, *shape):
    return [rng.uniform(-1.0, 1.0, (*shape, len(one.symbols))) for one in program.inputs]


@pytest.mark.slow
def test_printed_numpy_computes_the_same(rng, programs):
    for program in programs:
        names = {}
        exec(code(program, "numpy"), names)
        states = inputs_of(program, rng, 3, 2)
        found = names[program.name](*states)
        expected = program(*states)
        found = found if isinstance(found, tuple) else (found,)
        for value, right in zip(found, expected.values(), strict=True):
            np.testing.assert_allclose(value, right, rtol=1e-13, atol=1e-14)


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("gcc") is None, reason="no gcc on this machine")
def test_printed_c_compiles_without_a_warning_and_computes_the_same(rng, programs, tmp_path):
    for program in programs:
        (tmp_path / f"{program.name}.c").write_text(code(program, "c"))
    library = tmp_path / "models.so"
    sources = [str(tmp_path / f"{program.name}.c") for program in programs]
    flags = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-shared", "-fPIC"]
    subprocess.run(["gcc", *flags, *sources, "-o", str(library), "-lm"], check=True)
    functions = ctypes.CDLL(str(library))
    for program in programs:
        states = inputs_of(program, rng)
        expected = program(*states)
        letters = np.array([program.values[symbol] for symbol in program.letters])
        results = [np.empty_like(value) for value in expected.values()]
        arrays = [*states, *([letters] if len(letters) else []), *results]
        pointers = [array.ctypes.data_as(ctypes.c_void_p) for array in arrays]
        functions[program.name](*pointers)
        for value, right in zip(results, expected.values(), strict=True):
            np.testing.assert_allclose(value, right, rtol=1e-12, atol=1e-13)


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("octave") is None, reason="no Octave on this machine")
def test_printed_matlab_computes_the_same_in_octave(rng, programs, tmp_path):
    """In one process for all, which prints what they return in 17 digits."""
    lines, expected = [], []
    for program in programs:
        (tmp_path / f"{program.name}.m").write_text(code(program, "matlab"))
        states = inputs_of(program, rng)
        given = ["[" + " ".join(map(repr, state.tolist())) + "]" for state in states]
        if program.letters:
            parts = (f"'{s.name}', {program.values[s]!r}" for s in program.letters)
            given.append(f"struct({', '.join(parts)})")
        results = program(*states)
        names = [f"r{k}" for k in range(len(results))]
        lines.append(f"[{', '.join(names)}] = {program.name}({', '.join(given)});")
        lines += [f"printf('%.17g ', {name}'); printf('\\n');" for name in names]
        expected += results.values()
    script = tmp_path / "run_all.m"
    script.write_text("\n".join(lines) + "\n")
    run = ["octave", "--no-gui", "--norc", "--quiet", script.name]
    done = subprocess.run(run, cwd=tmp_path, capture_output=True, text=True, check=True)
    found = [np.array(line.split(), dtype=float) for line in done.stdout.splitlines()]
    assert len(found) == len(expected)
    for value, right in zip(found, expected, strict=True):
        np.testing.assert_allclose(value, right.ravel(), rtol=1e-12, atol=1e-13)


@pytest.mark.parametrize("language", LANGUAGES)
def test_every_language_assigns_every_name(language):
    program = derive_model(LEG_B, "dynamics")
    printed = code(program, language)
    for name, _ in program.assignments:
        assert f"{name} = " in printed
    assert f"{program.name}(" in printed


def test_words_that_a_language_keeps_are_not_used():
    names = sp.symbols("for q double lambda", real=True)
    steps = Steps([symbol.name for symbol in names])
    total = steps.result("sum", sp.Add(*names))
    output = Output(name="sum", value=sp.Matrix([total]), meaning="a sum")
    program = Program(
        name="f",
        title="sum",
        inputs=(Input(name="q", symbols=names[:2], meaning="two numbers"),),
        assignments=steps.needed([output]),
        outputs=(output,),
    )
    found = {}
    exec(code(program, "numpy"), found)
    assert found["f"]([1.0, 2.0], {"double_": 3.0, "lambda_": 4.0}) == pytest.approx([10.0])


def test_text_and_latex_have_every_assignment():
    program = derive_model(LEG_B, "gravity")
    assert "Q3 = " in text(program)
    assert "gravity torques: Q of q" in text(program)
    assert str(program) == text(program)
    lines = latex(program).splitlines()
    assert any(line.startswith("c_{2} = ") for line in lines)
    assert all("=" in line for line in lines if not line.startswith("%"))
    assert program._repr_latex_().count("$$") == 2 * (len(program.assignments) + 1)
    assert repr(program).startswith("<Program gravity: Q, ")


def test_a_language_that_is_not_there_is_refused():
    with pytest.raises(InvalidValueError, match=r"no language 'cobol'.*numpy, c, matlab, julia"):
        derive_model(LEG_B, "gravity").code("cobol")


def test_decimals_of_a_table_are_shown_as_decimals():
    x = sp.Symbol("x")
    shown = {
        sp.Rational(9, 20) * x: "0.45*x",
        sp.Rational(1, 4) * x: "x/4",
        sp.Rational(1, 12): "1/12",
        sp.Rational(123456789, 10**9) - x: "0.123456789 - x",
        sp.Rational(1, 3) * sp.Rational(1, 10**9): "3.33333333333333e-10",
        sp.sqrt(2) * x: "sqrt(2)*x",
    }
    assert {expression: plain_text(expression) for expression in shown} == shown
    assert latex_text(sp.Rational(9, 20) * x) == "0.45 x"


@pytest.mark.slow
def test_base_parameters_of_decimal_tables_have_no_long_fractions():
    table = table_of_par(load_par(RX90), numbers_of({"D3": 0.45, "RL4": 0.4}, "here"))
    found = group_parameters(table)
    assert str(found).splitlines()[0].startswith("ZZR1 = IA1 + 0.2025*M3 + 0.2025*M4")
    assert "0.2025 M_{3}" in found.latex()
