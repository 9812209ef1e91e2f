"""An attack on the tracker: pictures full of what looks like markers, asked for ids that are not in them."""

from collections.abc import Iterable, Iterator
from pathlib import Path

import cv2
import numpy as np

from ashe_live.bench.track.frames import CLEAN_CAMERA, developed, ground
from ashe_live.bench.track.tables import Figure
from ashe_live.bench.track.takes import SIDE_M, SMALL
from ashe_live.core.arrays import Float, Image
from ashe_live.core.camera import Camera
from ashe_live.core.colour import linear_from_srgb
from ashe_live.core.types import Frame
from ashe_live.errors import UserError
from ashe_live.tracking.families.markers import parse_marker
from ashe_live.tracking.preset import TrackingPreset
from ashe_live.tracking.tracker import MarkerTracker

# Of 4x4_50: those that the generated pictures show, and how many others are asked for in each.
SHOWN_IDS, ABSENT_IDS = 20, 20
OTHERS = ("aruco:5x5_100", "aruco:6x6_50", "aruco:7x7_50", "apriltag:16h5", "apriltag:36h11", "aruco:original")
TILE_PX, TILES = 120, (5, 4)
MOST_FOUND_PERCENT, MOST_RMS_PX = 0.2, 2.0
PICTURES = {".jpg", ".jpeg", ".png", ".webp"}
# A picture larger than this is scaled down: its detail tells nothing more here.
WIDEST_PX = 1600


def impostor_figures(preset: TrackingPreset, pictures: int, photos: Path | None) -> Iterator[Figure]:
    """How many ids are found that are not there, on generated pictures and on those of a folder."""
    yield from _found_absent("generated pictures", (impostors(seed) for seed in range(pictures)), preset)
    if photos is not None:
        yield from _found_absent(f"pictures of {photos.name}", pictures_of(photos), preset, is_photo=True)


def pictures_of(folder: Path) -> list[Image]:
    """(h, w, 3) BGR, every picture in the folder and below. Raises UserError when there is none."""
    paths = sorted(path for path in folder.rglob("*") if path.suffix.lower() in PICTURES)
    pictures = [picture for path in paths if (picture := cv2.imread(str(path), cv2.IMREAD_COLOR)) is not None]
    if not pictures:
        raise UserError(f"there are no pictures in {folder}", f"it needs files of {', '.join(sorted(PICTURES))}")
    return [_of_working_size(np.asarray(picture, dtype=np.uint8)) for picture in pictures]


def impostors(seed: int) -> Image:
    """(h, w, 3) BGR: tags of other families, tags of this one, keys, cloth, chessboards and blots on paper."""
    rng = np.random.default_rng(seed)
    light = ground(SMALL, seed=seed)
    columns, rows = TILES
    step = np.array(SMALL.size) / TILES
    for number in range(columns * rows):
        tile = _tile(rng)
        centre = (np.array(divmod(number, rows)) + 0.5) * step + rng.uniform(-8, 8, 2)
        half = 0.5 * rng.uniform(0.5, 0.95) * step.min()
        square = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * half
        angle = rng.uniform(0, 2 * np.pi)
        turn = np.array([(np.cos(angle), -np.sin(angle)), (np.sin(angle), np.cos(angle))])
        corners = centre + (square * (1, rng.uniform(0.6, 1))) @ turn.T + rng.uniform(-0.08, 0.08, (4, 2)) * half
        _pasted(light, tile, corners)
    return developed(light, CLEAN_CAMERA, rng)


