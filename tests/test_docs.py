"""README and docs/: every command runs, every link leads somewhere, every key and every reason is told.

Commands stand in ```sh blocks. Those of one page run in their order in one folder that holds what they name.
"""

import ast
import os
import re
import runpy
import shlex
import shutil
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import cv2
import pytest

from ashe_live import cli
from ashe_live.commands.flags.options import parsed
from ashe_live.commands.flags.settings_file import read_settings
from ashe_live.commands.viewing import setup
from ashe_live.errors import ExitStatus
from ashe_live.files.resources import resource
from ashe_live.viewer.hands.controls import BINDINGS
from tests.checkout import CHECKOUT
from tests.commands.conftest import InstantWorker

PAGES = [CHECKOUT / "README.md", *sorted((CHECKOUT / "docs").rglob("*.md"))]
FENCED = re.compile(r"^```(\w+)\n(.*?)^```", re.MULTILINE | re.DOTALL)
LINK = re.compile(r"\]\(([^)\s]+)\)")
# What cannot be run by a test; the command line must take it all the same.
ONLY_PARSED = {
    "webcam": "needs a camera",
    "calibrate": "needs a camera",
    "cameras": "needs a camera",
    "marker --show": "needs a window",
    "bench": "takes minutes",
}
# A window is replaced by a few frames without one.
WITHOUT_WINDOW = {"demo": ["--headless", "--frames", "2"], "play": ["--headless"]}
WRITES = ("--out", "--sheet", "--debug", "--report")
# Running text names commands without what they cannot do without.
NAMED = {
    "estimate": ["FILE"],
    "play": ["FILE"],
    "bench light": ["--scenes", "DIR"],
    "board": ["--out", "FILE.pdf"],
    "calibrate": ["--out", "FILE.json"],
    "marker": ["--out", "FILE.pdf", "--show"],
}
OF_EQUATIONS = [CHECKOUT / "docs" / "maths.md", *sorted((CHECKOUT / "docs" / "maths").glob("*.md"))]
GUIDE = CHECKOUT / "docs" / "guide.md"


def commands_of(page: Path) -> list[list[str]]:
    blocks = [body for language, body in FENCED.findall(page.read_text(encoding="utf-8")) if language == "sh"]
    lines = [shlex.split(line, comments=True) for body in blocks for line in body.splitlines()]
    return [words for words in lines if words]


def inline_commands() -> Iterator[tuple[str, str]]:
    """Page and command of every `ashe-live ...` in running text, placeholders and all."""
    for page in PAGES:
        text = FENCED.sub("", page.read_text(encoding="utf-8"))
        for command in re.findall(r"`(ashe-live [^`]+)`", text):
            yield page.name, " ".join(command.split())


def why_not_run(words: list[str]) -> str | None:
    said = " ".join(words)
    return next((why for beginning, why in ONLY_PARSED.items() if said.startswith(beginning)), None)


