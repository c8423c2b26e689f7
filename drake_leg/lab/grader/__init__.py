"""A teacher's grader: printed tables, matrices and singular postures against a robot."""
