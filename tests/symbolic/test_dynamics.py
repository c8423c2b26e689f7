"""Dynamic models in symbols, against Drake, pinocchio, energy and a closed form."""

import time
from dataclasses import replace

import numpy as np
import pytest
import sympy as sp
from bodies import FORK, ODD, RX_90, in_drake, robot_of
from trees import hexapod

from drake_leg import LEG_B, PENDULUM, SCARA
from drake_leg.errors import InvalidValueError
from drake_leg.symbolic.dynamics import coriolis, gravity, inverse_dynamics
from drake_leg.symbolic.inertia import direct_dynamics, inertia
from drake_leg.symbolic.models import derive_model
from drake_leg.symbolic.table import (
    LinkParameters,
    SymbolicRow,
    SymbolicTable,
    table_of_robot,
)

TOLERANCE = 1e-10  # relative


def robots(rng):
    return {
        "pendulum": PENDULUM,
        "scara": SCARA,
        "leg_b": LEG_B,
        "rx_90": robot_of(RX_90, rng),
        "odd": robot_of(ODD, rng),
        "fork": robot_of(FORK, rng),
        "floating": robot_of(FORK, rng, floating=True),
    }


NAMES = [
    pytest.param(name, marks=pytest.mark.slow)
    if name in ("scara", "fork", "rx_90", "floating")
    else name
    for name in robots(np.random.default_rng(0))
]


def close(value, right, scale):
    assert np.abs(value - right).max() <= TOLERANCE * scale


def of_joints_and_base(found, name):
    return np.concatenate([found["base"], found[name]] if "base" in found else [found[name]])


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_the_models_are_drakes(name, rng):
    robot = robots(rng)[name]
    table = table_of_robot(robot)
    models = [f(table) for f in (inverse_dynamics, coriolis, gravity, inertia, direct_dynamics)]
    torques, velocities, weight, matrix, direct = models
    for _ in range(2):
        drake = in_drake(robot, rng)
        q, qdot, _, *base = drake.motion
        w0, g0 = base[:1], base[3:]
        scale = max(np.abs(drake.torques).max(), np.abs(drake.bias).max())
        found = of_joints_and_base(torques(*drake.motion), "tau")
        close(found, drake.torques, scale)
        close(of_joints_and_base(velocities(q, qdot, *w0), "C"), drake.bias, scale)
        close(of_joints_and_base(weight(q, *g0), "Q"), drake.gravity, scale)
        close(matrix(q)["A"], drake.mass_matrix, np.abs(drake.mass_matrix).max())
        if not robot.floating:
            found = direct(q, qdot, drake.torques)["qddot"]
            close(found, drake.accelerations, 1e4)  # the matrix is badly conditioned


@pytest.mark.slow
def test_direct_dynamics_undoes_inverse_dynamics_on_a_floating_base(rng):
    robot = robot_of(FORK[:3], rng, floating=True)
    table = table_of_robot(robot)
    model, bias = direct_dynamics(table), inverse_dynamics(table)
    q, qdot, tau = rng.uniform(-1.0, 1.0, (3, len(robot.moving)))
    w0, g0 = rng.uniform(-1.0, 1.0, (2, 3))
    found = model(q, qdot, tau, w0, g0)
    wd0, vd0 = np.split(found["base"], 2)
    back = bias(q, qdot, found["qddot"], w0, wd0, vd0, g0)
    np.testing.assert_allclose(back["tau"], tau, atol=1e-11)
    np.testing.assert_allclose(back["base"], 0.0, atol=1e-11)  # nothing holds the base


@pytest.mark.slow
def test_a_hexapods_models_are_drakes(rng):
    robot = hexapod()
    torques = derive_model(robot, "dynamics")
    matrix = derive_model(robot, "inertia")
    drake = in_drake(robot, rng)
    found = of_joints_and_base(torques(*drake.motion), "tau")
    close(found, drake.torques, np.abs(drake.torques).max())
    close(matrix(drake.motion[0])["A"], drake.mass_matrix, np.abs(drake.mass_matrix).max())


@pytest.mark.slow
def test_torques_are_linear_in_the_accelerations(rng):
    torques = derive_model(robot_of(RX_90, rng), "dynamics")
    q, qdot, a, b = rng.uniform(-1.0, 1.0, (4, 6))
    at = [torques(q, qdot, each)["tau"] for each in (0 * a, a, b, 2 * a - 3 * b)]
    np.testing.assert_allclose(at[3] - at[0], 2 * (at[1] - at[0]) - 3 * (at[2] - at[0]), atol=1e-11)


