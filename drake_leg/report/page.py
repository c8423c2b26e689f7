"""The page: runs carried out, figures drawn, one self-contained HTML file."""

from __future__ import annotations

import base64
import platform
from collections.abc import Callable
from html import escape
from importlib.metadata import version
from pathlib import Path

from drake_leg.figures.style import save
from drake_leg.report.content import (
    CHAPTERS,
    RUNS,
    PlotItem,
    TableItem,
    carry_out,
    command,
    deviation,
)
from drake_leg.report.errata import errata_chapter
from drake_leg.report.formulas import as_html
from drake_leg.report.matrices import Comparison
from drake_leg.report.style import STYLE_SHEET
from drake_leg.robot import Robot
from drake_leg.runs.outcome import Outcome

STAGES = len(RUNS) + sum(len(chapter.items) for chapter in CHAPTERS)


def write_report(folder: Path, progress: Callable[[float], None]) -> None:
    """Write ``report.html`` and its figures.

    Parameters
    ----------
    folder : Path
        Existing, to be written into.
    progress : callable
        Called with the number of stages done, of ``STAGES``.

    Raises
    ------
    OSError
        If something cannot be written.
    """
    done = 0
    outcomes = {}
    for key in RUNS:
        outcomes[key] = carry_out(key)
        done += 1
        progress(done)
    body = []
    for chapter in CHAPTERS:
        body.append(f"<h2>{escape(chapter.title)}</h2>\n<p>{escape(chapter.introduction)}</p>")
        for item in chapter.items:
            if isinstance(item, PlotItem):
                body.append(_plot_section(item, outcomes[item.run], folder))
            else:
                body.append(_table_section(item))
            done += 1
            progress(done)
    body.append(errata_chapter())
    page = _page(_overview(outcomes), "\n".join(body))
    (folder / "report.html").write_text(page, encoding="utf-8")


def _page(overview: str, body: str) -> str:
    return f"""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>A pendulum, a hexabot leg and a SCARA arm on Drake</title>
<style>{STYLE_SHEET}</style>
</head>
<body>
<main>
<h1>A pendulum, a hexabot leg and a SCARA arm on Drake</h1>
<p>Two student reports modelled these robots with MATLAB, Simulink and Simscape Multibody. Here
are their time plots, tables and matrices, simulated by Drake from SDF, in the reports' order.
Each item says how far it is from the exact answer, and each plot which command reproduces it.
Where a report is wrong in print, that is said there, and again in the <a href="#errata">list of
errata</a> at the end.</p>
<p>Report A: F. Olanrewaju, N. Jabeen, <cite>Modeling of a Simple Pendulum and a Hexabot Leg using
MATLAB/Simulink</cite>. Report B: M. E. Deowan, T. M. Hossain, <cite>Geometric, Kinematic and
Dynamical modeling of Robotic systems</cite>, Université de Toulon, 2023.</p>
{overview}
{body}
<footer>drake-leg {version("drake-leg")}, Drake {version("drake")}, Python
{platform.python_version()}.</footer>
</main>
</body>
</html>
"""


def _overview(outcomes: dict[str, Outcome]) -> str:
    rows = []
    for key, outcome in outcomes.items():
        summary = outcome.summary
        if "max_position_error_m" in summary:
            error = f"{_power(summary['max_position_error_m'])} m"
        else:
            error = f"{_power(summary['max_angle_error_rad'])} rad"
        rows.append(
            f"<tr><td><code>{escape(command(key))}</code></td>"
            f"<td>{summary['duration_s']:g} s</td><td>{summary['rows']}</td>"
            f"<td>{summary['real_time_factor']:.0f} ×</td><td>{error}</td></tr>"
        )
    return (
        '<h2>The runs</h2>\n<div class="wide"><table class="data">\n<thead><tr><th>command</th>'
        "<th>simulated</th><th>steps</th><th>real time</th><th>from the exact answer</th></tr>"
        f"</thead>\n<tbody>{''.join(rows)}</tbody></table></div>"
    )


