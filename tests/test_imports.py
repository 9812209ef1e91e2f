"""Which room may import which, what each may load, and how large it may grow: a new import or folder is a decision."""

import ast
import json
import re
import subprocess
import sys
from collections import Counter
from functools import cache
from itertools import chain, pairwise
from pathlib import Path

import pytest

from tests.checkout import CHECKOUT

PACKAGE = CHECKOUT / "ashe_live"

# A room is a package, or a package within `light` or `bench`. It may import the rooms named here and itself; every one
# of those stands further up, so that imports have one direction.
ROOMS: dict[str, set[str]] = {
    "errors": set(),
    "files": {"errors"},
    "process": {"errors"},
    "core": {"errors", "files"},
    "models": {"core", "errors", "files", "process"},
    "capture": {"core", "errors", "files", "process"},
    "tracking": {"core", "errors", "files", "process"},
    "light": set(),
    "light.pixels": {"core"},
    "light.ground": {"core", "light.pixels"},
    "light.shape": {"core", "light.pixels"},
    "light.outline_fit": {"core", "light.shape"},
    "light.edges": {"core", "light.pixels", "light.shape", "light.outline_fit"},
    "light.labels": {"core", "light.pixels", "light.ground", "light.shape"},
    "light.explanation": {
        "core", "light.pixels", "light.ground", "light.shape", "light.outline_fit", "light.edges", "light.labels",
    },
    "light.views": {
        "core", "light.pixels", "light.ground", "light.shape", "light.outline_fit", "light.labels",
        "light.explanation",
    },
    "light.hull": {
        "core", "light.pixels", "light.shape", "light.edges", "light.labels", "light.explanation", "light.views",
    },
    "light.lamps": {
        "core", "light.pixels", "light.ground", "light.shape", "light.explanation", "light.views",
    },
    "light.paper": {"core"},
    "light.known_body": {"core", "light.pixels", "light.shape"},
    "light.estimators": {
        "core", "errors", "light.pixels", "light.ground", "light.outline_fit", "light.labels", "light.explanation",
        "light.views", "light.hull", "light.lamps", "light.known_body", "light.paper",
    },
    "light.live": {"core", "errors", "light.pixels", "light.estimators", "light.views", "process"},
    "drawing": {"core", "files", "light.pixels", "light.ground", "light.shape", "light.estimators"},
    "render": {"core", "errors", "files", "models", "process"},
    "quality": {"core", "tracking", "light.estimators", "render"},
    "viewer": {
        "quality", "core", "errors", "files", "models", "capture", "tracking", "light.estimators",
        "light.live", "drawing", "process", "render",
    },
    "api": {"quality", "core", "models", "capture", "tracking", "light.estimators", "light.live"},
    "renderer": {"quality", "core", "errors", "files", "models", "process", "render"},
    "": {"core", "errors", "models", "capture", "render", "api", "renderer"},  # `import ashe_live` itself
    "bench": {"core", "errors", "files", "capture", "tracking", "render", "viewer", "process"},
    "bench.light": {
        "quality", "core", "errors", "capture", "tracking", "light.estimators", "light.outline_fit", "bench",
    },
    "bench.judge": {
        "quality", "core", "errors", "files", "light.pixels", "light.ground", "light.shape", "light.estimators",
        "light.explanation", "bench", "bench.light",
    },
    "bench.lamps": {"core", "errors", "light.estimators", "light.ground", "light.lamps", "light.pixels", "bench"},
    "bench.second_lights": {"core", "errors", "light.estimators", "light.explanation", "bench"},
    "bench.track": {"quality", "core", "errors", "capture", "tracking", "process", "bench"},
    "bench.cube": {"quality", "core", "errors", "capture", "tracking", "light.estimators", "bench.track", "bench"},
    "bench.render": {
        "quality", "core", "errors", "files", "models", "capture", "tracking", "light.explanation", "render", "viewer",
        "bench",
    },
    "bench.viewer": {
        "quality", "core", "capture", "tracking", "light.estimators", "light.live", "render", "viewer", "bench",
    },
    "bench.soak": {
        "quality", "core", "models", "capture", "tracking", "light.estimators", "light.live", "render", "viewer",
        "bench",
    },
    "commands": {
        "quality", "core", "errors", "files", "models", "capture", "tracking", "light.pixels", "light.estimators",
        "light.live", "drawing", "render", "viewer", "bench", "bench.light", "bench.judge", "bench.track",
        "bench.render", "bench.viewer", "bench.soak", "bench.cube", "bench.lamps", "bench.second_lights", "process", "",
    },
    "cli": {"commands", "errors", "process"},
    "__main__": {"cli"},
}  # fmt: skip
MOST_ROOMS = 4  # of `light` that one of its modules imports from, beside its own
MOST_LINES = 250  # of a module
MOST_MODULES = 12  # of a folder, besides its __init__

