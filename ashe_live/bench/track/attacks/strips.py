"""An attack on the tracker: something lies along a side of the marker, as the finger that holds the sheet does.

Every view has an exactly known pose, so that a pose that is confidently wrong cannot hide behind a small residual.
"""

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ashe_live.bench.track.contenders import Contender, OpencvReference, Ours
from ashe_live.bench.track.frames import Cover, Flaws, PrintedMarker, ground
from ashe_live.bench.track.measures import turn_deg
from ashe_live.bench.track.tables import Figure
from ashe_live.bench.track.takes import CELLS, CLUTTER, FPS, SIDE_M, SMALL, SPEC, pose_at
from ashe_live.core.arrays import Float, Image
from ashe_live.core.square import square_corners
from ashe_live.core.transforms import project
from ashe_live.core.types import Frame, MarkerPose
from ashe_live.tracking.families.markers import parse_marker
from ashe_live.tracking.preset import TrackingPreset

# Linear reflectances: of fair and dark skin, paper and tape.
MATERIALS: dict[str, tuple[float, float]] = {"skin": (0.12, 0.45), "white": (0.6, 0.85), "black": (0.015, 0.05)}
WIDTHS_M = 0.003, 0.010
# A finger comes from outside: so far beyond the edge it still covers, over the side.
FINGER = 0.3
# From here on a pose is wrong.
WRONG_DEG, WRONG_PX = 3.0, 3.0
CLEAN_FRAMES, COVERED_FRAMES = 10, 5
# Errors of degrees need no finer picture.
RAYS = 3
MOST_WRONG_PERCENT, LEAST_RIGHT_PERCENT = 2.0, 60.0
RIGHT, WRONG, UNANSWERED = "right", "wrong", "unanswered"
Verdicts = Counter[str]  # how many views were answered so


@dataclass(frozen=True, slots=True)
class CoveredView:
    """One sheet in front of the camera and what comes to lie on it."""

    T_cam_marker: Float  # (4, 4)
    cover: Cover
    drift_m: Float  # (3,) by which it moves from frame to frame


def strip_figures(preset: TrackingPreset, views: int) -> Iterator[Figure]:
    """Shares of wrong and right poses for each material, without and with clean frames before."""
    for following in (False, True):
        how = "following" if following else "cold"
        reference, ours = Verdicts(), Verdicts()
        for number, material in enumerate(MATERIALS):
            theirs, own = _attacked(preset, material, views, number, following)
            yield Figure(f"{material} strip, {how}, wrong", "%", _percent(theirs, WRONG), _percent(own, WRONG), None)
            reference += theirs
            ours += own
        wrong, right = ((_percent(reference, verdict), _percent(ours, verdict)) for verdict in (WRONG, RIGHT))
        yield Figure(f"edge covered by a strip, {how}, wrong", "%", *wrong, MOST_WRONG_PERCENT)
        yield Figure(f"edge covered by a strip, {how}, right", "%", *right, None, least=LEAST_RIGHT_PERCENT)


def covered_views(material: str, views: int, seed: int) -> Iterator[CoveredView]:
    """Sheets 60 to 200 px large, tilted by 10 to 50 degrees; half of the strips come from outside as fingers do."""
    rng = np.random.default_rng(seed)
    for number in range(views):
        distance_m = SMALL.K[0, 0] * SIDE_M / rng.uniform(60, 200)
        aside_m = rng.uniform(-0.08, 0.08, 2) * distance_m
        pose = pose_at(distance_m, rng.uniform(10, 50), rng.uniform(0, 360), (float(aside_m[0]), float(aside_m[1])))
        width = rng.uniform(*WIDTHS_M) / SIDE_M
        inwards = width if number % 2 else width * rng.uniform(0, 1)
        outwards = FINGER if number % 2 else width - inwards
        along = (-0.4, 1.4) if number % 4 < 2 else (-0.4, rng.uniform(0.5, 1.0))
        cover = Cover(
            number // 2 % 4, inwards, outwards, along, rng.uniform(-0.04, 0.04), rng.uniform(*MATERIALS[material])
        )
        yield CoveredView(pose, cover, rng.uniform(-0.002, 0.002, 3) * distance_m)


def filmed(view: CoveredView, canvas: Float, bitmap: Image, index: int, following: bool) -> tuple[Frame, Float]:
    """A frame of the view on `canvas` and its true T_cam_marker (4, 4); following, the strip comes in from outside."""
    rng = np.random.default_rng(index)
    T, cover = view.T_cam_marker.copy(), view.cover
    if following:
        T[:3, 3] += index * view.drift_m
        share = min(1.0, (index + 1 - CLEAN_FRAMES) / COVERED_FRAMES)
        shift = (1 - share) * (cover.inwards + cover.skew)
        cover = Cover(cover.side, cover.inwards - shift, cover.outwards + shift, cover.along, cover.skew, cover.light)
    is_covered = not following or index >= CLEAN_FRAMES
    flaws = Flaws(cover=cover if is_covered else None)
    return Frame(PrintedMarker(bitmap, SIDE_M, SMALL, flaws, RAYS).painted([T], rng, canvas), index, index / FPS), T


def _attacked(
    preset: TrackingPreset, material: str, views: int, seed: int, following: bool
) -> tuple[Verdicts, Verdicts]:
    """On OpenCV's answers, and on ours."""
    reference, ours = Verdicts(), Verdicts()
    frames = CLEAN_FRAMES + COVERED_FRAMES if following else 1
    canvas, bitmap = ground(SMALL, CLUTTER), parse_marker(SPEC).bitmap(CELLS)
    for view in covered_views(material, views, seed):
        detector: Contender = OpencvReference(SMALL)
        tracker: Contender = Ours(SMALL, preset)
        for index in range(frames):
            frame, truth = filmed(view, canvas, bitmap, index, following)
            said = tracker.look(frame)
        reference[_verdict(detector.look(frame), truth)] += 1
        ours[_verdict(said, truth)] += 1
    return reference, ours


def _verdict(said: Float | MarkerPose | None, truth: Float) -> str:
    """On what a contender says of a view with that T_cam_marker (4, 4)."""
    T = said.T_cam_marker if isinstance(said, MarkerPose) else said
    if T is None:
        return UNANSWERED
    corners, true_corners = (project(SMALL, pose, square_corners(SIDE_M)) for pose in (T, truth))
    off_px = np.linalg.norm(corners - true_corners, axis=1).max()
    return WRONG if turn_deg(T, truth) > WRONG_DEG or not off_px <= WRONG_PX else RIGHT


def _percent(verdicts: Verdicts, verdict: str) -> float:
    return 100 * verdicts[verdict] / max(1, verdicts.total())
