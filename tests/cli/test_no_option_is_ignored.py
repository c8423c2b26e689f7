"""What is not given is None, and no option is ignored: two tables of all options, both complete."""

import dataclasses
from pathlib import Path

import pytest

from drake_leg.cli import main
from drake_leg.cli.entry import _build_parser
from drake_leg.errors import InvalidValueError
from drake_leg.robot.joint_mechanics import StateTarget
from drake_leg.robot.robots import LEG_B
from drake_leg.runs import pendulum, step
from drake_leg.runs.catalogue import RUNS
from drake_leg.runs.options import StraightOptions

ROOT = Path(__file__).parents[2]
MODEL = str(ROOT / "notebooks" / "leg.slx")
PRINTED = ROOT / "tests" / "lab" / "grader" / "printed"

# --- options that mean something whatever else is given, and those that may not --------------

OF_RUNS = {
    "--config", "--duration", "--gravity", "--integrator", "--damping", "--q0", "--amplitude",
    "--inverse", "--correction", "--q0-error", "--push", "--mass-error", "--torque-limit", "--l1",
    "--l2", "--l3", "--density", "--filter-time-constant", "--feedback", "--lift", "--tool-height",
    "--size", "--velocity-target", "--lower-limit", "--upper-limit", "--spring-stiffness",
    "--spring-unit", "--task", "--dynamics", "--tip", "--swing",
    # of walks
    "--robot", "--gait", "--phases", "--duty", "--period", "--speed", "--sideways", "--turn",
    "--distance", "--angle", "--height", "--roll", "--pitch", "--shift", "--servo", "--effort",
    "--feed-forward", "--payload", "--push-speed", "--time-step", "--foot-radius",
    "--foot-stiffness", "--friction", "--level", "--touch-down",
    "--slope", "--across", "--steps", "--blocks", "--dynamic", "--force",
}  # fmt: skip

ALWAYS = {
    "list": set(),
    "run": OF_RUNS | {"--out", "--overwrite", "--figures", "--replay", "--video", "--stills",
                      "--max-step", "--stiffness"},
    "replay": {"--out", "--overwrite", "--from", "--robot"},
    "view": {"--q", "--still", "--from", "--frames", "--no-frames"},
    "teleop": {"--q", "--task", "--tip", "--host", "--port", "--no-browser", "--once"},
    "report": {"--out", "--overwrite"},
    "derive": {"--latex", "--budget", "--model"},
    "errata": {"--json"},
    "doctor": {"--q", "--tip", "--direction", "--frequency", "--foot", "--json", "--out"},
    "inverse": {"--foot", "--json", "--pose", "--q", "--tip"},
    "sdf": {"--toml", "--par", "--out"},
    "check": {"--printed", "--json"},
    "port": {"--path", "--init", "--variant", "--parameter", "--feature",
             "--set", "--replace", "--duration",
             "--accuracy", "--out", "--overwrite", "--contact", "--solve-loops",
             "--leave-out"},
    "inspect": {"--blocks", "--json", "--path", "--init", "--variant", "--parameter"},
    "compare": OF_RUNS | {"--path", "--init", "--variant", "--parameter", "--feature", "--json",
                          "--strict", "--frequency", "--direction", "--gain"},
    "diagram": {"--path", "--init", "--variant", "--parameter", "--part", "--system",
                "--background", "--out", "--overwrite"},
}  # fmt: skip

NO_LIMIT = "there is no limit"
OF_RUNS_MEANINGLESS = [
    ("leg-b --damped-below 0.01", "means nothing to the inverse 'exact'"),
    ("leg-b --rate-limit 100", "means nothing to the inverse 'exact'"),
    ("leg-b --rate-limit 100 --inverse damped", "means nothing to the inverse 'damped'"),
    ("leg-b --push-at 2", "there is no push"),
    ("leg-b --push-for 0.1", "there is no push"),
    ("leg-b --damping-unit N*m/(deg/s)", "there is no damping"),
    ("pendulum --damping-unit N*m*s/rad", "there is no damping"),
    ("pendulum --limit-stiffness 100", NO_LIMIT),
    ("pendulum-damped --limit-damping 0", NO_LIMIT),
    ("pendulum-spring --limit-width 0.1", NO_LIMIT),
    ("pendulum-spring --target 30 --spring-stiffness 0", "nothing pulls there"),
    ("hexapod --push-direction 90", "means nothing without --push-speed"),
    ("hexapod --then speed=0,at=5 --distance 1", "--then means nothing with a --distance"),
    ("hexapod --search-depth 0.02", "means nothing without --touch-down"),
    ("hexapod --step-count 2", "means nothing without --steps"),
    ("hexapod --step-run 0.1", "means nothing without --steps"),
    ("hexapod --block-seed 1", "means nothing without --blocks"),
    ("leg-b --lift 0.04", "leg-b has no option --lift: only ellipse, hexapod have it"),
]

