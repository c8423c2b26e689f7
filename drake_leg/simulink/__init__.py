"""Simulink models: read from their files, listed, and compared with the live diagrams."""

ENDINGS = (".slx", ".mdl")  # of files that hold a model or a library