def _tile(rng: np.random.Generator) -> Float:
    """(TILE_PX, TILE_PX) linear reflectance of one thing with its surroundings."""
    kind = rng.integers(6)
    inner = round(0.75 * TILE_PX)
    grey = np.full((TILE_PX, TILE_PX), 235, dtype=np.uint8)
    at = (TILE_PX - inner) // 2
    inside = grey[at : at + inner, at : at + inner]
    if kind == 0:
        inside[:] = parse_marker(f"aruco:4x4_50:{rng.integers(SHOWN_IDS)}").bitmap(inner)
    elif kind == 1:
        inside[:] = parse_marker(f"{rng.choice(OTHERS)}:{rng.integers(30)}").bitmap(inner)
    elif kind == 2:  # a dark key with a letter or two
        inside[:] = 25
        text = "".join(rng.choice(list("ABEFHKLMNPRSTXZ2345789"), rng.integers(1, 3)))
        cv2.putText(
            inside, text, (8, inner - 22), cv2.FONT_HERSHEY_DUPLEX, 2.4 / len(text), 230, int(rng.integers(3, 12))
        )
    elif kind == 3:  # woven cloth, coarse enough to show its threads
        y, x = np.mgrid[:TILE_PX, :TILE_PX] / TILE_PX * rng.uniform(6, 16) * np.pi
        grey = (128 + 100 * np.sign(np.sin(x) * np.sin(y)) * rng.uniform(0.6, 1)).astype(np.uint8)
    elif kind == 4:  # a part of a chessboard
        squares = int(rng.integers(3, 8))
        cells = np.indices((squares, squares)).sum(axis=0) % 2
        grey[:] = cv2.resize((20 + 210 * cells).astype(np.uint8), grey.shape, interpolation=cv2.INTER_NEAREST)
    else:  # cells in a dark frame, as of a code of nobody's
        cells = (rng.random((rng.integers(3, 7),) * 2) > 0.5) * 215 + 20
        frame = np.pad(cells, 1, constant_values=20).astype(np.uint8)
        inside[:] = cv2.resize(frame, (inner, inner), interpolation=cv2.INTER_NEAREST)
    return linear_from_srgb(grey / 255)


def _pasted(light: Float, tile: Float, corners_px: Float) -> None:
    """Lays a tile over the picture `light` (h, w), its corners at `corners_px` (4, 2)."""
    size = light.shape[1], light.shape[0]
    ends = np.array([(0, 0), (TILE_PX, 0), (TILE_PX, TILE_PX), (0, TILE_PX)]) - 0.5
    H = cv2.getPerspectiveTransform(ends.astype(np.float32), corners_px.astype(np.float32))
    laid = cv2.warpPerspective(tile, H, size, flags=cv2.INTER_AREA)
    covers = cv2.warpPerspective(np.ones_like(tile), H, size, flags=cv2.INTER_AREA)
    light[:] = covers * laid + (1 - covers) * light


def _of_working_size(picture: Image) -> Image:
    scale = WIDEST_PX / max(picture.shape)
    if scale >= 1:
        return picture
    return np.asarray(cv2.resize(picture, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA), dtype=np.uint8)


def _found_absent(
    name: str, pictures: Iterable[Image], preset: TrackingPreset, is_photo: bool = False
) -> Iterator[Figure]:
    """What OpenCV reads in a photo is taken to be in it; of generated pictures it is known."""
    reference = cv2.aruco.ArucoDetector(cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_4X4_50))
    asked, theirs, ours, worst_px = 0, 0, 0, 0.0
    markers = [parse_marker(f"aruco:4x4_50:{number}") for number in range(50)]
    for number, picture in enumerate(pictures):
        _, ids, _ = reference.detectMarkers(picture)
        found = set(np.asarray([] if ids is None else ids).ravel().tolist())
        size = picture.shape[1], picture.shape[0]
        camera = Camera.assumed(size)
        start = SHOWN_IDS + number * ABSENT_IDS
        asked_for = (SHOWN_IDS + one % (50 - SHOWN_IDS) for one in range(start, start + ABSENT_IDS))
        for wanted in (one for one in asked_for if not (is_photo and one in found)):
            pose = MarkerTracker(markers[wanted], camera, SIDE_M, preset).track(Frame(picture, 0, 0.0)).marker
            asked += 1
            theirs += wanted in found
            if pose is not None:
                ours += 1
                worst_px = max(worst_px, pose.reprojection_rms_px)
    percent = 100 / max(1, asked)
    yield Figure(
        f"absent ids found, {name}", "%", None if is_photo else percent * theirs, percent * ours, MOST_FOUND_PERCENT
    )
    yield Figure(f"largest rms of these, {name}", "px", None, worst_px, MOST_RMS_PX)
