"""``drake-leg inspect``."""

from __future__ import annotations

import argparse
import json
from pathlib import Path


def configure_inspect(parser: argparse.ArgumentParser) -> None:
    """Describe the command and its options."""
    parser.description = (
        "List the blocks of a Simulink model with their settings in SI, its wires, "
        "physical connections, MATLAB functions and solver. No MATLAB is needed, and nothing in "
        "the file is executed."
    )
    parser.add_argument("model", type=Path, metavar="MODEL.slx", help="file saved by Simulink")
    parser.add_argument("--json", action="store_true", help="print JSON")
    parser.set_defaults(command=_inspect)


def _inspect(chosen: argparse.Namespace) -> int:
    from drake_leg.simulink.listing import as_json, as_lines
    from drake_leg.simulink.reader import read_model

    model = read_model(chosen.model)
    if chosen.json:
        print(json.dumps(as_json(model), indent=2, allow_nan=False), flush=True)
    else:
        print("\n".join(as_lines(model)), flush=True)
    return 0
