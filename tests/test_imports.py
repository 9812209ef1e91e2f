"""What each package must not load: the layers, held by a subprocess that imports the package's every module."""

import ast
import json
import subprocess
import sys
from pathlib import Path

import pytest

CHECKOUT = Path(__file__).parents[1]

GL = {"moderngl", "glfw"}
FLOORS = {
    "ashe_live.core": GL | {"cv2", "av", "trimesh", "PIL", "rich"},
    "ashe_live.models": GL | {"cv2", "av"},
    "ashe_live.capture": GL | {"trimesh", "ashe_live.tracking", "ashe_live.light", "ashe_live.render"},
    "ashe_live.tracking": GL | {"trimesh", "av", "ashe_live.capture", "ashe_live.light", "ashe_live.render"},
    "ashe_live.light": GL | {"trimesh", "av", "ashe_live.capture", "ashe_live.tracking", "ashe_live.render"},
    "ashe_live.render": {"glfw", "av", "ashe_live.capture", "ashe_live.tracking", "ashe_live.light"},
    "ashe_live.viewer": {"ashe_live.bench", "ashe_live.commands", "ashe_live.cli"},
    "ashe_live.bench": {"ashe_live.commands", "ashe_live.cli"},
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


@pytest.mark.parametrize("package", FLOORS)
def test_a_package_loads_nothing_from_above(package: str) -> None:
    loaded = modules_after(LOAD_EVERY_MODULE, package)
    assert package in loaded
    assert not loaded & FLOORS[package]


def test_help_is_instant_because_it_loads_nothing_heavy() -> None:
    loaded = modules_after(LOAD_HELP)
    assert "ashe_live.cli" in loaded
    assert not loaded & (GL | {"cv2", "numpy", "av", "trimesh", "PIL", "rich"})


def test_only_render_names_moderngl_and_only_the_viewer_glfw() -> None:
    for name, home in (("moderngl", "render"), ("glfw", "viewer")):
        users = {
            path.relative_to(CHECKOUT / "ashe_live").parts[0]
            for path in (CHECKOUT / "ashe_live").rglob("*.py")
            if any(line.split()[:2] in (["import", name], ["from", name]) for line in path.read_text().splitlines())
        }
        assert users == {home}


def test_no_file_is_unpickled_or_evaluated_and_no_network_is_asked() -> None:
    """core/pipes.py pickles between the program's own processes, and nothing else does."""
    never = {"marshal", "shelve", "socket", "urllib.request", "http", "ftplib", "ssl", "requests"}
    for path in (CHECKOUT / "ashe_live").rglob("*.py"):
        imported, called = set(), set()
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Import):
                imported |= {name.name for name in node.names}
            elif isinstance(node, ast.ImportFrom):
                imported |= {node.module, *(f"{node.module}.{name.name}" for name in node.names)}
            elif isinstance(node, ast.Call):
                called.add(ast.unparse(node.func))
        assert not imported & never, path
        assert not called & {"eval", "exec", "np.load", "numpy.load"}, path
        assert "pickle" not in imported or path.name == "pipes.py", path
