"""Synthetic pictures of a marker at a known pose, and pattern files of our own."""

from collections.abc import Callable, Sequence
from pathlib import Path

import cv2
import numpy as np
import pytest

from ashe_live.core.arrays import Float, Image
from ashe_live.core.camera import Camera, Size
from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT, srgb_from_linear
from ashe_live.core.transforms import rigid
from ashe_live.core.types import Frame
from ashe_live.tracking.families.markers import Marker, parse_marker

SIDE_M = 0.08
GROUND = 120
SUPERSAMPLING = 4
# One for each kind; "{pattern}" and "{picture}" stand for files that the fixture writes.
SPECS = ("aruco:4x4_50:3", "aruco:original:700", "apriltag:36h11:16", "pattern:{pattern}", "image:{picture}")


def pose(distance_m: float, tilt_deg: float, turn_deg: float = 0.0, aside_m: float = 0.0) -> Float:
    """T_cam_marker: the print turned in its plane (counter-clockwise to the eye), then tilted away from the camera."""
    turn = cv2.Rodrigues(np.array((0, 0, np.radians(turn_deg))))[0]
    tilt = cv2.Rodrigues(np.array((np.radians(180 - tilt_deg), 0, 0)))[0]
    return rigid(tilt @ turn, (aside_m, 0.01, distance_m))


def is_among(quads: Sequence[Float], corners_px: Float) -> bool:
    """Whether one of the quads (4, 2) lies at these corners (4, 2), whichever it begins with."""
    return any(np.abs(np.roll(quad, turn, axis=0) - corners_px).max() < 8 for quad in quads for turn in range(4))


def picture(marker: Marker, camera: Camera, T_cam_marker: Float, side_m: float = SIDE_M, noise: float = 2.0) -> Image:
    """(h, w, 3) undistorted frame: the marker on white paper on a grey ground, blurred as light is, and noisy."""
    cells_px = 320
    margin_px = cells_px // 4
    paper = cv2.copyMakeBorder(marker.bitmap(cells_px), *[margin_px] * 4, cv2.BORDER_CONSTANT, value=255)
    middle_px = (paper.shape[0] - 1) / 2
    return photographed(paper, side_m / cells_px, (middle_px, middle_px), camera, T_cam_marker, noise)


def photographed(
    paper: Image,
    metres_per_px: float,
    origin_px: tuple[float, float],
    camera: Camera,
    T_cam_paper: Float,
    noise: float = 2.0,
) -> Image:
    """(h, w, 3) frame of a printed `paper` (h, w) whose pixel `origin_px` (x, y) is its frame's origin, y up."""
    x, y = np.array(origin_px) * metres_per_px
    paper_from_px = np.array([(metres_per_px, 0, -x), (0, -metres_per_px, y), (0, 0, 1)])
    width, height = camera.size
    fine = camera.resized((width * SUPERSAMPLING, height * SUPERSAMPLING))
    homography = fine.K @ T_cam_paper[:3, (0, 1, 3)] @ paper_from_px
    grey = cv2.warpPerspective(paper, homography, fine.size, flags=cv2.INTER_AREA, borderValue=GROUND)
    levels = exposed(np.asarray(grey, dtype=np.uint8), camera.size, 0.7)
    noisy = levels + np.random.default_rng(7).normal(0, noise, camera.size[::-1])
    return np.repeat(noisy.round().clip(0, 255).astype(np.uint8)[:, :, None], 3, axis=2)


def exposed(fine: Image, size: Size, blur_px: float) -> Float:
    """(h, w) grey levels that a camera makes of a finer picture: light is what lens and sensor average."""
    light = LINEAR_FROM_SRGB_8BIT[fine].astype(np.float32)
    small = cv2.GaussianBlur(cv2.resize(light, size, interpolation=cv2.INTER_AREA), (0, 0), blur_px)
    return 255 * srgb_from_linear(small)


def frame(image_bgr: Image, index: int = 0) -> Frame:
    return Frame(image_bgr, index, index / 30)


def glyph() -> Image:
    """(16, 16) grey: a black letter F, which looks different in every rotation."""
    content = np.full((16, 16), 240, dtype=np.uint8)
    content[2:14, 3:6] = 10
    content[2:5, 3:13] = 10
    content[7:10, 3:10] = 10
    return content


def pattern_text(content: Image) -> str:
    """An ARToolKit pattern file: blue, green and red of each rotation."""
    turned = [np.rot90(content, turns) for turns in range(4)]
    return "\n\n".join("\n".join(" ".join(map(str, row)) for row in np.vstack([one] * 3)) for one in turned)


@pytest.fixture
def pattern_file(tmp_path: Path) -> Path:
    path = tmp_path / "f.patt"
    path.write_text(pattern_text(glyph()), encoding="ascii")
    return path


@pytest.fixture
def picture_file(tmp_path: Path) -> Path:
    whole = np.zeros((128, 128), dtype=np.uint8)
    whole[24:104, 24:104] = cv2.resize(glyph(), (80, 80), interpolation=cv2.INTER_NEAREST)
    path = tmp_path / "f.png"
    cv2.imwrite(str(path), whole)
    return path


@pytest.fixture
def marker_of(pattern_file: Path, picture_file: Path) -> Callable[[str], Marker]:
    """The marker of one of SPECS."""
    return lambda spec: parse_marker(spec.format(pattern=pattern_file, picture=picture_file))
