"""Small films of our own: a marker and a box that casts a shadow, painted where projection puts them."""

import gc
import json
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from hypothesis import HealthCheck, settings

from ashe_live import cli
from ashe_live.capture.recording.recorder import Recorder
from ashe_live.core.arrays import Float, Image
from ashe_live.core.camera import Camera
from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT, srgb_from_linear
from ashe_live.core.transforms import direction_from_angles, project
from ashe_live.tracking.families.markers import parse_marker
from tests.camera_poses import looking_at

SIDE_M = 0.08
FPS = 30.0
HFOV_DEG = 55.0
GROUND_BGR, SHADOW_BGR = (150, 155, 160), (50, 50, 55)
BOX_TOP_BGR = (60, 150, 220)
SKY, BOUNCED = 0.1, 0.3  # of the light on level ground, as in the shadow; and what the ground sends back of it
SUPERSAMPLING = 2
MARKER_PX = 400
# Folders whose tests start the program, open windows and wait for these.
START = ("e2e", "fuzz", "packaging")
# Of the others: these first, so that at the end both processes have something left to do.
LONG = ("bench", "light", "tracking", "commands", "viewer", "test_api.py", "test_docs.py")


@dataclass(frozen=True)
class Film:
    """A clip, the same camera for all its frames, and where its light is."""

    path: Path
    camera_file: Path
    size: tuple[int, int]
    frame_count: int
    to_light_marker: Float


def pose_of(eye: tuple[float, float, float]) -> Float:
    """`T_cam_marker` of a camera at `eye` in the marker frame that looks at a point beside the marker."""
    return looking_at((0.04, 0.0, 0.0), eye)


def painted_frame(camera: Camera, T_cam_marker: Float, to_light: Float) -> Image:
    """(h, w, 3) uint8: marker `aruco:4x4_50:0` on white paper, and an orange box beside it with its shadow."""
    width, height = camera.size
    fine = camera.resized((width * SUPERSAMPLING, height * SUPERSAMPLING))
    image = np.full((*fine.size[::-1], 3), GROUND_BGR, np.uint8)

    def fill(points_marker: Float, colour: tuple[int, int, int]) -> None:
        hull = cv2.convexHull(project(fine, T_cam_marker, points_marker).astype(np.float32))
        cv2.fillConvexPoly(image, np.round(hull * 16).astype(np.int32), colour, cv2.LINE_AA, shift=4)

    paper = cv2.copyMakeBorder(
        parse_marker("aruco:4x4_50:0").bitmap(MARKER_PX), *[MARKER_PX // 5] * 4, cv2.BORDER_CONSTANT, value=240
    )
    metres = SIDE_M / MARKER_PX
    centre = (paper.shape[0] - 1) / 2
    marker_from_paper = np.array([(metres, 0, -centre * metres), (0, -metres, centre * metres), (0, 0, 1)])
    homography = fine.K @ T_cam_marker[:3, (0, 1, 3)] @ marker_from_paper
    cv2.warpPerspective(
        cv2.cvtColor(paper, cv2.COLOR_GRAY2BGR),
        homography,
        fine.size,
        dst=image,
        flags=cv2.INTER_AREA,
        borderMode=cv2.BORDER_TRANSPARENT,
    )
    base, top = box_corners()
    fill(np.concatenate([base, top - top[:, 2:] * (to_light / to_light[2])]), SHADOW_BGR)
    for at in range(4):
        side = np.array([base[at - 1], base[at], top[at], top[at - 1]])
        outward = side[:2].mean(axis=0) - base.mean(axis=0)
        eye = -T_cam_marker[:3, :3].T @ T_cam_marker[:3, 3]
        if outward @ (eye - side[0]) > 0:
            normal = outward / np.linalg.norm(outward)
            lit = (1 - SKY) * max(float(normal @ to_light), 0.0) / to_light[2]
            fill(side, as_bright(BOX_TOP_BGR, SKY / 2 + BOUNCED / 2 + lit))
    fill(top, BOX_TOP_BGR)
    return cv2.resize(image, camera.size, interpolation=cv2.INTER_AREA)


def as_bright(colour_bgr: tuple[int, int, int], share: float) -> tuple[int, int, int]:
    """A matt thing's colour where it gets this share of the light."""
    linear = share * LINEAR_FROM_SRGB_8BIT[list(colour_bgr)]
    blue, green, red = np.round(255 * srgb_from_linear(np.minimum(linear, 1)))
    return int(blue), int(green), int(red)


def box_corners() -> tuple[Float, Float]:
    """(4, 3) base and (4, 3) top, metres, marker frame."""
    base = np.array([(0.105, -0.03, 0), (0.155, -0.03, 0), (0.155, 0.02, 0), (0.105, 0.02, 0)])
    return base, base + np.array((0, 0, 0.08))


def shoot(folder: Path, size: tuple[int, int], frame_count: int) -> Film:
    """A slow pan around the scene at 30 frames a second, with a little noise, as MP4 with its camera file beside it."""
    camera = Camera.from_hfov(size, HFOV_DEG)
    to_light = direction_from_angles(np.radians(200), np.radians(42))
    film = Film(folder / "box.mp4", folder / "camera.json", size, frame_count, to_light)
    film.camera_file.write_text(json.dumps({"size": size, "K": camera.K.tolist(), "dist": [0.0] * 5}))
    random = np.random.default_rng(11)
    with Recorder(film.path, size, FPS) as recorder:
        for index in range(frame_count):
            angle = np.radians(-100 + 20 * index / max(1, frame_count - 1))
            T_cam_marker = pose_of((0.5 * np.cos(angle), 0.5 * np.sin(angle), 0.4))
            image = painted_frame(camera, T_cam_marker, to_light)
            recorder.write((image + random.integers(0, 4, image.shape)).clip(0, 255).astype(np.uint8), index / FPS)
    return film


@pytest.fixture(scope="session")
def picture_of_box() -> Callable[..., Image]:
    """The scene as the film has it, (h, w, 3), from a side and in a light of these azimuths in degrees."""

    def picture(azimuth_deg: float, light_deg: float = 200.0, elevation_deg: float = 42.0) -> Image:
        angle = np.radians(azimuth_deg)
        T_cam_marker = pose_of((0.5 * np.cos(angle), 0.5 * np.sin(angle), 0.4))
        to_light = direction_from_angles(np.radians(light_deg), np.radians(elevation_deg))
        return painted_frame(Camera.from_hfov((640, 480), HFOV_DEG), T_cam_marker, to_light)

    return picture


@pytest.fixture(scope="session")
def shoot_film() -> Callable[[Path, tuple[int, int], int], Film]:
    return shoot


@pytest.fixture(scope="session")
def film(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Film]:
    """Twelve small frames: enough for the marker to be steady."""
    return shoot(tmp_path_factory.mktemp("film"), (320, 240), 12)


# The same examples every time, so that no change is blamed for an old fault (tests/fuzz hunts for others), and as long
# as each takes: where others crowd the machine, a call of a millisecond may need a second.
settings.register_profile(
    "suite", derandomize=True, deadline=None, suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large]
)
settings.load_profile("suite")


