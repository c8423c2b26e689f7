"""A Simulink model is run: its diagram, the simulation, and what its sinks recorded."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from time import monotonic

import numpy as np

from drake_leg.arguments import checked, with_article
from drake_leg.errors import InvalidValueError, MissingThingsError, UnknownValueError
from drake_leg.progress import interrupts_kept
from drake_leg.simulation.integrator import require_accuracy
from drake_leg.simulink.dynamics.driven import DrivenMechanism
from drake_leg.simulink.dynamics.system import Contact, MechanismSystem, mechanism_dynamics
from drake_leg.simulink.lacks import lacks_of_block
from drake_leg.simulink.model import LOOPS, Model, number, split_port
from drake_leg.simulink.multibody.connections import acts, refuse
from drake_leg.simulink.networks.reflection import reflected_of
from drake_leg.simulink.running.compiling import (
    A_RUN,
    Code,
    Ports,
    compile_signals,
    missing_for_run,
)
from drake_leg.simulink.running.diagram import Array, ModelDiagram, pattern_of, rates_of
from drake_leg.simulink.running.integrating import (
    ACCURACY,
    automatic_step,
    config_of,
    has_fixed_steps,
    is_stiff,
    solver_of,
)
from drake_leg.simulink.running.left_out import LeftOut, without_constraints
from drake_leg.simulink.running.network import SignalNetwork, signal_network
from drake_leg.simulink.running.rates import Rate
from drake_leg.simulink.running.replacing import replaced
from drake_leg.simulink.running.stepping import MOST_EVALUATIONS, STIFF, Stepper
from drake_leg.simulink.running.system import base_rate
from drake_leg.simulink.running.watching import StepWatch, is_too_short, reason_of
from drake_leg.units import require_non_negative, require_positive

ROWS = 500  # of a recording
SAME_TIME = 1e-9  # [s]
SHORTEST_STEP = 1e-10  # of the duration
MOST_CORNERS = 100_000
_SOLVED = ("none", "warning")  # settings with which Simulink solves algebraic loops
OWN_ACCURACY = 1e-5  # at most, of own steps: finer ones cost little
COARSEST = 1e-3  # relative tolerance of a file that gives none, as Simulink takes it
INTERRUPTED = "interrupted"
SHOWN_TIMES = 5


@dataclass(frozen=True, kw_only=True)
class Shown:
    """What one input of a sink showed."""

    block: str  # path of the sink
    name: str  # of the signal; "" where it has none
    port: int
    values: Array  # (rows, width), a matrix by columns


@dataclass(frozen=True, eq=False, kw_only=True)
class ModelRun:
    """What a run of a model gave."""

    time: Array  # (rows,) [s]
    shown: tuple[Shown, ...]
    states: Array  # (rows, nq + nv) of the mechanism's plant; (rows, 0) without one
    ended: float  # [s]
    began: float = 0.0  # [s]
    stopped: str = ""  # why before its time; "" where it came to its end
    by_block: bool = False  # whether a Stop block ended it
    seconds: float = 0.0  # that the run took
    steps: int = 0
    integrator: str = ""  # Drake's name of it, or those of own steps
    accuracy: float | None = None  # that was asked for; None of fixed steps
    longest_step: float = 0.0  # [s]
    remarks: tuple[str, ...] = ()

    @property
    def complete(self) -> bool:
        """Whether it came to its end, or to where a Stop block ends it."""
        return self.by_block or not self.stopped


@dataclass(frozen=True, eq=False, kw_only=True)
class Runnable:
    """A model that is ready to run."""

    name: str
    diagram: ModelDiagram
    code: Code
    ports: Ports
    network: SignalNetwork
    solver: dict[str, float] = field(default_factory=dict)
    start: Array | None = None  # what enters the mechanism at the start
    remarks: tuple[str, ...] = ()

    @property
    def left_out(self) -> LeftOut:
        """What acts in the model and not here: kinds of blocks, and the names of theirs."""
        return {} if self.diagram.mechanism is None else self.diagram.mechanism.left_out


def has_mechanism(model: Model) -> bool:
    """Tell whether a model has blocks of Simscape Multibody that move or weigh."""
    from drake_leg.simulink.catalogue import JOINTS
    from drake_leg.simulink.multibody.connections import SOLIDS

    return any(
        block.source.startswith("sm_lib/") and block.kind in (*JOINTS, *SOLIDS)
        for block in model.blocks
    )


@checked
def runnable(
    model: Model,
    *,
    duration: float | None = None,
    contact: Contact = "smooth",
    replace: Mapping[str, str] | None = None,
    solve_loops: bool | None = None,
    leave_out: bool = False,
) -> Runnable:
    """Make a model ready to run.

    Parameters
    ----------
    model : Model
        The model.
    duration : float, optional
        Instead of the file's own stop time [s].
    contact : {"smooth", "pulling", "drake"}
        The law of contact forces: the blocks' own, which never pulls or may pull, or Drake's.
    replace : mapping of str to str, optional
        What blocks put out instead of what they would, by name or path: ``"constant 0"``, or the
        name of a CSV file with a table of time and values.
    solve_loops : bool, optional
        Whether algebraic loops are solved, and not only those with an Algebraic Constraint;
        instead of what the file says.
    leave_out : bool
        Whether a mechanism runs without its belts, pulleys and other constraints that are not
        computed, so that its motion is not that of the model.

    Raises
    ------
    InvalidValueError
        That lists all that is missing for a run.
    """
    if duration is not None:
        require_non_negative("the duration", duration, "s")
    model = replaced(model, replace or {})
    if solve_loops is None:
        solve_loops = model.solver.get(LOOPS) in _SOLVED
    mechanism = _mechanism(model, contact, solve_loops, leave_out)
    network = signal_network(model, mechanism.motions if mechanism else frozenset())
    ports = _ports(mechanism, None)
    try:
        solver = solver_of(model, duration, signals_alone=not has_mechanism(model))
    except UnknownValueError as error:
        refuse([str(error), *missing_for_run(network, solve_loops=solve_loops)], A_RUN)
        raise
    _require_known(model, network, ports, solve_loops)

    def compile_with(ports: Ports) -> Code:
        return compile_signals(
            network,
            ports,
            fixed_step=solver.get("fixed step"),
            solve_loops=solve_loops,
            begins=number(model.solver.get("StartTime")),
        )

    code = compile_with(ports)
    if has_fixed_steps(model) and "fixed step" not in solver:
        solver["fixed step"] = automatic_step(solver["duration"], base_rate(code.rates))
        code = compile_with(ports)
    if mechanism is not None and ports.inputs:
        u = _commands(code, ports)
        ports = _ports(mechanism, u)
        code = compile_with(ports)
        if not (code.needs_sensed or code.closing) and mechanism.is_driven:
            mechanism = mechanism.driven()
    return Runnable(
        name=model.name,
        diagram=ModelDiagram(code, mechanism, ports),
        code=code,
        ports=ports,
        network=network,
        solver=solver,
        start=_commands(code, ports) if ports.inputs else None,
    )


def _ports(mechanism: MechanismSystem | DrivenMechanism | None, u: Array | None) -> Ports:
    if mechanism is None:
        return Ports()
    context = mechanism.CreateDefaultContext()
    if u is not None:
        mechanism.start(context, u)
    size = max((place.stop for place in mechanism.inputs.values()), default=0)
    if size:
        mechanism.GetInputPort("u").FixValue(context, np.zeros(size) if u is None else u)
    return Ports(
        inputs=mechanism.inputs,
        motions=mechanism.motions,
        sensed=mechanism.sensed,
        efforts=mechanism.efforts,
        shapes=mechanism.shapes,
        buses=mechanism.buses,
        y=mechanism.GetOutputPort("sensed").Eval(context),
        e=mechanism.GetOutputPort("efforts").Eval(context),
    )


def _mechanism(
    model: Model, contact: Contact, solve_loops: bool, leave_out: bool
) -> MechanismSystem | None:
    """Build the mechanism; what it lacks is one list with what the signals lack."""
    if not has_mechanism(model):
        return None
    try:
        where = () if model.variables is None else model.variables.workspace.folders.all
        found = mechanism_dynamics(
            model, contact=contact, where=where, reflected=reflected_of(model)
        )
        refuse(() if leave_out else [*without_constraints(found.left_out)], A_RUN)
    except InvalidValueError as error:
        problems = error.problems if isinstance(error, MissingThingsError) else (str(error),)
        lacking = [
            *(
                lack.reason
                for block in model.blocks
                if acts(block)
                for lack in lacks_of_block(block)
            ),
            *missing_for_run(signal_network(model), solve_loops=solve_loops),
        ]
        raise MissingThingsError(dict.fromkeys((*problems, *lacking)), A_RUN) from None
    return found


def _require_known(model: Model, network: SignalNetwork, ports: Ports, solve_loops: bool) -> None:
    """Refuse signals that other parts of Simscape would make, with all else that is missing."""
    blocks = {block.sid: block for block in model.blocks}
    unknown = sorted(network.sensed - {*ports.sensed, *ports.efforts})
    found: dict[str, None] = {}
    for port in unknown:
        block = blocks[split_port(port)[0]]
        problem = block.unknown or (
            f"block {block.name!r} (SID {block.sid}) is {with_article(block.kind)}, whose output "
            f"at {port.partition('#')[2]} is not computed here: disconnect it"
        )
        found[problem] = None
    if found:
        refuse([*found, *missing_for_run(network, solve_loops=solve_loops)], A_RUN)


def _commands(code: Code, ports: Ports) -> Array:
    with np.errstate(all="ignore"):
        u: Array = code.functions()["commands"](
            code.begins, code.x.tolist(), list(code.memory), ports.y, ports.e
        )
    return u


@checked
def run_model(
    ready: Runnable,
    *,
    accuracy: float | None = None,
    budget: float | None = None,
    progress: Callable[[float], None] | None = None,
) -> ModelRun:
    """Run a model to its end, a Stop block, a state that is not finite, or the end of its budget.

    Parameters
    ----------
    ready : Runnable
        The model.
    accuracy : float, optional
        Of the integration, relative: 1e-6, or finer where the file asks for it.
    budget : float, optional
        How long the run may take [s].
    progress : callable, optional
        Called with the time since the start that is reached [s].
    """
    if accuracy is not None:
        require_accuracy("the accuracy", accuracy)
    if budget is not None:
        require_positive("the budget", budget, "s")
    diagram = ready.diagram
    diagram.signals.forget()
    context = diagram.CreateDefaultContext()
    if diagram.mechanism is not None:
        diagram.mechanism.start(context, ready.start)
    config = config_of(diagram, ready.solver, accuracy)
    # Short steps of a fine accuracy are no sign of stiffness, nor are those that a file asks for.
    by_error = config.use_error_control
    may_crawl = by_error and config.accuracy >= ACCURACY
    watch = StepWatch(diagram, budget, progress, may_crawl=may_crawl)
    stepper = Stepper(
        diagram,
        context,
        config,
        accuracy=accuracy or min(config.accuracy, OWN_ACCURACY),
        shortest=SHORTEST_STEP * max(ready.solver["duration"], 1.0),
        watch=watch,
        events=diagram.signals,
    )
    coarsest = config.accuracy if accuracy else ready.solver.get("tolerance", COARSEST)
    if by_error and (ready.code.has_edges or is_stiff(diagram, ready.solver, config)):
        _take_own_steps(ready, stepper, coarsest)
    began = monotonic()
    stopped = ""
    try:
        with interrupts_kept(), np.errstate(all="ignore"):
            stepper.begin()
            step = None if by_error else ready.solver["fixed step"]
            for time, is_row in _moments(ready, step, integrates=stepper.has_states):
                is_there = _advance(ready, stepper, watch, time, coarsest)
                if not is_there:
                    break
                if is_row:
                    if diagram.signals.has_events:
                        stepper.finish_events()  # shown is what blocks put out after them
                    diagram.ForcedPublish(context)
    except KeyboardInterrupt:
        stopped = INTERRUPTED
    except (RuntimeError, InvalidValueError, ArithmeticError, IndexError, ValueError) as error:
        stopped = reason_of(error, context, ready.diagram.signals)
    finally:
        stepper.close()
    return _recorded(ready, stepper, watch, stopped, monotonic() - began)


def _moments(
    ready: Runnable, step: float | None, *, integrates: bool = True
) -> Iterator[tuple[float, bool]]:
    """Yield the times to which a run goes, and whether each is that of a row."""
    duration, base = ready.solver["duration"], ready.diagram.signals.base
    yield from moments(ready.code, duration, base, step, integrates=integrates)


def _advance(
    ready: Runnable, stepper: Stepper, watch: StepWatch, time: float, coarsest: float
) -> bool:
    """Go on to a time, and tell whether it was reached.

    Where explicit steps of a mechanism become too short, implicit ones go on. Where no step is
    short enough for its accuracy, the coarsest one that the file asks for is taken from there on;
    and where that does not help, as a signal jumps, the shortest step.
    """

    def is_over() -> bool:
        return bool(watch.stopped)

    while True:
        try:
            is_there = stepper.advance(time, is_over)
        except RuntimeError as error:
            if not is_too_short(str(error)):
                raise
            if stepper.pass_over(time):
                return True
            watch.crawls |= ready.diagram.mechanism is not None
            if stepper.is_stiff or not watch.crawls:
                if not (stepper.relax(coarsest) or stepper.force()):
                    raise
                continue
        if stepper.is_stiff or not watch.crawls:
            return is_there
        stepper.change(STIFF)
        _take_own_steps(ready, stepper, coarsest)


def _take_own_steps(ready: Runnable, stepper: Stepper, coarsest: float) -> None:
    """Go by own steps; they end at rows if something happens at major steps."""
    if not (stepper.has_states or ready.code.has_edges):
        return
    diagram, code, duration = ready.diagram, ready.code, ready.solver["duration"]
    ends = {*corners(code, duration), duration}
    if code.has_major:
        ends |= {time for time, _ in _moments(ready, None)}
    stepper.take_own_steps(
        lambda: rates_of(diagram, stepper.context),
        sorted(ends),
        pattern_of(diagram),
        has_edges=code.has_edges,
        coarsest=coarsest,
    )


def moments(
    code: Code,
    duration: float,
    base: Rate | None,
    step: float | None = None,
    *,
    integrates: bool = True,
) -> Iterator[tuple[float, bool]]:
    """Yield the times at which rows are recorded, or signals have corners, and which it is.

    A row at a sample time is at the very number that Drake makes of it. No fixed step is cut: a
    corner within one takes effect at its end. Where nothing integrates, all fixed steps are there.
    """
    rows = np.linspace(0.0, duration, ROWS + 1) if duration else np.zeros(1)
    between = np.array(sorted(corners(code, duration)))
    if step is not None:
        numbers = [(round(at / step), at) for at in between.tolist()]
        bends = {n: at for n, at in numbers if abs(at - n * step) < SAME_TIME}
        rows = _at_steps(np.round(rows / step), step, duration, bends)
        between = np.zeros(0)
        if not integrates:
            between = _at_steps(np.arange(1.0, duration / step), step, duration, bends)
            between = _at_samples(between, base)
    rows = _at_samples(rows, base)
    kept = dict.fromkeys(between.tolist(), False) | dict.fromkeys(rows.tolist(), True)
    yield from sorted(kept.items())


def _at_steps(numbers: Array, step: float, duration: float, bends: Mapping[int, float]) -> Array:
    """Return the ends of fixed steps: none before a corner that it is to meet, by rounding."""
    ends = (min(max(n * step, bends.get(int(n), 0.0)), duration) for n in numbers.tolist())
    return np.fromiter(ends, dtype=float)


def _at_samples(times: Array, base: Rate | None) -> Array:
    """Put times that are sample times at the very numbers of these."""
    if base is None:
        return times
    hits = base[1] + np.round((times - base[1]) / base[0]) * base[0]
    found: Array = np.where(np.abs(times - hits) < SAME_TIME, hits, times)
    return found


def corners(code: Code, duration: float) -> set[float]:
    """Find the times during a run, since its start, at which signals have corners."""
    times = {at - code.begins for at in code.breaks if 0.0 < at - code.begins < duration}
    for period, offset in code.waves:
        if period > 0.0 and duration / period < MOST_CORNERS:
            first = offset - code.begins
            first = first % period if code.begins < 0.0 else first
            times |= {float(at) for at in np.arange(first, duration, period) if at > 0.0}
    return times


def _said_of_errors(stepper: Stepper, ready: Runnable) -> Iterator[str]:
    """Tell where the error was controlled less, or not at all."""
    begins = ready.code.begins
    if stepper.relaxed is not None:
        yield (
            f"from {stepper.relaxed + begins:.4g} s on the accuracy is that of the file, "
            f"{stepper.config.accuracy:g}: no step there is short enough for "
            f"{stepper.first_accuracy:g}"
        )
    if stepper.damped is not None:
        since, coarse = stepper.damped
        yield (
            f"swings too fast to be shown are damped from {since + begins:.4g} s on, at an "
            f"accuracy of {coarse:g}; `accuracy` lets them be followed"
        )
    if stepper.hurried is not None:
        since, coarse = stepper.hurried
        yield (
            f"from {since + begins:.4g} s on the accuracy is coarser, at last {coarse:g}: at its "
            f"pace the run would take more than {MOST_EVALUATIONS:,} evaluations, as where there "
            "is noise, or a signal jumps to and fro; `accuracy` lets it take them"
        )
    if stepper.forced:
        times = [*dict.fromkeys(f"{time + begins:.4g} s" for time in stepper.forced)]
        more = f", and {len(times) - SHOWN_TIMES} later ones" if len(times) > SHOWN_TIMES else ""
        yield (
            "a signal jumps, or has noise, that no step is short enough for: the error is not "
            f"controlled at {', '.join(times[:SHOWN_TIMES])}{more}"
        )


def _recorded(
    ready: Runnable, stepper: Stepper, watch: StepWatch, stopped: str, seconds: float
) -> ModelRun:
    diagram, context = ready.diagram, stepper.context
    shown: list[Shown] = []
    times: Array = np.zeros(0)
    states: Array = np.zeros((0, 0))
    if diagram.scopes is not None:
        log = diagram.scopes.FindLog(context)
        times, data = log.sample_times().copy(), log.data().T.copy()
        first = 0
        for recorded, width in zip(ready.code.recorded, diagram.signals.widths, strict=True):
            shown.append(
                Shown(
                    block=recorded.block,
                    name=recorded.name,
                    port=recorded.port,
                    values=data[:, first : first + width],
                )
            )
            first += width
    if diagram.states is not None:
        log = diagram.states.FindLog(context)
        times, states = log.sample_times().copy(), log.data().T.copy()
    return ModelRun(
        time=times + ready.code.begins,
        shown=tuple(shown),
        states=states,
        began=ready.code.begins,
        ended=context.get_time() + ready.code.begins,
        stopped=watch.stopped or stopped,
        by_block=watch.by_block,
        seconds=seconds,
        steps=stepper.steps,
        integrator=stepper.integrator,
        accuracy=stepper.accuracy,
        longest_step=stepper.config.max_step_size,
        remarks=(*ready.remarks, *_said_of_errors(stepper, ready)),
    )
