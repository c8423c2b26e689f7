"""VTK is tried by a process of its own, whatever becomes of it."""

import operator
import signal

import pytest

from drake_leg.lab.page import trial
from drake_leg.processes import begin_process
from drake_leg.scene import artists


@pytest.mark.slow
def test_the_trial_tells_what_became_of_it(monkeypatch):
    assert trial.RenderingTrial().fault() == artists.rendering_fault()
    monkeypatch.setattr(trial, "_try_rendering", operator.methodcaller("send", "no light"))
    assert trial.RenderingTrial().fault() == "no light"
    monkeypatch.setattr(
        trial, "begin_process", lambda *_: begin_process(signal.raise_signal, signal.SIGSEGV)
    )
    assert trial.RenderingTrial().fault() == f"the renderer was ended by signal {signal.SIGSEGV:d}"