def pytest_configure() -> None:
    """One thread of OpenCV, as in the viewer and in the light's process: its others spin between calls."""
    cv2.setNumThreads(1)


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """The longest groups first, so that at the end both processes have something left to do."""
    items.sort(key=lambda item: _group(item.nodeid)[0])


def pytest_collection_finish() -> None:
    """The collector of garbage need not look again at seven thousand tests, nor those who count what is left over."""
    gc.collect()
    gc.freeze()


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> object:
    """With pytest-xdist: a process takes the next group when it has nothing left to do, in the order above.

    The renderer's tests share a graphics context and what models hide, and stay together; so do those that open
    windows. Of the others each file is a group of its own, as its tests share films and pictures. (Not by the marks
    of `--dist loadgroup`: pytest-xdist 3.8 writes these into names that pytest 9.2 no longer reads, and says nothing.)
    """
    from xdist.scheduler import LoadScopeScheduling

    class ByGroup(LoadScopeScheduling):
        def _split_scope(self, nodeid: str) -> str:
            return _group(nodeid)[1]

    config.option.loadscopereorder = False
    return ByGroup(config, log)


def _group(nodeid: str) -> tuple[int, str]:
    """When its turn is, and its name."""
    place = nodeid.partition("::")[0].removeprefix("tests/")
    first = place.partition("/")[0]
    if first == "render":
        return 0, "pictures"
    if first in START:
        return 1, "windows"
    return (2 if first in LONG else 3), place


@pytest.fixture(scope="session", autouse=True)
def _no_settings_of_the_tester(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Neither read nor written, also by the processes that tests start."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_CONFIG_HOME", str(tmp_path_factory.mktemp("config")))
        if not cli._keeps_shaders():  # as the program itself does, of which most tests run what is within
            patch.setenv("MESA_SHADER_CACHE_DISABLE", "true")
        yield
