"""Moved to files.py; goes when nothing imports it."""

from drake_leg.files import *  # noqa: F403
