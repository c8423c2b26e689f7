"""Choose femur and tibia for the longest step of the hexabot's leg with motors of a given torque.

SciPy follows gradients through the simulation; a scan without simulation finds the same lengths.

    python examples/choose_lengths.py

Things to change: the limits TORQUE and SIGMA; LEGS and START. Coxa and start posture are fixed.
"""

from functools import cache

import matplotlib.pyplot as plt
import numpy as np
from scipy.optimize import NonlinearConstraint, brentq, minimize

import drake_leg as dl
from drake_leg.kinematics.leg import LegGeometry, foot_position, inverse_kinematics
from drake_leg.robot.robots import hexabot_leg

TORQUE, SIGMA = 6.0, 15.0  # [mN*m], [mm]: greatest torque, smallest singular value
LEGS, START = 200.0, (110.0, 60.0)  # [mm], femur plus tibia; femur [mm] and amplitude [mm/s]
Q0 = np.radians([90.0, -50.0, -90.0])  # where the run "leg-b" starts


@cache
def results(femur: float, amplitude: float) -> tuple[np.ndarray, np.ndarray]:
    """Stroke [mm], torque [mN*m], singular value [mm]; their slopes by femur and amplitude."""
    changed = {"l2": femur / 1e3, "l3": (LEGS - femur) / 1e3, "amplitude": amplitude / 1e3}
    of = ("stroke_m", "max_torque_n_m", "sigma_min_m")
    step = dl.gradient("leg-b", of=of, by=tuple(changed), duration=3.2, **changed)
    values = np.array([1e3 * result.value for result in step.values()])
    return values, np.array([(by["l2"] - by["l3"], by["amplitude"]) for by in step.values()])


def choose() -> np.ndarray:
    """Return the femur [mm] and the amplitude [mm/s] of the longest step within the limits."""
    within = NonlinearConstraint(
        lambda x: results(*x)[0][1:], [0, SIGMA], [TORQUE, np.inf], lambda x: results(*x)[1][1:]
    )
    stroke = {"fun": lambda x: -results(*x)[0][0], "jac": lambda x: -results(*x)[1][0]}
    return minimize(x0=START, constraints=within, method="SLSQP", **stroke).x


def scanned(femur: float) -> tuple[float, float]:
    """Stroke [mm] that the torque allows where the foot turns back; singular value [mm]."""
    robot = hexabot_leg("B", l2=femur / 1e3, l3=(LEGS - femur) / 1e3)
    leg, moved, plant = LegGeometry.from_robot(robot), dl.movable(robot), dl.build_plant(robot)
    context, (x, y, z) = plant.CreateDefaultContext(), foot_position(leg, Q0)

    def excess(stroke: float) -> float:
        plant.SetPositions(context, q := inverse_kinematics(leg, [x + stroke / 1e3, y, z], Q0))
        qddot = moved.rates(q, [-stroke / 2e3, 0.0, 0.0])  # at rest: J qddot is the acceleration
        weight = plant.CalcGravityGeneralizedForces(context)
        return 1e3 * np.abs(plant.CalcMassMatrix(context) @ qddot - weight).max() - TORQUE

    return brentq(excess, 20.0, 165.0), 1e3 * moved.sigma_min(Q0)


def main() -> plt.Figure:
    """Choose, check the conditions of Kuhn and Tucker, scan, and plot."""
    (stroke, torque, sigma), slopes = results(*(best := choose()))
    by_torque, by_sigma = np.linalg.solve(slopes[1:].T, slopes[0])
    print(f"chosen: a femur of {best[0]:.2f} mm of {LEGS:g}, a stroke of {stroke:.2f} mm")
    print(f"both limits are reached: {torque:.4f} mN*m, {sigma:.4f} mm; to widen them is worth")
    print(f"{by_torque:.2f} mm of stroke per mN*m and {-by_sigma:.2f} mm per mm, both positive")
    strokes, sigmas = np.array(list(map(scanned, femurs := np.arange(80.0, 121.0)))).T
    least = np.interp(SIGMA, sigmas, femurs)
    print(f"scanned: {least:.2f} mm, {np.interp(least, femurs, strokes):.2f} mm")
    figure, axes = plt.subplots(layout="constrained")
    axes.plot(femurs, strokes, label=f"longest stroke with {TORQUE:g} mN·m (scan)")
    axes.axvspan(femurs[0], least, alpha=0.2, label=f"singular value below {SIGMA:g} mm")
    axes.plot(best[0], stroke, "o", label="chosen by SciPy with gradients")
    axes.set(xlabel=f"femur [mm], of {LEGS:g} mm with the tibia", ylabel="stroke [mm]")
    axes.legend()
    return figure


if __name__ == "__main__":
    main()
    plt.show()
