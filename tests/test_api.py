"""The programming interface: docs/api.md runs as written; what it promises is kept; importing it is cheap."""

import re
import shutil
import subprocess
import sys
from pathlib import Path

import cv2
import numpy as np
import pytest

import ashe_live as al

PAGE = Path(__file__).parents[1] / "docs" / "api.md"
EXAMPLES = re.findall(r"```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)


@pytest.fixture(scope="module")
def photo_folder(shoot_film, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, np.ndarray]:
    """With the files that the page names, and the true direction of the light."""
    folder = tmp_path_factory.mktemp("api")
    film = shoot_film(folder, (640, 480), 4)
    shutil.move(film.path, folder / "table.mp4")
    with al.open_source(folder / "table.mp4") as clip:
        al.write_png(folder / "table.png", clip.read().image_bgr)
    return folder, film.to_light_marker


@pytest.fixture(scope="module")
def ran(photo_folder) -> dict:
    """The variables that the page's examples leave behind."""
    folder, _ = photo_folder
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        names: dict = {}
        for example in EXAMPLES:
            exec(compile(example, str(PAGE), "exec"), names)
    return names


def test_the_first_example_is_ten_lines():
    assert len(EXAMPLES) >= 5
    assert len(EXAMPLES[0].splitlines()) <= 10


def test_the_pages_examples_find_the_marker_and_the_light(ran, photo_folder):
    _, to_light = photo_folder
    assert ran["T_cam_marker"].shape == (4, 4)
    assert np.degrees(np.arccos(ran["estimate"].light.to_light_marker @ to_light)) < 10
    assert len(ran["pictures"]) == 4


def test_the_model_stands_on_the_marker_and_nowhere_far_from_it(ran, photo_folder):
    folder, _ = photo_folder
    before, after = cv2.imread(str(folder / "table.png")), cv2.imread(str(folder / "with_mug.png"))
    changed = np.abs(after.astype(int) - before).max(axis=2) > 30
    corners = ran["corners"]
    assert changed[int(corners[:, 1].mean()), int(corners[:, 0].mean())]
    assert not changed[:, -20:].any()


def test_a_picture_without_a_marker_is_answered_with_a_reason_and_drawn_as_it_is():
    grey = np.full((96, 128, 3), 140, np.uint8)
    camera = al.Camera.from_hfov((128, 96), 60)
    estimate = al.estimate_light(grey, camera)
    assert estimate.light is None
    assert estimate.reason == "no marker found"
    with al.Renderer((128, 96)) as renderer:
        np.testing.assert_array_equal(
            renderer.render(al.Tracker(camera).track(grey), "cube", estimate.illumination()), grey
        )


def test_two_renderers_do_not_disturb_each_other():
    camera = al.Camera.from_hfov((64, 48), 60)
    dark, bright = (al.Tracker(camera).track(np.full((48, 64, 3), value, np.uint8)) for value in (20, 220))
    with al.Renderer((64, 48)) as first, al.Renderer((64, 48)) as second:
        for _ in range(2):
            assert first.render(dark, "cube").mean() == pytest.approx(20)
            assert second.render(bright, "cube").mean() == pytest.approx(220)


def test_wrong_use_is_a_value_error():
    camera = al.Camera.from_hfov((64, 48), 60)
    grey = np.full((48, 64, 3), 140, np.uint8)
    for wrong in (
        lambda: al.Tracker(camera, side_m=0),
        lambda: al.Tracker(camera, quality="best"),
        lambda: al.Tracker(camera).track(grey[:, :, 0]),
        lambda: al.Renderer((0, 48)),
    ):
        with pytest.raises(ValueError, match=r"not|empty"):
            wrong()
    with pytest.raises(al.UserError):
        al.estimate_light(grey, camera, marker="qr:7")
    with pytest.raises(al.UserError):
        al.estimate_light(grey, al.Camera.from_hfov((100, 20), 60))


def test_every_name_is_there_and_no_other():
    for name in al.__all__:
        assert getattr(al, name).__name__ == name
    assert set(al.__all__) <= set(dir(al))
    with pytest.raises(AttributeError, match="no attribute 'learn'"):
        al.learn  # noqa: B018


@pytest.mark.parametrize(
    ("code", "absent"),
    [
        ("import ashe_live", {"cv2", "numpy", "moderngl", "glfw", "av", "trimesh", "PIL"}),
        ("import ashe_live; ashe_live.estimate_light, ashe_live.Tracker, ashe_live.Renderer", {"moderngl", "glfw"}),
    ],
)
def test_importing_loads_nothing_that_is_not_asked_for(code, absent):
    done = subprocess.run(
        [sys.executable, "-c", f"{code}; import sys; print(*sys.modules)"],
        capture_output=True,
        text=True,
        check=True,
        cwd=PAGE.parents[1],
    )
    loaded = set(done.stdout.split())
    assert "ashe_live" in loaded
    assert not loaded & absent
