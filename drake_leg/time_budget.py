"""Moved to progress.py; goes when nothing imports it."""

from drake_leg.progress import *  # noqa: F403