@pytest.mark.slow
def test_the_energys_rate_is_the_torques_power(rng):
    robot = robot_of(FORK, rng)
    table = table_of_robot(robot)
    frictionless = replace(
        table, links=tuple(replace(link, FV=sp.Integer(0)) for link in table.links)
    )
    torques, matrix = inverse_dynamics(frictionless), inertia(frictionless)
    weight = gravity(frictionless)
    amplitude, phase = rng.uniform(-1.0, 1.0, (2, 5))

    def motion(t):
        q = amplitude * np.sin(t + phase)
        return q, amplitude * np.cos(t + phase), -q

    def kinetic(t):
        q, qdot, _ = motion(t)
        return qdot @ matrix(q)["A"] @ qdot / 2

    for t in (0.3, 1.1):
        q, qdot, qddot = motion(t)
        power = torques(q, qdot, qddot)["tau"] @ qdot
        rate = (kinetic(t + 1e-5) - kinetic(t - 1e-5)) / 2e-5 + weight(q)["Q"] @ qdot
        assert rate == pytest.approx(power, rel=1e-7)


def planar_arm():
    """Two links in a vertical plane, with a rotor and Coulomb friction, a force at the end."""
    q1, q2 = sp.symbols("q1:3", real=True)
    L = sp.Symbol("L1")
    row = {"joint": "revolute", "r": sp.Integer(0)}
    rows = (
        SymbolicRow(**row, d=sp.Integer(0), alpha=sp.pi / 2, theta=q1),
        SymbolicRow(**row, d=L, alpha=sp.Integer(0), theta=q2, antecedent=1),
    )
    links = tuple(
        LinkParameters(
            **{name: sp.Symbol(f"{name}{n}") for name in ("ZZ", "MX", "M", "IA", "FS")},
            force=(sp.Symbol("FX"), sp.Integer(0), sp.Integer(0)) if n == 2 else (0, 0, 0),
        )
        for n in (1, 2)
    )
    return SymbolicTable(name="planar", rows=rows, q=(q1, q2), links=links)


def test_a_planar_arm_has_the_textbooks_torques(rng):
    model = inverse_dynamics(planar_arm())
    names = [symbol.name for symbol in model.letters]
    letters = dict(zip(names, rng.uniform(0.5, 2.0, len(names)), strict=True))
    q, v, a = rng.uniform(-1.0, 1.0, (3, 2))
    L, g, mx2 = letters["L1"], letters["g"], letters["MX2"]
    h = L * mx2 * np.sin(q[1])
    c2 = np.cos(q[1])
    A = np.array(
        [
            [
                letters["ZZ1"]
                + letters["IA1"]
                + letters["ZZ2"]
                + letters["M2"] * L**2
                + 2 * L * mx2 * c2,
                letters["ZZ2"] + L * mx2 * c2,
            ],
            [letters["ZZ2"] + L * mx2 * c2, letters["ZZ2"] + letters["IA2"]],
        ]
    )
    C = np.array([-h * (2 * v[0] * v[1] + v[1] ** 2), h * v[0] ** 2])
    end = mx2 * np.cos(q.sum())
    G = g * np.array([(letters["MX1"] + letters["M2"] * L) * np.cos(q[0]) + end, end])
    exerted = np.array([letters["FX"] * L * np.sin(q[1]), 0.0])
    dry = np.array([letters["FS1"], letters["FS2"]]) * np.sign(v)
    tau = model(q, v, a, letters=letters)["tau"]
    np.testing.assert_allclose(tau, A @ a + C + G + dry + exerted, rtol=1e-13)


@pytest.mark.slow
def test_models_of_the_size_of_an_rx_90_are_quick(rng):
    robot = robot_of(RX_90, rng)
    start = time.process_time()
    for model in ("geometry", "jacobian", "dynamics", "inertia", "coriolis", "gravity", "direct"):
        derive_model(robot, model)
    assert time.process_time() - start < 20.0
    torques = derive_model(robot, "dynamics")
    states = rng.uniform(-1.0, 1.0, (3, 100_000, 6))
    torques(*states[:, :1])
    start = time.process_time()
    found = torques(*states)["tau"]
    assert time.process_time() - start < 1.0
    assert found.shape == (100_000, 6)
    np.testing.assert_allclose(found[7], torques(*states[:, 7])["tau"], rtol=1e-12)