NO_LETTERS = "gives numbers to the letters of a .par file, and leg-b has none"

MEANINGLESS = [
    *(
        (command, f"leg-b --set D3=1{more}", NO_LETTERS)
        for command, more in (
            ("run", ""),
            ("sweep", " --vary l1=0.04:0.06:2 --out s"),
            ("view", ""),
            ("teleop", ""),
            ("derive", ""),
            ("doctor", ""),
            ("inverse", " --q 90,-50,-90"),
            ("sdf", ""),
            ("check", ""),
            ("diagram", " --out a.svg"),
        )
    ),
    *(
        (command, f"leg-b {option}", "is for Simulink models and means nothing here")
        for command in ("sdf", "view", "doctor")
        for option in ("--path .", "--init a.m", "--variant A=B", "--parameter A:B=1",
                       "--feature a.step:f=1,2,3")
    ),
    ("replay", "somewhere --set D3=1 --out a.html", "means nothing without --robot"),
    ("compare", "leg-b --set D3=1", "the model uses no variable 'D3'"),
    ("diagram", f"{MODEL} --set D3=1 --out a.svg", "the model uses no variable 'D3'"),
    ("inspect", f"{MODEL} --set D3=1", "the model uses no variable 'D3'"),
    ("diagram", "leg-b --system Leg --out a.svg", "is for Simulink models and means nothing"),
    ("diagram", "leg-b --part frames --system A --out a.svg", "is for Simulink models and"),
    ("diagram", "leg-b --init a.m --out a.svg", "is for Simulink models and means nothing"),
    *(
        ("run", f"leg-b {option}", "is for Simulink models and means nothing here")
        for option in ("--path .", "--init a.m", "--variant A=B", "--parameter A:B=1",
                       "--feature a.step:f=1,2,3",
                       "--contact smooth",
                       "--solve-loops", "--leave-out", "--replace A=b.csv", "--page a.html")
    ),
    ("run", f"{MODEL} --config a.yaml", "means nothing to a Simulink model"),
    ("run", f"{MODEL} --amplitude 0.05", "means nothing to a Simulink model"),
    *(("run", words, said) for words, said in OF_RUNS_MEANINGLESS),
    ("run", "hexapod --then gait=wave", "as in 'gait=wave speed=0.03 at=5; sideways=0.1 at=20'"),
    ("run", "leg-b --accuracy 1e-6 --integrator explicit_euler", "means nothing to it"),
    ("run", "leg-b --frequency 2 --amplitude 0", "the amplitude is 0"),
    ("run", "scara --direction 0,1,0 --amplitude 0", "the amplitude is 0"),
    ("run", "ellipse --direction 0,1,0 --amplitude 0", "the amplitude is 0"),
    ("run", "ellipse --frequency 2 --amplitude 0 --lift 0", "the amplitude and the lift are 0"),
    ("run", "leg-b --gain 2 --amplitude 0", "the amplitude is 0"),
    ("run", "leg-b --force --inverse damped", "--force means nothing with --inverse damped"),
    ("run", "ellipse --force --inverse limited", "--force means nothing with --inverse limited"),
    *(("compare", words, said) for words, said in OF_RUNS_MEANINGLESS),
    ("compare", "leg-b --accuracy 1e-6", "has no effect on compare"),
    ("compare", "leg-b --max-step 0.01", "has no effect on compare"),
    ("compare", "leg-b --force", "has no effect on compare"),
    ("compare", "leg-b --stiffness 9", "has no effect on compare"),
    ("sweep", "leg-b --seed 3 --vary l1=0.04:0.06:2 --out s", "nothing is sampled"),
    ("view", "leg-b --host localhost --still leg.png", "means nothing with --still"),
    ("view", "leg-b --port 7000 --still leg.png", "means nothing with --still"),
    ("view", "leg-b --no-browser --still leg.png", "means nothing with --still"),
    ("view", "leg-b --once --still leg.png", "means nothing with --still"),
    ("view", "leg-b --overwrite --once", "means nothing without --still: leave"),
    ("doctor", "leg-b --gait wave --q 90,-50,-90", "means nothing for leg_b, which does not walk"),
    ("doctor", "hexabot --speed 0.1 --tip left_front_foot", "means nothing with --tip"),
    ("doctor", "leg-b --servo xl430 --q 90,-50,-90", "means nothing for leg_b, which does not"),
    ("doctor", "leg-b --overwrite --q 90,-50,-90", "goes with --out"),
    ("doctor", "leg-b --yaw 3 --foot 0.1,0,0", "a yaw is for a SCARA's tool"),
    ("doctor", "scara --yaw 3 --q 30,90,-120", "goes with --foot"),
    ("doctor", "leg-b --rpy 0,0,0 --foot 0.1,0,0", "cannot choose its orientation"),
    ("doctor", "scara --rpy 0,0,0 --foot 0.1,0,0", "only yaws"),
    ("doctor", "leg-b --foot 0.1,0,0 --direction 1,0,0", "needs a posture"),
    ("inverse", "leg-b --rpy 0,0,0 --q 90,-50,-90", "--rpy goes with --foot: leave it out"),
    ("derive", "leg-b --frame 2", "means nothing without --model"),
    ("derive", "leg-b --in 2", "means nothing without --model"),
    ("derive", "leg-b --grouped", "means nothing without --model"),
    ("derive", "leg-b --all-parameters", "means nothing without --model"),
    ("derive", "leg-b --code c", "means nothing without --model"),
    ("derive", "leg-b --model gravity --frame 2", "means nothing to the model gravity"),
    ("derive", "leg-b --model gravity --in 2", "means nothing to the model gravity"),
    ("derive", "leg-b --model jacobian --grouped", "means nothing to the model jacobian"),
    ("derive", "leg-b --model velocity --all-parameters", "means nothing to the model velocity"),
    ("derive", "leg-b --model base-parameters --code c", "nothing to the model base-parameters"),
    ("derive", "leg-b --model gravity --code c --latex", "means nothing with --code"),
    ("sdf", "leg-b --overwrite", "means nothing without --out: leave"),
    ("check", f"leg-b --samples 32 --printed {PRINTED}/report_b_leg.toml", "with --printed"),
    ("check", f"leg-b --budget 9 --printed {PRINTED}/report_b_leg.toml", "with --printed"),
    ("check", f"{PRINTED}/report_b_leg_table.txt --budget 9", "only read for slips"),
    ("check", f"{PRINTED}/report_b_leg_table.txt --samples 32", "only read for slips"),
    ("check", f"{PRINTED}/report_b_leg_table.txt --seed 0", "only read for slips"),
    ("diagram", "leg-b --without-scopes --part mechanism --out a.svg", "means nothing to mech"),
    ("diagram", "leg-b --without-accelerations --part frames --out a.svg", "nothing to frames"),
    ("diagram", "pendulum --without-accelerations --out a.svg", "whose joint no motion drives"),
    ("diagram", f"{MODEL} --without-scopes --out a.svg", "means nothing to a Simulink model"),
]  # fmt: skip


