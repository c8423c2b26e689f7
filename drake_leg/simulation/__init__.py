"""From a diagram to what its scopes recorded: integrator, stops, progress.

Drake's error control has a trap: when it rejects a step it puts the old state back without
telling the caches, so that whatever depends on the state alone (a plant's kinematics) is used
stale in the repeated step. Runs with error control therefore go without caching; runs at a
given step, the default, reject nothing and keep it.
"""

from drake_leg.simulation.run import LongestStep, Progress, Run, Start, simulate

__all__ = ["LongestStep", "Progress", "Run", "Start", "simulate"]
