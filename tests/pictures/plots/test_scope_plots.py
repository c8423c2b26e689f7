"""Figures of the sinks of a model."""

import numpy as np

from drake_leg.pictures.plots.scope_plots import figure_of
from drake_leg.simulink.running.columns import Column, Label, SinkFigure


def test_a_long_path_stays_inside_the_figure():
    time = np.linspace(0.0, 1.0, 5)
    label = Label(header="y", name="y", sink="Scope", kind="Scope", port=1, signal="y")
    path = "/".join(["Subsystem of the whole arm"] * 3 + ["a" * 90])
    column = Column(label=label, values=time)
    sink = SinkFigure(file_name="scope", title=path, axes=((column,),), is_xy=False)
    figure = figure_of("model", time, sink)
    figure.canvas.draw()
    (title,) = [text for text in figure.texts if text.get_text().startswith("model: ")]
    assert title.get_text().replace("\n", "").replace(" ", "") == f"model:{path}".replace(" ", "")
    box = title.get_window_extent()
    assert figure.bbox.x0 <= box.x0
    assert box.x1 <= figure.bbox.x1


def test_long_names_leave_their_axes_as_wide_as_short_ones():
    time = np.linspace(0.0, 1.0, 5)

    def width_of(length):
        names = [f"{chr(97 + n)}{'x' * length}" for n in range(12)]
        labels = [Label(header=n, name=n, sink="S", kind="Scope", port=1, signal=n) for n in names]
        columns = tuple(Column(label=label, values=time) for label in labels)
        sink = SinkFigure(file_name="scope", title="S", axes=(columns,), is_xy=False)
        figure = figure_of("model", time, sink)
        figure.canvas.draw()
        (axes,) = figure.axes
        legend = axes.get_legend().get_window_extent()
        assert figure.bbox.x0 <= legend.x0
        assert legend.x1 <= figure.bbox.x1
        assert legend.y1 <= figure.bbox.y1
        assert axes.bbox.height > 100.0
        return axes.bbox.width

    assert abs(width_of(40) - width_of(1)) < 5.0
