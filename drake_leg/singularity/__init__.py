"""Singularities: where they are, what they take from a robot, and how rates stay bounded there."""
