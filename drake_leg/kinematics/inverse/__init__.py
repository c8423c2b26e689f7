"""Inverse geometry: closed forms by Pieper and Paul, and a numerical search."""
