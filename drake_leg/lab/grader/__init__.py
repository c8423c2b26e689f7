"""Grades printed tables, matrices and singular postures against a robot."""