def options_of_commands():
    """All options of all commands."""
    (commands,) = (a for a in _build_parser()._actions if isinstance(a.choices, dict))
    return {
        name: {
            option
            for action in command._actions
            for option in action.option_strings
            if option.startswith("--") and option != "--help"
        }
        for name, command in commands.choices.items()
    }


def first_option(words):
    return next(word for word in words.split() if word.startswith("--"))


def named_options(command):
    """The options that a case of the table shows to be refused."""
    return {first_option(words) for name, words, _ in MEANINGLESS if name == command}


# A run that is refused is a row of its sweep.
OF_MODELS = {
    "--path",
    "--init",
    "--variant",
    "--parameter",
    "--feature",
    "--contact",
    "--solve-loops",
    "--leave-out",
    "--replace",
    "--page",
}
ALWAYS["sweep"] = named_options("run") - OF_MODELS | ALWAYS["run"] - {
    "--figures", "--replay", "--stills", "--video",
} | {
    "--fields", "--over", "--pareto", "--plot", "--sample", "--sampler", "--scheduler",
    "--simulated", "--vary", "--workers",
}  # fmt: skip


@pytest.mark.parametrize("command", ALWAYS)
def test_every_option_is_in_one_of_the_two_tables(command):
    sometimes = named_options(command) - ALWAYS[command]
    assert options_of_commands()[command] == ALWAYS[command] | sometimes


def test_no_command_is_missing():
    assert options_of_commands().keys() == ALWAYS.keys()


@pytest.mark.parametrize(
    ("command", "words", "said"), MEANINGLESS, ids=[f"{c} {w}"[:70] for c, w, _ in MEANINGLESS]
)
def test_an_option_that_means_nothing_is_refused(
    command, words, said, tmp_path, monkeypatch, capsys
):
    monkeypatch.chdir(tmp_path)
    before = [MODEL] if command == "compare" else []
    after = ["--out", "out"] if command == "run" else []
    assert main([command, *before, *words.split(), *after]) == 2
    out, err = capsys.readouterr()
    assert (out, err.count("\n")) == ("", 1)
    assert said in err
    assert list(tmp_path.iterdir()) == []


def test_a_file_of_a_runs_options_may_be_compared_but_what_means_nothing_is_said(tmp_path, capsys):
    file = tmp_path / "run.yaml"
    file.write_text("max_step: 0.01\n")
    assert main(["compare", MODEL, "leg-b", "--config", str(file)]) == 0
    assert "max_step of" in capsys.readouterr().err