def test_many_fewer_operations_than_without_names(rng):
    model = derive_model(robot_of(RX_90, rng), "dynamics")
    assert model.operations.multiplications < 320
    assert model.naive_operations.multiplications > 50_000


def test_pinocchio_agrees(rng):
    pin = pytest.importorskip("pinocchio")
    robot = robot_of(RX_90, rng)
    model = pinocchio_model(pin, robot)
    data = model.createData()
    torques = derive_model(robot, "dynamics")
    q, v, a = rng.uniform(-2.0, 2.0, (3, 6))
    friction = np.array([s.mechanics.damping for s in robot.moving]) * v
    expected = pin.rnea(model, data, q, v, a) + friction
    np.testing.assert_allclose(torques(q, v, a)["tau"], expected, rtol=1e-12)
    grouped = derive_model(robot, "identification", grouped=True)
    inertial = [n for n in grouped.outputs[0].columns if n[:2] not in ("FV", "FS", "IA")]
    W = [
        pin.computeJointTorqueRegressor(model, data, *rng.uniform(-2.0, 2.0, (3, 6)))
        for _ in range(60)
    ]
    assert np.linalg.matrix_rank(np.vstack(W), tol=1e-7) == len(inertial)


def pinocchio_model(pin, robot):
    """A serial robot in pinocchio, its joints about z of Khalil's frames."""
    from drake_leg.kinematics.khalil import row_transform
    from drake_leg.symbolic.table import link_numbers

    model = pin.Model()
    model.gravity.linear = np.array([0.0, 0.0, -9.80665])
    joint = 0
    for segment in robot.segments:
        X = row_transform(replace(segment.row, joint="fixed"))
        joint = model.addJoint(
            joint, pin.JointModelRZ(), pin.SE3(X[:3, :3], X[:3, 3]), str(segment.joint)
        )
        own = link_numbers(segment.link)
        centre = np.array([own["MX"], own["MY"], own["MZ"]]) / own["M"]
        x = segment.link.inertial
        xy, xz, yz = x.products
        central = np.diag(x.moments) + np.array([[0, xy, xz], [xy, 0, yz], [xz, yz, 0]])
        model.appendBodyToJoint(joint, pin.Inertia(own["M"], centre, central), pin.SE3.Identity())
    return model


def test_wrong_inputs_are_refused():
    model = derive_model(LEG_B, "dynamics")
    with pytest.raises(InvalidValueError, match="is given 2 inputs; its inputs are q, qdot, qddot"):
        model([0, 0, 0], [0, 0, 0])
    with pytest.raises(
        InvalidValueError, match="qdot of inverse_dynamics must be 3 finite numbers"
    ):
        model([0, 0, 0], [0, 0], [0, 0, 0])
    with pytest.raises(InvalidValueError, match="no letter 'M9'"):
        model([0, 0, 0], [0, 0, 0], [0, 0, 0], letters={"M9": 1.0})
    with pytest.raises(InvalidValueError, match="FX, IA1, IA2, L1"):
        inverse_dynamics(planar_arm())([0, 0], [0, 0], [0, 0], letters={"FS1": 1, "FS2": 1})


@pytest.mark.slow
@pytest.mark.parametrize("name", ["qdot1", "qddot2", "tau1"])
def test_a_letter_may_have_the_name_of_an_input(name):
    table = table_of_robot(LEG_B)
    (length,) = (symbol for symbol in table.values if symbol.name == "l1")
    letter = sp.Symbol(name, real=True)
    values = {letter if one is length else one: value for one, value in table.values.items()}
    rows = tuple(replace(row, d=row.d.xreplace({length: letter})) for row in table.rows)
    named = replace(table, rows=rows, values=values)
    given = np.random.default_rng(2).uniform(-1.0, 1.0, (3, 3))
    for model in (inverse_dynamics, direct_dynamics):
        for plain, other in zip(
            model(table)(*given).values(), model(named)(*given).values(), strict=True
        ):
            assert np.abs(plain - other).max() < 1e-12 * np.abs(plain).max()
