"""What README and the pages of docs/ show works as it stands."""

import inspect
import re
import shlex
import sys
from itertools import pairwise
from pathlib import Path
from types import SimpleNamespace

import pytest

import drake_leg
from drake_leg.cli import main
from drake_leg.lab.errata.catalogue import texts_by_number
from drake_leg.runs.options import LegBOptions
from drake_leg.studies.sweep import sweep
from drake_leg.studies.variation import variations

ROOT = Path(__file__).resolve().parents[1]
README = ROOT / "README.md"
PAGES = {path.stem: path.read_text(encoding="utf-8") for path in (README, *ROOT.glob("docs/*.md"))}
TEXT = "\n".join(PAGES.values())
LONG = 1400  # words


@pytest.fixture
def unsaved(monkeypatch):
    """Leave out the pictures of runs."""
    monkeypatch.setattr("drake_leg.runs.figures.figures_of_run", lambda *arguments: ())


def blocks(language, text=TEXT):
    return re.findall(rf"```{language}\n(.*?)```", text, flags=re.DOTALL)


def commands(text):
    """What a page says to type, in its order: blocks for the shell, and lines in sentences."""
    found = []
    pieces = re.findall(r"```(\w*)\n(.*?)```|`(drake-leg\s[^`]*)`", text, flags=re.DOTALL)
    for language, block, inline in pieces:
        lines = block.splitlines() if language == "sh" else [" ".join(inline.split())]
        found += [line.partition("  #")[0].strip() for line in lines]
    options_are_placeholders = re.compile(r"\b(NAME|DIR|FILE)\b")
    return [line for line in found if line and not options_are_placeholders.search(line)]


def program(text):
    """Only complete calls of the program; `drake-leg run` in a table is a name."""
    lines = [line for line in commands(text) if line.startswith("drake-leg ")]
    alone = {"list", "errata"}
    return [line for line in lines if len(words_of(line)) > 1 or words_of(line)[0] in alone]


def words_of(command):
    return shlex.split(command)[1:]


def after(words, *options):
    return [word for option, word in pairwise(words) if option in options]


def test_readme_fits_one_sitting_and_links_every_page():
    text = PAGES["README"]
    assert len(text.splitlines()) <= 150
    linked = set(re.findall(r"\]\(docs/([\w-]+)\.md\)", text))
    assert linked == set(PAGES) - {"README"}


@pytest.mark.parametrize("page", PAGES)
def test_links_lead_somewhere(page):
    folder = ROOT if page == "README" else ROOT / "docs"
    for link in re.findall(r"\]\((?!https?:)([^)#]+)\)", PAGES[page]):
        assert (folder / link).exists(), link


def anchors(page):
    """Where links into a page may lead: its headings, as GitHub writes them."""
    outside = re.sub(r"```.*?```", "", PAGES[page], flags=re.DOTALL)
    headings = re.findall(r"^#+ (.*)$", outside, flags=re.MULTILINE)
    return [re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings]


@pytest.mark.parametrize("page", PAGES)
def test_links_into_pages_lead_to_headings(page):
    for other, anchor in re.findall(
        r"\]\((?!https?:)(?:[^)#]*?(\w[\w-]*)\.md)?#([^)]+)\)", PAGES[page]
    ):
        assert anchor in anchors(other or page), (other, anchor)


@pytest.mark.parametrize(
    "page", [page for page in PAGES if len(PAGES[page].split()) > LONG and page != "blocks"]
)
def test_a_long_page_lists_its_sections(page):
    text = PAGES[page]
    contents = text[text.index("On this page") :].partition("\n\n")[0]
    sections = re.findall(
        r"^## (.*)$", re.sub(r"```.*?```", "", text, flags=re.DOTALL), re.MULTILINE
    )
    assert re.findall(r"\[([^]]+)\]\(#", contents) == sections