# What a package loads beside Python and NumPy, itself or through what it imports.
HEAVY = {"cv2", "av", "PIL", "trimesh", "moderngl", "glfw", "rich", "pyrr", "platformdirs", "matplotlib"}
LOADS = {
    "core": {"pyrr"},
    "models": {"platformdirs", "PIL"},
    "capture": {"PIL", "cv2", "av"},
    "tracking": {"pyrr", "platformdirs", "PIL", "cv2"},
    "light": {"pyrr", "cv2"},
    "drawing": {"pyrr", "PIL", "cv2"},
    "render": {"pyrr", "PIL", "cv2", "moderngl"},
}

LOAD_EVERY_MODULE = """
import importlib, json, pkgutil, sys
package = importlib.import_module(sys.argv[1])
for module in pkgutil.walk_packages(package.__path__, package.__name__ + "."):
    importlib.import_module(module.name)
print(json.dumps(sorted(sys.modules)))
"""

LOAD_HELP = """
import json, sys
from ashe_live.cli import run
try:
    run(["--help"])
except SystemExit as end:
    assert end.code == 0
print(json.dumps(sorted(sys.modules)))
"""


def modules_after(code: str, *arguments: str) -> set[str]:
    done = subprocess.run(
        [sys.executable, "-c", code, *arguments], capture_output=True, text=True, check=True, cwd=CHECKOUT
    )
    return set(json.loads(done.stdout.splitlines()[-1]))


def room_of(module: list[str]) -> str:
    """The room of a module, or of a name in it, given by its parts without the package's name."""
    if module and module[0] in ("light", "bench") and (PACKAGE / "/".join(module[:2])).is_dir():
        return ".".join(module[:2])
    is_module = bool(module) and ((PACKAGE / module[0]).is_dir() or (PACKAGE / f"{module[0]}.py").exists())
    return module[0] if is_module else ""


@cache
def parsed(path: Path) -> tuple[list[list[str]], set[str]]:
    """The parts of every name that a file imports, also within functions and for the type checker alone.

    And every function that it calls, as written.
    """
    names: list[list[str]] = []
    called: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names += [name.name.split(".") for name in node.names]
        elif isinstance(node, ast.ImportFrom):
            names += [[*(node.module or "").split("."), name.name] for name in node.names]
        elif isinstance(node, ast.Call):
            called.add(ast.unparse(node.func))
    return names, called


def imported(path: Path) -> list[list[str]]:
    return parsed(path)[0]


def files_by_room() -> dict[str, list[Path]]:
    rooms: dict[str, list[Path]] = {}
    for path in sorted(PACKAGE.rglob("*.py")):
        module = [*path.relative_to(PACKAGE).with_suffix("").parts]
        rooms.setdefault(room_of([part for part in module if part != "__init__"]), []).append(path)
    return rooms


FILES = files_by_room()


def rooms_imported(path: Path) -> set[str]:
    return {room_of(parts[1:]) for parts in imported(path) if parts[0] == "ashe_live"}


def test_every_room_has_its_list_and_every_list_its_room() -> None:
    assert FILES.keys() == ROOMS.keys()


@pytest.mark.parametrize("room", ROOMS)
def test_a_room_imports_what_its_list_allows(room: str) -> None:
    for path in FILES[room]:
        assert rooms_imported(path) - {room} <= ROOMS[room], path


@pytest.mark.parametrize("room", ROOMS)
def test_a_list_allows_nothing_that_its_room_does_not_import(room: str) -> None:
    assert ROOMS[room] <= set().union(*(rooms_imported(path) for path in FILES[room]))