# --- neutral values: obeyed, and never taken for "not given" ---------------------------------

TARGETS = (40.0, -20.0, 10.0)  # [deg], of low priority


def with_targets():
    segments, targets = [], iter(TARGETS)
    for segment in LEG_B.segments:
        mechanics = segment.mechanics
        if segment.row.joint != "fixed":
            target = StateTarget(value=next(targets) * 3.141592653589793 / 180, priority="low")
            mechanics = dataclasses.replace(mechanics, position_target=target)
        segments.append(dataclasses.replace(segment, mechanics=mechanics))
    return dataclasses.replace(LEG_B, segments=tuple(segments))


KINDS = {name: kind.options for name, kind in RUNS.items() if name != "hexapod"}
KINDS |= {"robot.toml": StraightOptions}

# What must be given beside an option for it to mean something.
BESIDE = {
    "damping_unit": {"damping": 0.02},
    "damped_below": {"inverse": "damped"},
    "rate_limit": {"inverse": "limited"},
    "correction": {"inverse": "damped"},
    "push_at": {"push": [0.0, 0.0, 0.1]},
    "push_for": {"push": [0.0, 0.0, 0.1]},
    "limit_stiffness": {"lower_limit": -30.0},
    "limit_damping": {"upper_limit": 170.0},
    "limit_width": {"upper_limit": 170.0},
}

# The default said aloud, where None stands for it; some defaults have no value of their own.
SAID = {
    "damping": 0.0, "damping_unit": "N*m*s/rad", "push_at": 2.0, "push_for": 0.1,
    "limit_stiffness": 1e4, "limit_damping": 10.0, "limit_width": 0.1, "spring_unit": "N*m/rad",
    "target": 30.0, "correction": 5.0, "q0_error": [0.0, 0.0, 0.0], "dynamics": "inverse",
}  # fmt: skip
SAID_OF = {
    ("pendulum", "q0"): [0.0], ("pendulum-spring", "q0"): [0.0], ("pendulum-damped", "q0"): [30.0],
    ("robot.toml", "q0"): list(TARGETS), ("robot.toml", "direction"): [1.0, 0.0, 0.0],
}  # fmt: skip
NEVER_SAID = {  # without them something is absent, or follows from the robot
    "accuracy", "max_step", "damped_below", "rate_limit", "push", "torque_limit", "stiffness",
    "filter_time_constant", "lower_limit", "upper_limit", "task",
}  # fmt: skip

CASES = [(name, f.name) for name, kind in KINDS.items() for f in dataclasses.fields(kind)]


def effect(name, **given):
    """What a run does by its options."""
    options = KINDS[name](**given)
    robot = with_targets() if name == "robot.toml" else options.robot()
    config = (pendulum if name.startswith("pendulum") else step).config_of(robot, options)
    steps = options.integrator_settings(0.001)
    dynamics = None if name.startswith("pendulum") else options.chosen_dynamics()
    return config, steps, options.duration, getattr(options, "force", None), dynamics


def default_of(name, option):
    default = getattr(KINDS[name](), option)
    if default is not None:
        return default
    return SAID_OF.get((name, option), SAID.get(option))


def zeros_of(name, option):
    """Neutral values of an option's type: what a careless test takes for nothing."""
    (field,) = (f for f in dataclasses.fields(KINDS[name]) if f.name == option)
    kind = str(field.type)
    if "list" in kind:
        count = 1 if name.startswith("pendulum") and option == "q0" else 3
        return [[], [0.0] * count]
    return [False] if "bool" in kind else [""] if "str" in kind else [0.0]


@pytest.mark.parametrize(("name", "option"), CASES, ids=[" ".join(case) for case in CASES])
def test_a_default_said_aloud_changes_nothing(name, option):
    beside = BESIDE.get(option, {})
    said = default_of(name, option)
    assert (said is None) == (option in NEVER_SAID)
    if said is not None:
        assert effect(name, **beside, **{option: said}) == effect(name, **beside)


@pytest.mark.parametrize(("name", "option"), CASES, ids=[" ".join(case) for case in CASES])
def test_zero_is_obeyed_or_refused_and_never_taken_for_nothing(name, option):
    beside = BESIDE.get(option, {})
    for zero in zeros_of(name, option):
        try:
            same = effect(name, **beside, **{option: zero}) == effect(name, **beside)
        except InvalidValueError:
            continue
        assert same == (zero == default_of(name, option))
        assert zero not in ([], "")


def test_a_robot_starts_at_its_targets_only_where_no_posture_is_given():
    assert effect("robot.toml")[0].q0 == pytest.approx([t * 0.017453292519943295 for t in TARGETS])
    assert effect("robot.toml", q0=[0.0, 0.0, 0.0])[0].q0 == (0.0, 0.0, 0.0)
