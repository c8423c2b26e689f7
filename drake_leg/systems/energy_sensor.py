"""Senses the mechanical energy of a plant."""

from __future__ import annotations

from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.framework import BasicVector, Context

from drake_leg.systems.block import Block
from drake_leg.systems.partial_dynamics import require_plant


class EnergySensor(Block):
    """Outputs the kinetic and potential energy of a plant, of gravity and of springs.

    ========== ===== ===== ======== ================================================
    port       kind  size  unit     meaning
    ========== ===== ===== ======== ================================================
    ``state``  in    n     rad, /s  the plant's state (positions, then velocities)
    ``energy`` out   1     J        the sum; gravity's part is 0 at the world origin
    ========== ===== ===== ======== ================================================

    The block computes in a scratch context of the plant; nothing in it outlives a call.

    Parameters
    ----------
    plant : MultibodyPlant
        Finalized.

    Examples
    --------
    >>> from drake_leg import PENDULUM, EnergySensor, build_plant
    >>> sensor = EnergySensor(build_plant(PENDULUM))
    >>> context = sensor.CreateDefaultContext()
    >>> _ = sensor.GetInputPort("state").FixValue(context, [1.5707963, 0.0])  # hanging, at rest
    >>> sensor.GetOutputPort("energy").Eval(context).round(4).tolist()  # -m g L / 2 [J]
    [-0.0785]
    """

    def __init__(self, plant: MultibodyPlant) -> None:
        Block.__init__(self, plant)
        require_plant(plant)
        self._plant = plant
        self._scratch = plant.CreateDefaultContext()
        self._state = self.DeclareVectorInputPort("state", plant.num_multibody_states())
        self.DeclareVectorOutputPort("energy", 1, self._calc_energy, {self._state.ticket()})

    def _calc_energy(self, context: Context, energy: BasicVector) -> None:
        self._plant.SetPositionsAndVelocities(self._scratch, self._state.Eval(context))
        kinetic = self._plant.EvalKineticEnergy(self._scratch)
        energy.SetFromVector([kinetic + self._plant.EvalPotentialEnergy(self._scratch)])
