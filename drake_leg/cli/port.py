"""``drake-leg port``: a Simulink model written as a script that builds the same diagram."""

from __future__ import annotations

import argparse
from pathlib import Path

from drake_leg.cli.inputs import add_numbers
from drake_leg.cli.mechanisms import about
from drake_leg.cli.model_files import (
    add_feature_option,
    add_model_options,
    add_model_run_options,
    require_model_file,
)
from drake_leg.cli.terminal import remark
from drake_leg.files import check_file, write_text


def configure_port(parser: argparse.ArgumentParser) -> None:
    """Describe the command and its options."""
    parser.description = (
        "Write a Simulink model as a Python script that builds the same diagram, runs without the "
        "model's file, and gives the same results as 'drake-leg run'. A mechanism, and long "
        "tables, lie in a file of data beside the script."
    )
    parser.add_argument("name", metavar="MODEL.slx", help="Simulink model (.slx, .mdl)")
    parser.add_argument(
        "--out", required=True, type=Path, metavar="FILE.py", help="script to write"
    )
    parser.add_argument("--overwrite", action="store_true", help="replace files that exist")
    parser.add_argument(
        "--duration", metavar="X", help="duration of the run [s] (default: the model's stop time)"
    )
    parser.add_argument(
        "--accuracy", metavar="X", help="relative accuracy of the integration (default 1e-6)"
    )
    add_model_options(parser)
    add_feature_option(parser)
    add_model_run_options(parser)
    add_numbers(parser)
    parser.set_defaults(command=_port)


def _port(chosen: argparse.Namespace) -> int:
    from drake_leg.cli.model_run import positive, require_meant, runnable_file

    path, out = Path(chosen.name), chosen.out
    require_model_file(path)
    duration, accuracy = (positive(chosen, name) for name in ("duration", "accuracy"))
    check_file(out, endings=(".py",), overwrite=chosen.overwrite)
    from drake_leg.simulink.running.left_out import motion_of_another
    from drake_leg.simulink.running.porting import data_name, ported

    beside = out.with_name(data_name(out.stem))
    check_file(beside, endings=(".json",), overwrite=chosen.overwrite)
    model, ready, said = runnable_file(path, chosen, duration=duration)
    require_meant(chosen, ready)
    with about(path):
        script = ported(
            model, ready, out.stem, contact=chosen.contact or "smooth", accuracy=accuracy
        )
    if script.data:
        write_text(beside, script.data, ending=".json", overwrite=chosen.overwrite)
    write_text(out, script.text, ending=".py", overwrite=chosen.overwrite)
    lines = len(script.text.splitlines())
    print(f"wrote {out}: {lines} lines, whose diagram puts out the same as the model at the start")
    if script.data:
        print(f"wrote {beside}")
    for sentence in (*motion_of_another(ready.left_out), *said):
        remark(sentence)
    return 0
