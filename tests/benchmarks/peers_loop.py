"""Peers of the kinematic loop: sine, inverse Jacobian, integrators, nothing else."""

from __future__ import annotations

import contextlib
import io
import math
import warnings

import numpy as np
from pydrake.systems.analysis import ResetIntegratorFromFlags, Simulator
from pydrake.systems.framework import DiagramBuilder, LeafSystem
from pydrake.systems.primitives import Integrator, LogVectorOutput
from scipy.integrate import solve_ivp

from .measure import timed
from .motion import DURATION, Q0, A, W, foot_error, rates, rates_at, rates_numpy

TOLERANCE = 1e-9  # relative and absolute, of all peers with error control


def _solved(name, right_side, method):
    return timed(
        name,
        lambda _: solve_ivp(
            right_side, (0.0, DURATION), Q0, method=method, rtol=TOLERANCE, atol=TOLERANCE
        ),
        error=lambda solution: foot_error(solution.t, solution.y.T),
    )


def scipy_dop853():
    """SciPy's DOP853 with a right side in math."""
    return _solved("scipy DOP853, math", rates, "DOP853")


def scipy_rk45():
    """SciPy's RK45 with a right side in math."""
    return _solved("scipy RK45, math", rates, "RK45")


def scipy_dop853_numpy():
    """SciPy's DOP853 with a right side in NumPy."""
    return _solved("scipy DOP853, NumPy", rates_numpy, "DOP853")


def pathsim():
    """Pathsim: a source, a function, an integrator and a scope."""
    from pathsim import Connection, Simulation
    from pathsim.blocks import Function, Scope, Source
    from pathsim.blocks import Integrator as Integral
    from pathsim.solvers import RKDP87  # on this loop faster than RKDP54 and RKV65

    def prepare():
        sine, inverse = Source(lambda t: A * math.sin(W * t)), Function(rates_at)
        joints, scope = Integral(np.array(Q0)), Scope()
        simulation = Simulation(
            [sine, inverse, joints, scope],
            [
                Connection(sine, inverse[0]),
                *(Connection(inverse[i], joints[i]) for i in range(3)),
                *(Connection(joints[i], inverse[i + 1], scope[i]) for i in range(3)),
            ],
            Solver=RKDP87,
            dt=0.04,
            log=False,
            tolerance_lte_rel=TOLERANCE,
            tolerance_lte_abs=TOLERANCE,
        )
        return simulation, scope

    def work(prepared):
        simulation, scope = prepared
        simulation.run(DURATION)
        return scope.read()

    return timed(
        "pathsim RKDP87",
        work,
        prepare=prepare,
        error=lambda found: foot_error(np.array(found[0]), np.array(found[1]).T),
    )


def bdsim():
    """Bdsim: a waveform, a function and an integrator, without graphics and checks."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        from bdsim import BDSim

    with contextlib.redirect_stdout(io.StringIO()):
        simulator = BDSim(banner=False, graphics=False, progress=False, sysargs=False)
        diagram = simulator.blockdiagram()
        sine = diagram.WAVEFORM("sine", freq=W, unit="rad/s", amplitude=A)
        inverse = diagram.FUNCTION(lambda v, q: np.array(rates_at(v, *q.tolist())), nin=2)
        joints = diagram.INTEGRATOR(x0=np.array(Q0))
        diagram.connect(sine, inverse[0])
        diagram.connect(joints, inverse[1])
        diagram.connect(inverse, joints)
        diagram.compile()

    def work(_):
        with contextlib.redirect_stdout(io.StringIO()):
            return simulator.run(
                diagram,
                T=DURATION,
                max_step=DURATION,
                solver="DOP853",
                solver_args={"rtol": TOLERANCE, "atol": TOLERANCE},
                checkfinite=False,
            )

    return timed("bdsim DOP853", work, error=lambda found: foot_error(found.t, found.x))


class NumpyLoop(LeafSystem):
    """Inverse Jacobian of a sine as a first leaf system would be written."""

    def __init__(self):
        super().__init__()
        self.DeclareVectorInputPort("q", 3)
        self.DeclareVectorOutputPort("qdot", 3, self._calc)

    def _calc(self, context, output):
        output.SetFromVector(rates_numpy(context.get_time(), self.get_input_port().Eval(context)))


def plain_drake():
    """Drake as its tutorials use it: a leaf in NumPy, error control, logs every 10 ms."""

    def prepare():
        builder = DiagramBuilder()
        inverse, joints = builder.AddSystem(NumpyLoop()), builder.AddSystem(Integrator(list(Q0)))
        builder.Connect(inverse.get_output_port(), joints.get_input_port())
        builder.Connect(joints.get_output_port(), inverse.get_input_port())
        log = LogVectorOutput(joints.get_output_port(), builder, 0.010)
        simulator = Simulator(builder.Build())
        ResetIntegratorFromFlags(simulator, "runge_kutta3", 0.1)
        simulator.get_mutable_integrator().set_target_accuracy(TOLERANCE)
        return simulator, log

    def work(prepared):
        simulator, log = prepared
        simulator.AdvanceTo(DURATION)
        found = log.FindLog(simulator.get_context())
        return np.array(found.sample_times()), np.array(found.data().T)

    return timed(
        "plain Drake, NumPy leaf, RK3 1e-9",
        work,
        prepare=prepare,
        error=lambda found: foot_error(*found),
    )