def test_imports_have_one_direction() -> None:
    above: set[str] = set()
    for room, allowed in ROOMS.items():
        assert allowed <= above, room
        above.add(room)


def test_no_module_of_light_knows_more_than_four_rooms_beside_its_own() -> None:
    for room in ROOMS:
        for path in FILES[room] if room.startswith("light.") else ():
            others = {other for other in rooms_imported(path) if other.startswith("light.")} - {room}
            assert len(others) <= MOST_ROOMS, path


def test_a_module_and_a_folder_are_read_at_one_sitting() -> None:
    modules = [path for path in PACKAGE.rglob("*.py") if path.name != "__init__.py"]
    assert [path for path in modules if len(path.read_text(encoding="utf-8").splitlines()) > MOST_LINES] == []
    by_folder = Counter(path.parent for path in modules)
    assert [folder for folder, count in by_folder.items() if count > MOST_MODULES] == []


@pytest.mark.parametrize("room", [room for room in ROOMS if room.startswith("light.")])
def test_a_rooms_own_words_say_what_it_may_import(room: str) -> None:
    words = ast.get_docstring(ast.parse((PACKAGE / room.replace(".", "/") / "__init__.py").read_text(encoding="utf-8")))
    said = set(re.findall(r"`(\w+)`", (words or "").split("May import")[1]))
    assert said == {name.removeprefix("light.") for name in ROOMS[room]}


def test_the_map_of_the_estimators_rooms_is_that_of_their_imports() -> None:
    """Arrows are imports, and where no arrow leads from a room to one that it imports, a way along several does."""
    text = (CHECKOUT / "docs" / "contributing.md").read_text(encoding="utf-8")
    chart = re.findall(r"flowchart TD\n(.*?)```", text.partition("## The estimator's rooms")[2], re.DOTALL)[0]
    arrows: dict[str, set[str]] = {}
    for line in re.sub(r'\["[^"]*"\]', "", chart).splitlines():
        for before, after in pairwise(line.split("-->")):
            arrows.setdefault(before.strip(), set()).update(map(str.strip, after.split("&")))
    allowed = {
        room.removeprefix("light."): {other.removeprefix("light.") for other in others if other.startswith("light.")}
        for room, others in ROOMS.items()
        if room.startswith("light.")
    }

    def reached(room: str) -> set[str]:
        return arrows.get(room, set()).union(*map(reached, arrows.get(room, ())))

    assert {*arrows, *chain(*arrows.values())} == allowed.keys()
    for room, others in allowed.items():
        assert arrows.get(room, set()) <= others <= reached(room), room


@pytest.mark.parametrize("package", LOADS)
def test_a_package_loads_what_its_list_says(package: str) -> None:
    loaded = modules_after(LOAD_EVERY_MODULE, f"ashe_live.{package}")
    assert f"ashe_live.{package}" in loaded
    assert loaded & HEAVY == LOADS[package]


def test_help_is_instant_because_it_loads_nothing_heavy() -> None:
    loaded = modules_after(LOAD_HELP)
    assert "ashe_live.cli" in loaded
    assert not loaded & (HEAVY | {"numpy"})


def test_presets_are_values_that_load_nothing_of_what_they_configure() -> None:
    loaded = modules_after("import json, sys, ashe_live.quality; print(json.dumps(sorted(sys.modules)))")
    assert "ashe_live.light.estimators.preset" in loaded
    assert not loaded & (HEAVY)


def test_only_render_names_moderngl_and_only_the_viewer_glfw() -> None:
    for name, home in (("moderngl", "render"), ("glfw", "viewer")):
        users = {
            room for room, paths in FILES.items() if any([name] == p[:1] for path in paths for p in imported(path))
        }
        assert users == {home}


def test_no_file_is_unpickled_or_evaluated_and_no_network_is_asked() -> None:
    """process/pipes.py pickles between the program's own processes, and nothing else does."""
    never = {"marshal", "shelve", "socket", "urllib.request", "http", "ftplib", "ssl", "requests"}
    for path in PACKAGE.rglob("*.py"):
        names = {".".join(parts[:length]) for parts in imported(path) for length in range(1, len(parts) + 1)}
        assert not names & never, path
        assert not parsed(path)[1] & {"eval", "exec", "np.load", "numpy.load"}, path
        assert "pickle" not in names or path.name == "pipes.py", path
