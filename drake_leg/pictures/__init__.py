"""Plots of recordings, and block diagrams as SVG."""
