"""Signals that a model marks for logging are recorded."""

import numpy as np
import pytest
from rigs import Rig, shown

from drake_leg.simulink.logged import SCOPE

ON = '<P Name="DataLogging">on</P>'
FORMS = {
    "new": '<PortProperties><Port Type="out" Index="{}">{}</Port></PortProperties>',
    "old": '<Port><P Name="PortNumber">{}</P>{}</Port>',
}


def logged(rig, sid, texts, *, form="new", port=1):
    rig.blocks[sid].port_properties += FORMS[form].format(port, texts)
    return sid


@pytest.mark.parametrize("form", FORMS)
def test_logged_signals_are_recorded_under_their_names(form, tmp_path):
    rig = Rig()
    logged(rig, rig.block("Clock", "clock"), f'{ON}<P Name="Name">passed</P>', form=form)
    own = '<P Name="DataLoggingNameMode">Custom</P><P Name="DataLoggingName">twice</P>'
    gain = rig.block("Gain", "gain", rig.constant("2"), Gain="3")
    logged(rig, gain, f'{ON}<P Name="Name">x</P>{own}', form=form)
    logged(rig, rig.constant("5"), '<P Name="DataLogging">off</P>', form=form)
    run = rig.run(tmp_path)
    np.testing.assert_allclose(shown(run, "passed"), run.time, atol=1e-12)
    assert set(shown(run, "twice")) == {6.0}
    assert [each.block for each in run.shown] == [SCOPE, SCOPE]


def test_a_signal_that_a_sink_shows_is_not_recorded_twice(tmp_path):
    rig = Rig()
    rig.show(logged(rig, rig.constant("4"), f'{ON}<P Name="Name">a</P>'), "y")
    run = rig.run(tmp_path)
    assert [each.name for each in run.shown] == ["y"]


def test_a_subsystems_output_is_logged_where_nothing_else_reads_it(tmp_path):
    rig = Rig()
    system = rig.block("SubSystem", "inside")
    source = rig.block("Constant", "seven", Value="7", system=system)
    out = rig.add_block("Outport", "out", {"Port": "1"}, ports={"in": 1}, system=system)
    rig.connect(source, f"{out}#in:1")
    logged(rig, system, f'{ON}<P Name="Name">seven</P>')
    assert set(shown(rig.run(tmp_path), "seven")) == {7.0}