@pytest.mark.parametrize(
    "name", ["leg-b", "ellipse", pytest.param("scara", marks=pytest.mark.slow)]
)
def test_the_errors_of_runs_are_those_that_are_printed(name, unsaved):
    row = re.search(rf"^\| .*`{name}`.*\| (.*)·10⁻(.*) m \|$", PAGES["correctness"], re.MULTILINE)
    exponent = int(row[2].translate(str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹", "0123456789")))
    printed = float(row[1]) * 10.0**-exponent
    assert drake_leg.run(name).summary["max_position_error_m"] == pytest.approx(printed, rel=0.7)


def test_ci_calls_the_readmes_test_command():
    (command,) = (
        block.strip() for block in blocks("sh", PAGES["README"]) if block.strip().endswith("pytest")
    )
    assert command in (ROOT / ".ci" / "run").read_text(encoding="utf-8").splitlines()


def test_every_fence_is_closed_and_no_heading_stands_in_two_pages():
    headings = []
    for text in PAGES.values():
        outside = re.sub(r"```.*?```", "", text, flags=re.DOTALL)
        assert "```" not in outside
        headings += re.findall(r"^#+ (.*)$", outside, flags=re.MULTILINE)
    assert len(headings) == len(set(headings))


SNIPPETS = [(page, snippet) for page, text in PAGES.items() for snippet in blocks("python", text)]


@pytest.mark.parametrize(("page", "snippet"), SNIPPETS, ids=[page for page, _ in SNIPPETS])
def test_a_snippet_runs(page, snippet, monkeypatch):
    monkeypatch.chdir(ROOT)
    exec(compile(snippet, page, "exec"), {"__name__": "__main__"})


class OfACluster:
    """Stands for a cluster, its client and the client's executor, none of which runs anything."""

    def __init__(self, *_given, **_options):
        pass

    def scale(self, jobs):
        assert jobs > 0

    def get_executor(self, pure):
        assert not pure
        return self

    def __enter__(self):
        return self

    def __exit__(self, *_error):
        pass


SNIPPETS_ON_A_CLUSTER = [(page, text) for page in PAGES for text in blocks("py", PAGES[page])]


@pytest.mark.parametrize(
    ("page", "snippet"), SNIPPETS_ON_A_CLUSTER, ids=[page for page, _ in SNIPPETS_ON_A_CLUSTER]
)
def test_a_snippet_for_a_cluster_runs(page, snippet, monkeypatch):
    calls = []

    def bound(*arguments, **options):
        calls.append(inspect.signature(sweep).bind(*arguments, **options).arguments)

    cluster = SimpleNamespace(SLURMCluster=OfACluster)
    monkeypatch.setitem(sys.modules, "dask_jobqueue", cluster)
    monkeypatch.setitem(sys.modules, "distributed", SimpleNamespace(Client=OfACluster))
    monkeypatch.setitem(vars(drake_leg), "sweep", bound)
    exec(compile(snippet, page, "exec"), {"__name__": "__main__"})
    (call,) = calls
    assert "options" not in call
    assert variations(LegBOptions, call["what"], call["vary"], {})
    assert isinstance(call["executor"], OfACluster)


def test_the_robot_of_ones_own_is_proved(unsaved, tmp_path, monkeypatch, capsys):
    (robot,) = blocks("toml")
    monkeypatch.chdir(tmp_path)
    Path("arm.toml").write_text(robot, encoding="utf-8")
    assert main(["check", "arm.toml"]) == 0
    assert "proved" in capsys.readouterr().out
    assert main(["sdf", "arm.toml", "--out", "arm.sdf"]) == 0
    assert main(["doctor", "arm.toml", "--q", "0,80,-90"]) == 0
    run = "run arm.toml --out arm --q0 0,80,-90 --amplitude 0.05 --duration 0.2"
    assert main(run.split()) == 0


@pytest.mark.parametrize("text", blocks("yaml"))
def test_the_config_is_taken(unsaved, tmp_path, text):
    config = tmp_path / "step.yaml"
    config.write_text(text, encoding="utf-8")
    words = ["run", "leg-b", "--config", str(config), "--out", str(tmp_path / "step")]
    assert main([*words, "--duration", "0.2"]) == 0


def test_the_errata_are_counted():
    assert re.findall(r"(\d+) errata", TEXT) == [str(len(texts_by_number()))]


def test_every_command_is_taken():
    """Each is parsed as written, except those that only print something and exit."""
    from drake_leg.cli import entry

    found = [command for text in PAGES.values() for command in program(text)]
    assert len(found) > 40
    for command in found:
        words = words_of(command)
        if not {"--help", "--version"} & set(words):
            entry._build_parser().parse_args(entry._join_negative_values(words))


def test_the_bare_program_is_called_once_the_environment_is_activated():
    lines = [line for block in blocks("sh", PAGES["README"]) for line in block.splitlines()]
    bare = [index for index, line in enumerate(lines) if line.startswith("drake-leg ")]
    assert lines.index(". .venv/bin/activate") < bare[0]


TYPED = {"arm.toml", "step.yaml"}  # by the reader


@pytest.mark.parametrize("page", PAGES)
def test_no_name_is_written_twice_and_none_is_read_before_it_is_there(page):
    written = set()
    for command in program(PAGES[page]):
        words = words_of(command)
        read = after(words, "--config", "--printed")
        read += words[1:2] if words[0] == "replay" else []
        read += [word for word in words[1:2] if word.endswith((".toml", ".par", ".slx"))]
        for name in read:
            assert name in TYPED | written or (ROOT / name).exists(), command
        for name in after(words, "--out", "--still"):
            assert name not in written, f"{command}: {name} is there already"
            written.add(name)


STATUS = {
    "drake-leg run leg-b --out far --amplitude 0.1 --force": 3,
    "drake-leg check leg-b --printed tests/lab/grader/printed/report_b_leg.toml": 1,
}
SERVERS = ("view", "teleop")  # until they are interrupted, but not a view with --still
VIDEOS = (".gif", ".mp4")  # drawn picture by picture


def shorter(words):
    """Make a documented run take less time, and a sweep have fewer runs."""
    words = [re.sub(r"(?<=[\d.]:)\d+$", "3", word) for word in words]
    if words[0] == "sweep" and "--sample" in words:
        words[words.index("--sample") + 1] = "4"
    if words[:2] == ["sweep", "hexapod"]:
        return [*words, "--duration", "0.6"]
    if words[0] == "run" and "--out" in words and "--then" not in words:
        return [*words, "--duration", "1.5" if words[1] == "hexapod" else "3"]
    return words


@pytest.mark.slow
@pytest.mark.parametrize("page", [page for page in PAGES if program(PAGES[page])])
def test_a_pages_commands_work_one_after_the_other(page, tmp_path, monkeypatch, capsys):
    """As a reader types them, in one folder, but shorter; pictures of runs are other tests'."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("drake_leg.runs.figures.figures_of_run", lambda *arguments: ())
    for folder in ("examples", "notebooks", "tests"):
        Path(folder).symlink_to(ROOT / folder)
    Path("arm.toml").write_text(*blocks("toml"), encoding="utf-8")
    Path("step.yaml").write_text(*blocks("yaml"), encoding="utf-8")
    for command in program(PAGES[page]):
        words = words_of(command)
        serves = words[0] in SERVERS and "--still" not in words
        if serves or command.endswith(VIDEOS) or "--scheduler" in words:
            continue
        words = shorter(words)
        try:
            status = main(words)
        except SystemExit as stop:
            status = stop.code
        assert (status or 0) == STATUS.get(command, 0), f"{command}: {capsys.readouterr().err}"
