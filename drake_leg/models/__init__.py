"""From a robot as data to SDF and to a MultibodyPlant."""