@pytest.fixture(scope="module")
def inputs(shoot_film, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with every file that the pages' commands read."""
    folder = tmp_path_factory.mktemp("inputs")
    film = shoot_film(folder, (320, 240), 8)
    film.path.rename(folder / "clip.mp4")
    capture = cv2.VideoCapture(str(folder / "clip.mp4"))
    _, frame = capture.read()
    capture.release()
    for name in ("photo.jpg", "empty.jpg", "photos/one.jpg", "more/two.jpg", "front.jpg", "left.jpg", "right.jpg"):
        (folder / name).parent.mkdir(exist_ok=True)
        assert cv2.imwrite(str(folder / name), frame)
    shutil.copy(resource("assets", "models", "mug.glb"), folder / "mug.glb")
    return folder


@pytest.mark.parametrize("page", [page for page in PAGES if commands_of(page)], ids=lambda page: page.name)
def test_commands_do_what_the_page_says(page: Path, inputs: Path, tmp_path: Path, monkeypatch) -> None:
    folder = tmp_path / "here"
    shutil.copytree(inputs, folder)
    monkeypatch.chdir(folder)
    # The light's own process waits for every other on a busy machine; `estimate` estimates here.
    monkeypatch.setattr(setup, "LightWorker", InstantWorker)
    for words in commands_of(page):
        match words:
            case ["ashe-live", *arguments] if why_not_run(arguments) is None:
                assert_runs(arguments)
            case ["ashe-live", *arguments]:
                parsed(arguments)
            case ["make", target]:
                assert re.search(rf"^{target}:", (CHECKOUT / "Makefile").read_text(), re.MULTILINE)
            case [".venv/bin/pytest", *arguments] | ["FUZZ_FILES=25000", ".venv/bin/pytest", *arguments]:
                options = (CHECKOUT / "tests" / "fuzz" / "conftest.py").read_text(encoding="utf-8")
                assert all((CHECKOUT / part).exists() for part in arguments if part.startswith("tests"))
                assert all(f'"{part}"' in options for part in arguments if part.startswith("--"))
            case ["python", script]:  # each draws for minutes: it is loaded, and that it has a main is looked at
                assert callable(runpy.run_path(str(CHECKOUT / script))["main"])
            case _:
                pytest.fail(f"{page.name}: nobody knows how to test {shlex.join(words)}")


def assert_runs(arguments: list[str]) -> None:
    without_window = WITHOUT_WINDOW.get(arguments[0], []) * ("--headless" not in arguments)
    # That it runs is asked, not what it answers or how ground over the marker looks.
    fast = ["--quality", "fast"] * (arguments[0] in ("demo", "estimate", "play") and "--quality" not in arguments)
    bare = ["--no-hide-marker"] * (arguments[0] in ("demo", "play") and "--hide-marker" not in arguments)
    status = cli.run(arguments + without_window + fast + bare)
    # The pictures here are small: an estimate may find no light in them, which is an answer.
    assert status in (ExitStatus.ANSWERED, ExitStatus.NO_DIRECTIONAL_LIGHT), shlex.join(arguments)
    for flag in WRITES:
        if flag in arguments:
            written = Path(arguments[arguments.index(flag) + 1])
            assert written.is_dir() or written.stat().st_size > 0


@pytest.mark.parametrize("command", [pytest.param(text, id=f"{page}: {text}") for page, text in inline_commands()])
def test_commands_in_running_text_are_taken(command: str) -> None:
    """FILE and the like stand for themselves; brackets mean that something may be left out."""
    filled = re.sub(r"[\[\]]", "", re.sub(r" (\.\.\.|…)", " FILE", command)).replace("...", "")
    arguments = shlex.split(filled)[1:]
    for beginning, asked_for in NAMED.items():
        if " ".join(arguments).startswith(beginning) and not set(asked_for) & set(arguments):
            arguments += asked_for[:2]
    if {"-h", "--help", "--version"} & set(arguments):
        return
    parsed(arguments)


def test_what_is_only_parsed_is_still_there() -> None:
    """Else a reason for not running outlives its command."""
    fenced = [" ".join(words[1:]) for page in PAGES for words in commands_of(page) if words[0] == "ashe-live"]
    said = [*fenced, *(command.removeprefix("ashe-live ") for _, command in inline_commands())]
    assert all(any(command.startswith(beginning) for command in said) for beginning in ONLY_PARSED)


def anchors_of(page: Path) -> set[str]:
    """As GitHub makes them from headings."""
    headings = re.findall(r"^#+ (.*)$", page.read_text(encoding="utf-8"), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_lead_somewhere(page: Path) -> None:
    for link in LINK.findall(page.read_text(encoding="utf-8")):
        if re.match(r"[a-z]+://", link):
            continue
        path, _, anchor = link.partition("#")
        target = Path(os.path.normpath(page.parent / path)) if path else page
        assert target.exists(), f"{page.name}: {link}"
        assert not anchor or anchor in anchors_of(target), f"{page.name}: {link}"


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_tables_are_whole(page: Path) -> None:
    """A row whose header an empty line cuts off is shown as text."""
    text = FENCED.sub("", page.read_text(encoding="utf-8"))
    for table in re.findall(r"(?:^ {0,3}\|.*\n)+", text, re.MULTILINE):
        rows = [re.sub(r"`[^`]*`|\\\|", "", row).count("|") for row in table.splitlines()]
        assert re.match(r".*\n *\|(:?-+:?\|)+\n", table), f"{page.name}: {table}"
        assert len(set(rows)) == 1, f"{page.name}: {table}"


def test_every_page_is_reached_from_the_readme() -> None:
    reached, ahead = set(), [PAGES[0]]
    while ahead:
        page = ahead.pop()
        reached.add(page)
        links = (link.partition("#")[0] for link in LINK.findall(page.read_text(encoding="utf-8")) if "://" not in link)
        targets = (Path(os.path.normpath(page.parent / link)) for link in links if link.endswith(".md"))
        ahead += [target for target in targets if target not in reached]
    assert set(PAGES) <= reached


def test_the_readmes_keys_are_those_that_the_window_obeys() -> None:
    """In the order of the help and as the help writes them, several in a row parted by semicolons."""
    table = PAGES[0].read_text(encoding="utf-8").partition("| key | does |\n|---|---|\n")[2].partition("\n\n")[0]
    cells = [row.split("|")[1] for row in table.splitlines()]
    assert [key.strip() for cell in cells for key in cell.split(";")] == [binding.shown for binding in BINDINGS]


def test_every_command_has_a_key() -> None:
    """But for files that are dropped on the window: the command line names those."""
    assert all(binding.keys for binding in BINDINGS if not binding.shown.startswith("drop"))


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_settings_are_taken(page: Path, tmp_path: Path) -> None:
    for language, body in FENCED.findall(page.read_text(encoding="utf-8")):
        if language == "toml":
            (tmp_path / "settings.toml").write_text(body, encoding="utf-8")
            assert read_settings(tmp_path / "settings.toml")


@cache
def names_in(path: Path) -> set[str]:
    """Of all that a module defines, its classes' members among it."""
    nodes = list(ast.walk(ast.parse(path.read_text(encoding="utf-8"))))
    defined = {node.name for node in nodes if isinstance(node, ast.FunctionDef | ast.ClassDef)}
    return defined | {node.id for node in nodes if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)}


def test_code_that_the_pages_name_is_there() -> None:
    """`folder/module.py` on any page and `module.name` on that of the equations, which outlive what they name."""
    modules = sorted(path for top in ("ashe_live", "tests", "assets") for path in (CHECKOUT / top).rglob("*.py"))
    paths = [f"/{path.relative_to(CHECKOUT).as_posix()}" for path in modules]
    for page in PAGES:
        text = page.read_text(encoding="utf-8")
        for named in re.findall(r"`([\w/]+\.py)`", text):
            assert any(path.endswith(f"/{named}") for path in paths), f"{page.name}: {named}"
    of_equations = "".join(page.read_text(encoding="utf-8") for page in OF_EQUATIONS)
    for stem, name in re.findall(r"`(?:\w+/)*([a-z_]+)\.(?!(?:py|json|frag|vert|glsl)`)(\w+)[`.]", of_equations):
        homes = [path for path in modules if path.stem == stem]
        assert any(name in names_in(path) for path in homes), f"{stem}.{name}"


def test_constants_and_quantities_that_the_pages_name_are_there() -> None:
    """`CONSTANTS`, and names that end in a unit or a frame, which outlive what they name as well."""
    sources = [path for top in ("ashe_live", "assets", "shaders") for path in (CHECKOUT / top).rglob("*")]
    of_code = {path for path in sources if path.suffix in (".py", ".frag", ".vert", ".glsl")}
    words = {word for path in of_code for word in re.findall(r"\w+", path.read_text(encoding="utf-8"))}
    ends = "_(?:px|m|rad|rad2|deg|ms|rgb|bgr|ratio|marker)"
    count = 0
    for page in PAGES:
        named = re.findall(rf"`([A-Z]+_[A-Z_]+|[A-Za-z]\w*{ends})`", page.read_text(encoding="utf-8"))
        assert set(named) <= words, f"{page.name}: {set(named) - words}"
        count += len(named)
    assert count > 50


def test_sections_and_equations_that_the_code_names_are_there() -> None:
    """`docs/maths, "A section"`, wherever a comment's line ends, and `(10) of docs/maths`."""
    text = "".join(page.read_text(encoding="utf-8") for page in OF_EQUATIONS)
    sections = set(re.findall(r"^#+ (.*)$", text, re.MULTILINE))
    equations = set(re.findall(r"^ {4}.*\((\d+[a-z]*)\)$", text, re.MULTILINE))
    count = 0
    for module in (CHECKOUT / "ashe_live").rglob("*.py"):
        flowing = re.sub(r"\s+(# )?", " ", module.read_text(encoding="utf-8"))
        named = re.findall(r'docs/maths, "([^"]+)"', flowing)
        numbers = re.findall(r"\((\w+)\) of docs/maths", flowing) + re.findall(r"docs/maths, \((\w+)\)", flowing)
        assert set(named) <= sections, module.name
        assert set(numbers) <= equations, module.name
        count += len(named) + len(numbers)
    assert count > 30


def reasons() -> Iterator[tuple[str, str]]:
    """Module and words of every reason that an estimator gives for no answer."""
    for module in sorted((CHECKOUT / "ashe_live" / "light").rglob("*.py")):
        for node in ast.walk(ast.parse(module.read_text(encoding="utf-8"))):
            given: list[ast.expr] = []
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "_Found":
                given = node.args
            elif isinstance(node, ast.Assign):
                is_one = module.name == "no_answer.py" or any(
                    getattr(to, "id", None) == "reason" for to in node.targets
                )
                given = [node.value] if is_one else []
            for value in given:
                if isinstance(value, ast.Constant) and isinstance(value.value, str):
                    yield f"{module.parent.name}/{module.name}", value.value


def test_the_guide_says_what_every_reason_means() -> None:
    guide, given = " ".join(GUIDE.read_text(encoding="utf-8").split()), list(reasons())
    assert {module for module, _ in given} >= {"explanation/no_answer.py", "paper/estimator.py"}
    for module, reason in given:
        assert reason in guide, f"{module}: {reason}"


def test_the_guide_quotes_what_the_window_says() -> None:
    """Numbers stand for others."""
    table = GUIDE.read_text(encoding="utf-8").partition("| line | what to do |\n|---|---|\n")[2].partition("\n\n")[0]
    quoted = [line for row in table.splitlines() for line in re.findall(r'"([^"]+)"', row.split("|")[1])]
    writers = ("viewer/status.py", "drawing/light_text.py")
    said = "".join((CHECKOUT / "ashe_live" / name).read_text(encoding="utf-8") for name in writers)
    assert len(quoted) > 5
    for line in quoted:
        assert all(part in said for part in re.split(r"\d+", line)), line
