"""Peers of a batch of feet and Jacobians: NumPy, numba, C, and pinocchio in a loop."""

from __future__ import annotations

import ctypes
import shutil
import subprocess
import tempfile
from functools import cache
from pathlib import Path

import numpy as np

from drake_leg.kinematics.khalil import foot_pose, jacobian
from drake_leg.robot.robots import LEG_B

from .measure import scaled, timed
from .motion import L1, L2, L3, SIGN
from .peers_bodies import pinocchio_model

CHECKED = 1000  # postures whose answer is compared with the chain's
LOOPED = 20_000  # postures of a loop in Python, scaled up


@cache
def postures(count):
    """Random joint angles, (count, 3) [rad]."""
    return np.random.default_rng(0).uniform(-np.pi, np.pi, (count, 3))


def batch_error(found, q):
    """Greatest difference of feet and Jacobians from the chain of Khalil's transforms."""
    p, J = (part[:CHECKED] for part in found)
    head = q[:CHECKED]
    feet, columns = foot_pose(LEG_B.rows, head)[:, :3, 3], jacobian(LEG_B.rows, head)[:, 3:]
    return max(np.abs(p - feet).max(), np.abs(J - columns).max())


def _timed(name, work, q):
    return timed(name, lambda _: work(q), error=lambda found: batch_error(found, q))


def whole_arrays(count):
    """The closed form in NumPy, each line over the whole batch."""

    def numpy():
        return _timed("NumPy over whole arrays", _whole_arrays, postures(count))

    return numpy


def _whole_arrays(q):
    c1, s1 = np.cos(q[:, 0]), np.sin(q[:, 0])
    x3, z3 = L3 * np.cos(q[:, 1] + q[:, 2]), L3 * np.sin(q[:, 1] + q[:, 2])
    x, z = L2 * np.cos(q[:, 1]) + x3, L2 * np.sin(q[:, 1]) + z3
    reach = L1 + x
    p = np.stack([c1 * reach, s1 * reach, SIGN * z], axis=-1)
    rows = [
        [-p[:, 1], -c1 * z, -c1 * z3],
        [p[:, 0], -s1 * z, -s1 * z3],
        [np.zeros_like(x), SIGN * x, SIGN * x3],
    ]
    return p, np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def chain(count):
    """The generic chain of Khalil's transforms in NumPy, as this package has it for any robot."""

    def generic_chain():
        def work(q):
            return foot_pose(LEG_B.rows, q)[:, :3, 3], jacobian(LEG_B.rows, q)[:, 3:]

        return _timed("drake-leg, generic chain", work, postures(count))

    return generic_chain


def compiled_by_numba(count):
    """The closed form in a loop that numba compiles, on one thread."""

    def numba():
        from math import cos, sin

        from numba import njit

        @njit(fastmath=True)
        def loop(q, p, J):
            for i in range(len(q)):
                c1, s1 = cos(q[i, 0]), sin(q[i, 0])
                x3, z3 = L3 * cos(q[i, 1] + q[i, 2]), L3 * sin(q[i, 1] + q[i, 2])
                x, z = L2 * cos(q[i, 1]) + x3, L2 * sin(q[i, 1]) + z3
                p[i, 0], p[i, 1], p[i, 2] = c1 * (L1 + x), s1 * (L1 + x), SIGN * z
                J[i, 0, 0], J[i, 0, 1], J[i, 0, 2] = -p[i, 1], -c1 * z, -c1 * z3
                J[i, 1, 0], J[i, 1, 1], J[i, 1, 2] = p[i, 0], -s1 * z, -s1 * z3
                J[i, 2, 0], J[i, 2, 1], J[i, 2, 2] = 0.0, SIGN * x, SIGN * x3

        return _timed("numba, one thread", _into(loop), postures(count))

    return numba


def _into(loop):
    def work(q):
        p, J = np.empty((len(q), 3)), np.empty((len(q), 3, 3))
        loop(q, p, J)
        return p, J

    return work


FLAGS = ("-O3", "-ffast-math", "-march=native", "-fPIC")
C = f"""
#include <math.h>
void loop(long n, const double *restrict q, double *restrict p, double *restrict J) {{
  for (long i = 0; i < n; ++i) {{
    double q1 = q[3*i], q2 = q[3*i+1], q23 = q2 + q[3*i+2];
    double c1 = cos(q1), s1 = sin(q1), x3 = {L3!r}*cos(q23), z3 = {L3!r}*sin(q23);
    double x = {L2!r}*cos(q2) + x3, z = {L2!r}*sin(q2) + z3, reach = {L1!r} + x;
    p[3*i] = c1*reach; p[3*i+1] = s1*reach; p[3*i+2] = {SIGN}*z;
    double *j = J + 9*i;
    j[0] = -s1*reach; j[1] = -c1*z; j[2] = -c1*z3;
    j[3] = c1*reach; j[4] = -s1*z; j[5] = -s1*z3;
    j[6] = 0.0; j[7] = {SIGN}*x; j[8] = {SIGN}*x3;
  }}
}}
"""


def compiled_by_gcc(count):
    """The closed form in C, vectorized by gcc with the mathematics of glibc's libmvec."""

    def gcc():
        compiler = shutil.which("gcc")
        if compiler is None:
            raise ModuleNotFoundError("there is no gcc")
        with tempfile.TemporaryDirectory() as folder:
            source, library = Path(folder, "loop.c"), Path(folder, "loop.so")
            source.write_text(C, encoding="utf-8")
            # Linked apart: with -ffast-math a library would change the rounding of the process.
            compiling = [compiler, *FLAGS, "-c", str(source), "-o", f"{source}.o"]
            subprocess.run(compiling, check=True)
            linking = [compiler, "-shared", f"{source}.o", "-o", str(library), "-lm"]
            subprocess.run(linking, check=True)
            function = ctypes.CDLL(str(library)).loop
        array = np.ctypeslib.ndpointer(dtype=np.float64, flags="C_CONTIGUOUS")
        function.argtypes = [ctypes.c_long, array, array, array]
        function.restype = None
        work = _into(lambda q, p, J: function(len(q), q, p, J))
        return _timed("C, gcc -O3 -ffast-math", work, postures(count))

    return gcc


def pinocchio_loop(count):
    """Pinocchio, one posture after the other."""

    def pinocchio():
        import pinocchio as pin

        model, foot = pinocchio_model()
        data = model.createData()
        axes = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
        some = postures(count)[:LOOPED]

        def work(q):
            p, J = np.empty((len(q), 3)), np.empty((len(q), 3, 3))
            for i, row in enumerate(q):
                J[i] = pin.computeFrameJacobian(model, data, row, foot, axes)[:3]
                p[i] = data.oMf[foot].translation
            return p, J

        return scaled(_timed("pinocchio in a loop", work, some), count / len(some))

    return pinocchio
