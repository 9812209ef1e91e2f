"""The accuracy of the focal length learned from ten seconds of the marker alone."""

from collections.abc import Iterator
from functools import partial

import numpy as np

from ashe_live.bench.track.tables import Figure
from ashe_live.bench.track.takes import FPS, SIDE_M, SMALL, SPEC, Take, pose_at
from ashe_live.core.arrays import Float
from ashe_live.core.camera import Camera
from ashe_live.tracking.families.markers import parse_marker
from ashe_live.tracking.focal.focal import FocalEstimator
from ashe_live.tracking.preset import TrackingPreset
from ashe_live.tracking.tracker import MarkerTracker

WITHIN_PERCENT, HONEST_SIGMAS = 3.0, 3.0  # targets of the error, and of the error in its own standard deviations


def focal_figures(preset: TrackingPreset, frames: int) -> Iterator[Figure]:
    """The error of the focal length in percent, and in units of its stated standard deviation."""
    take = Take("focal", SMALL, frames, partial(_handled, frames))
    tracker = MarkerTracker(parse_marker(SPEC), Camera.assumed(SMALL.size), SIDE_M, preset)
    estimator = FocalEstimator(SMALL.size)
    for frame, _ in take.film():
        estimator.add(tracker.track(frame))
    estimate, truth_px = estimator.estimate, float(SMALL.K[0, 0])
    percent = None if estimate is None else 100 * abs(estimate.focal_px / truth_px - 1)
    sigmas = None if estimate is None else abs(estimate.focal_px - truth_px) / estimate.sigma_px
    yield Figure(f"focal length after {frames / FPS:.0f} s, error", "%", None, percent, WITHIN_PERCENT)
    yield Figure("the same in its own σ", "σ", None, sigmas, HONEST_SIGMAS)


def _handled(frames: int, index: int) -> tuple[Float, ...]:
    """Poses of a hand-held sheet, tilted and turned in all directions, nearer and farther."""
    angle = 2 * np.pi * index / frames
    distance_m = SMALL.K[0, 0] * SIDE_M / (120 + 40 * np.sin(2 * angle))
    aside_m = 0.15 * distance_m * np.sin(angle), 0.12 * distance_m * np.cos(2 * angle)
    return (pose_at(distance_m, 30 + 25 * np.sin(3 * angle), 360 * index / frames, aside_m),)
