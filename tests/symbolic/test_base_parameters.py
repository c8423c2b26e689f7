"""Identification models and base parameters."""

from dataclasses import replace

import numpy as np
import pytest
import sympy as sp
from bodies import FORK, ODD, RX_90, robot_of
from trees import hexapod

from drake_leg import LEG_B, PENDULUM, SCARA
from drake_leg.robot.robot import Row
from drake_leg.symbolic.base_parameters import group_parameters
from drake_leg.symbolic.dynamics import inverse_dynamics
from drake_leg.symbolic.models import base_parameters
from drake_leg.symbolic.regressor import Parameter, parameters, regressor, with_all_parameters
from drake_leg.symbolic.table import LinkParameters, SymbolicTable, table_of_robot

TILTED = (  # a sliding joint across a turning one
    Row(joint="revolute"),
    Row(joint="prismatic", d=0.3, alpha=0.7),
    Row(joint="revolute", d=0.2, alpha=-0.5),
)


def general(rows, rng, **base):
    return with_all_parameters(table_of_robot(robot_of(rows, rng, **base)))


def tables(rng):
    return {
        "pendulum": with_all_parameters(table_of_robot(PENDULUM)),
        "scara": with_all_parameters(table_of_robot(SCARA)),
        "leg_b": with_all_parameters(table_of_robot(LEG_B)),
        "odd": general(ODD, rng),
        "tilted": general(TILTED, rng),
        "floating": general(FORK[:3], rng, floating=True),
        "given": table_of_robot(LEG_B),  # without the parameters that are zero
    }


NAMES = [
    pytest.param(name, marks=pytest.mark.slow)
    if name in ("odd", "tilted", "scara", "floating")
    else name
    for name in tables(np.random.default_rng(0))
]


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_regressors_give_the_torques_and_only_that_of_base_parameters_has_full_rank(name, rng):
    table = tables(rng)[name]
    found = group_parameters(table)
    letters = {symbol.name: rng.uniform(0.3, 1.2) for symbol in table.free_symbols}
    models = [inverse_dynamics(table), inverse_dynamics(found.reduced_table)]
    states = [rng.uniform(-2.0, 2.0, (60, len(one.symbols))) for one in models[0].inputs]
    numbers = {symbol: sp.Float(letters[symbol.name]) for symbol in table.free_symbols}
    base = {
        found.name(kept): float(found.expression(kept).xreplace(numbers)) for kept in found.groups
    }

    def torques(model):
        known = letters | base
        own = {symbol.name: known[symbol.name] for symbol in model.letters}
        results = model(*states, letters=own)
        return np.concatenate([results[n] for n in ("base", "tau") if n in results], axis=-1)

    right = torques(models[0])
    np.testing.assert_allclose(torques(models[1]), right, atol=1e-11)
    columns = parameters(table)
    for W, chi in (
        (regressor(table, columns), [letters[str(each)] for each in columns]),
        (found.regressor(), [base[each] for each in found.names]),
    ):
        own = {symbol.name: letters[symbol.name] for symbol in W.letters}
        matrix = W(*states, letters=own)["W"]
        np.testing.assert_allclose(matrix @ np.array(chi), right, atol=1e-11)
        assert len(W.outputs[0].columns) == len(chi)
        rank = np.linalg.matrix_rank(matrix.reshape(-1, len(chi)), tol=1e-8)
        assert rank == len(found.groups)


@pytest.fixture(scope="module")
def rx_90():
    return base_parameters(robot_of(RX_90, np.random.default_rng(1)))