def _plot_section(item: PlotItem, outcome: Outcome, folder: Path) -> str:
    figure = item.draw(outcome, f"{item.heading}: {outcome.robot.title}")
    png = next(path for path in save(figure, folder, item.name) if path.suffix == ".png")
    image = base64.b64encode(png.read_bytes()).decode("ascii")
    return (
        f'<section id="{item.name}">\n<h3>{escape(item.heading)}</h3>\n<figure>'
        f'<img src="data:image/png;base64,{image}" alt="{escape(item.caption)}">'
        f"<figcaption>{escape(item.caption)}</figcaption></figure>\n"
        f"{_correction(item.correction)}"
        f'<p class="proof">From the exact answer: at most '
        f"{_power(deviation(item, outcome))} {escape(item.unit)}. "
        f"Reproduced by <code>{escape(command(item.run))}</code></p>\n</section>"
    )


def _table_section(item: TableItem) -> str:
    blocks = "\n".join(_matrix(comparison) for comparison in item.compare())
    return (
        f'<section id="{item.name}">\n<h3>{escape(item.heading)}</h3>\n'
        f"<p>{escape(item.caption)}</p>\n{_khalil_table(item.robot)}\n"
        f"{_correction(item.correction)}"
        f"<p>Evaluated at {escape(item.posture)}, lengths in m:</p>\n{blocks}\n</section>"
    )


def _correction(text: str) -> str:
    return f'<p class="correction"><b>In print:</b> {escape(text)}</p>\n' if text else ""


def _khalil_table(robot: Robot) -> str:
    head = "<th>frame</th><th>σ</th><th>d [m]</th><th>α [rad]</th><th>r [m]</th><th>θ [rad]</th>"
    rows = []
    position = 0
    for number, row in enumerate(robot.rows, start=1):
        r, theta = f"{row.r:g}", f"{row.theta:g}"
        if row.joint != "fixed":
            position += 1
            variable = f"<i>q</i><sub>{position}</sub>"
            r, theta = (r, variable) if row.joint == "revolute" else (variable, theta)
        sigma = "~" if row.sigma is None else row.sigma
        alpha = f"{row.alpha:.4g}".replace("-", "−")
        cells = (number, sigma, f"{row.d:g}", alpha, r, theta)
        rows.append("<tr>" + "".join(f"<td>{cell}</td>" for cell in cells) + "</tr>")
    return (
        f'<div class="wide"><table class="data"><thead><tr>{head}</tr></thead>'
        f"<tbody>{''.join(rows)}</tbody></table></div>"
    )


def _matrix(comparison: Comparison) -> str:
    formula = _grid([[as_html(entry) for entry in row] for row in comparison.formula])
    value = _grid([[_number(entry) for entry in row] for row in comparison.value])
    name = comparison.name.replace("T", "T<sub>", 1)
    name += "</sub>" if name != comparison.name else ""
    return (
        f'<div class="wide matrix"><span class="name">{name}</span> <span>=</span> {formula} '
        f"<span>=</span> {value}"
        f' <span class="proof">from the chain {_power(comparison.from_chain)}, '
        f"from Drake {_power(comparison.from_drake)}</span></div>"
    )


def _grid(cells: list[list[str]]) -> str:
    rows = "".join("<tr>" + "".join(f"<td>{c}</td>" for c in row) + "</tr>" for row in cells)
    return f'<table class="grid">{rows}</table>'


def _number(value: float) -> str:
    if abs(value - round(value)) < 5e-13:
        text = f"{round(value)}"
    else:
        text = f"{value:.4f}" if abs(value) > 1e-3 else f"{value:.6g}"
    return text.replace("-", "−")


def _power(value: float) -> str:
    if value == 0.0:
        return "0"
    digits, _, exponent = f"{value:.1e}".partition("e")
    return f"{digits} · 10<sup>{exponent.lstrip('+0').replace('-0', '−').replace('-', '−')}</sup>"
