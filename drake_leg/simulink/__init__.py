"""Simulink models: read from their files, listed, and compared with the live diagrams."""
