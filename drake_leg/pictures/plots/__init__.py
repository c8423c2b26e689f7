"""Plots of recordings, robots and singularities; imports no Drake."""
