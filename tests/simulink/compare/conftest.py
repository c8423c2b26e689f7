"""Models drawn in many ways, beside the diagrams of the runs."""

import pytest

from drake_leg.robot.robots import ROBOTS
from drake_leg.runs.catalogue import RUNS
from drake_leg.simulink.compare.compare import LiveModel, compare
from drake_leg.simulink.reader import read_model


@pytest.fixture(scope="session")
def live():
    """Diagram of a run, as it starts."""
    known = {}

    def of(name, **options):
        key = (name, repr(options))
        if key not in known:
            kind = RUNS[name]
            chosen = kind.options(**options)
            diagram, start = kind.diagram(chosen)
            root = diagram.CreateDefaultContext()
            start(diagram, root)
            known[key] = LiveModel(
                diagram=diagram,
                root=root,
                robot=next(r for r in ROBOTS if diagram.HasSubsystemNamed(r.name)),
                duration=chosen.duration,
                scheme=chosen.integrator,
            )
        return known[key]

    return of


@pytest.fixture
def compared(tmp_path, live):
    """Comparison of a drawn model with a run."""

    def of(builder, name="leg-b", *, strict=False, **options):
        model = read_model(builder.write(tmp_path / "model.slx"))
        return compare(model, live(name, **options), strict=strict)

    return of
