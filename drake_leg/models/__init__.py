"""Converts a robot to SDF and to a MultibodyPlant, and proves that they agree."""