@pytest.mark.slow
def test_an_rx_90_has_the_textbooks_base_parameters(rx_90):
    found = rx_90
    inertial = [kept for kept in found.groups if kept.name not in ("FV", "FS")]
    assert len(inertial) == 40
    D3, RL4 = sp.Symbol("l1", positive=True), sp.Symbol("h", positive=True)

    def group(text):
        return found.expression(Parameter(link=int(text[-1]), name=text[:-1]))

    def p(name):
        return sp.Symbol(name, real=True)

    outer = p("M4") + p("M5") + p("M6")
    textbook = {
        "ZZ1": p("IA1") + p("ZZ1") + p("YY2") + p("YY3") + D3**2 * (p("M3") + outer),
        "XX2": p("XX2") - p("YY2") - D3**2 * (p("M3") + outer),
        "XZ2": p("XZ2") - D3 * p("MZ3"),
        "ZZ2": p("IA2") + p("ZZ2") + D3**2 * (p("M3") + outer),
        "MX2": p("MX2") + D3 * (p("M3") + outer),
        "XX3": p("XX3") - p("YY3") + p("YY4") + 2 * RL4 * p("MZ4") + RL4**2 * outer,
        "ZZ3": p("ZZ3") + p("YY4") + 2 * RL4 * p("MZ4") + RL4**2 * outer,
        "MY3": p("MY3") + p("MZ4") + RL4 * outer,
        "XX4": p("XX4") - p("YY4") + p("YY5"),
        "ZZ4": p("ZZ4") + p("YY5"),
        "MY4": p("MY4") - p("MZ5"),
        "XX5": p("XX5") - p("YY5") + p("YY6"),
        "ZZ5": p("ZZ5") + p("YY6"),
        "MY5": p("MY5") + p("MZ6"),
        "XX6": p("XX6") - p("YY6"),
    }
    for name, right in textbook.items():
        assert sp.expand(group(name) - right) == 0, name
    assert [str(each) for each in found.without_effect] == (
        ["XX1", "XY1", "XZ1", "YY1", "YZ1", "MX1", "MY1", "MZ1", "M1", "MZ2", "M2"]
    )
    assert found.name(Parameter(link=2, name="ZZ")) == "ZZR2"
    assert found.name(Parameter(link=2, name="XY")) == "XY2"


@pytest.mark.slow
def test_a_grouping_may_have_a_quotient_of_the_angles_waves(rng):
    found = group_parameters(general(TILTED, rng))
    (kept,) = [kept for kept in found.groups if str(kept) == "MY2"]
    tilt = sp.Symbol("alpha2", real=True)
    share = found.groups[kept][Parameter(link=2, name="MZ")]
    assert sp.simplify(share + sp.tan(tilt)) == 0


def test_gravity_along_the_first_axis_hides_its_links_first_moments(rng):
    upright, tilted = (
        {str(each) for each in group_parameters(general(rows, rng)).without_effect}
        for rows in (RX_90[:2], (Row(joint="revolute", alpha=0.3), RX_90[1]))
    )
    assert {"MX1", "MY1"} <= upright
    assert not {"MX1", "MY1"} & tilted


def test_the_numbers_of_base_parameters_follow_from_the_links(rx_90):
    found = rx_90
    assert set(found.values) == set(found.names)
    own = {symbol.name: value for symbol, value in found.table.values.items()}
    assert found.values["XXR6"] == pytest.approx(own["XX6"] - own["YY6"])
    assert found.values["MYR5"] == pytest.approx(own["MY5"] + own["MZ6"])


def test_a_parameter_that_is_declared_zero_is_left_out_or_holds_what_is_grouped():
    table = table_of_robot(LEG_B)
    links = [LinkParameters(ZZ=sp.Symbol("ZZ1")), *table.links[1:]]
    table = SymbolicTable(
        name="leg", rows=table.rows, q=table.q, links=tuple(links), gravity=table.gravity
    )
    found = group_parameters(table)
    assert "XXR2" in found.names
    assert Parameter(link=1, name="XX") not in found.groups


@pytest.mark.slow
def test_a_hexapod_has_base_parameters(rng):
    found = base_parameters(hexapod())
    assert len(found.groups) == 10 + 18 * (7 + 1 + 2)
    assert not found.without_effect


def test_a_base_that_floats_has_no_joint_and_no_parameters_of_one():
    table = table_of_robot(hexapod())
    base = replace(table.base, IA=sp.Symbol("IA0"), FV=sp.Symbol("FV0"), FS=sp.Symbol("FS0"))
    names = {str(one) for one in parameters(replace(table, base=base))}
    assert "M0" in names
    assert not names & {"IA0", "FV0", "FS0"}
