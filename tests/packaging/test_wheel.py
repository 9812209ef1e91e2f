"""The wheel, built from the checkout and installed into a new environment, works from any folder."""

import subprocess
import sys
import venv
from pathlib import Path

import pytest

from tests.checkout import CHECKOUT

LOAD_EVERYTHING = """
from pathlib import Path
import ashe_live
from ashe_live.files.resources import resource
from ashe_live.models.catalogue import load_model, model_names
from ashe_live.capture.clips.clip import ClipSource
from ashe_live.quality import FAST
from ashe_live.render.gl.offscreen import offscreen_context
from ashe_live.render.renderer import SceneRenderer

package = Path(ashe_live.__file__).parent
assert resource("shaders").parent == package, resource("shaders")
assert len(model_names()) >= 4
for name in model_names():
    assert load_model(name).triangle_count > 0
with ClipSource(resource("assets", "clips", "table.mp4")) as clip:
    assert clip.read() is not None
SceneRenderer(offscreen_context(), FAST.render, (64, 48)).release()
print("loaded", package)
"""


@pytest.fixture(scope="module")
def installed_python(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A new environment's Python with our wheel in it; the dependencies are borrowed from this environment."""
    folder = tmp_path_factory.mktemp("wheel")
    pip = [sys.executable, "-m", "pip", "--disable-pip-version-check"]
    # In this environment, which need not be the Makefile's, and is not set up again.
    make = ["make", "-C", CHECKOUT, "wheel", f"VENV={sys.prefix}", "-o", f"{sys.prefix}/test.stamp", f"DIST={folder}"]
    made = subprocess.run(make, capture_output=True, text=True)
    if "No matching distribution found for hatchling" in made.stderr:
        pytest.skip("without a network pip cannot fetch what builds the wheel")
    assert made.returncode == 0, made.stderr
    (wheel,) = folder.glob("ashe_live-*.whl")
    venv.create(folder / "env", with_pip=False)
    (site_packages,) = (folder / "env").rglob("site-packages")
    subprocess.run([*pip, "install", "--quiet", "--no-deps", "--target", site_packages, wheel], check=True)
    borrowed = [path for path in sys.path if path.endswith("site-packages")]
    (site_packages / "borrowed.pth").write_text("\n".join(borrowed))
    return folder / "env" / "bin" / "python"


@pytest.mark.packaging
def test_every_shader_and_model_loads_from_another_folder(installed_python: Path, tmp_path: Path) -> None:
    done = subprocess.run([installed_python, "-I", "-c", LOAD_EVERYTHING], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert str(CHECKOUT) not in done.stdout


@pytest.mark.packaging
def test_the_command_runs_from_another_folder(installed_python: Path, tmp_path: Path) -> None:
    sheet = tmp_path / "marker.png"
    command = [installed_python, "-I", "-m", "ashe_live", "marker", "--out", sheet]
    assert subprocess.run(command, cwd=tmp_path, capture_output=True).returncode == 0
    assert sheet.stat().st_size > 0
