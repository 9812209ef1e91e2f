"""The estimator's answers to a set of cubes: errors, counts, calibration, lamps, ambient light, time."""

import time
from collections.abc import Iterable
from dataclasses import dataclass, field
from itertools import chain

import numpy as np

from ashe_live.bench.cube.ambient import ambient_errors
from ashe_live.bench.cube.pictures import CubePicture
from ashe_live.bench.metrics import (
    BAD_CONFIDENCE,
    BAD_DEG,
    angular_error_deg,
    median,
    percentile,
    share,
    squared_sigmas,
)
from ashe_live.core.arrays import Float
from ashe_live.core.contract import Json
from ashe_live.core.light import LightEstimate
from ashe_live.core.transforms import ELLIPSE_95
from ashe_live.core.types import Frame, TrackedFrame
from ashe_live.light.estimators.estimator import make_estimator
from ashe_live.quality import Quality
from ashe_live.tracking.families.layout import cube_layout
from ashe_live.tracking.tracker import MarkerTracker


def light_row(name: str, pictures: Iterable[CubePicture], quality: Quality) -> Json:
    """Errors of the strongest light, of the true one that is found worst, and of the ambient light.

    Each picture is a cube's first, or the last of those in which it was followed, with the tracker's own pose; and with
    these as further views, where they are given together.
    """
    estimator, tally = make_estimator("proxy", quality.light), _Tally()
    for picture in pictures:
        tally.seen.append(picture.shows_shadows)
        *before, tracked = _followed(picture, quality)
        if tracked.marker is None:
            continue
        others = [each for each in before if each.marker is not None] if picture.together else []
        begin = time.thread_time()
        estimate = estimator.estimate(tracked, others)
        tally.spent_ms.append(1e3 * (time.thread_time() - begin))
        if estimate.lights:
            tally.add(estimate, picture)
    return tally.row(name)


def _followed(picture: CubePicture, quality: Quality) -> list[TrackedFrame]:
    """The frames before the picture, and last the picture itself, as one tracker sees them."""
    tracker = MarkerTracker(cube_layout(), picture.camera, picture.edge_m, quality.tracking)
    images = chain(picture.before, [picture.image])
    return [tracker.track(Frame(image, index, index / picture.fps)) for index, image in enumerate(images)]


@dataclass
class _Tally:
    """What answers have come to, of a set of pictures."""

    seen: list[bool] = field(default_factory=list)  # of each picture, whether it shows a shadow
    spent_ms: list[float] = field(default_factory=list)
    counted: list[bool] = field(default_factory=list)  # of each answer, whether it has as many lights as there are
    wrong: int = 0  # answers with a light that is likelier right than wrong as stated, and far from every true one
    # Of each answer where there is a light:
    first_deg: list[float] = field(default_factory=list)  # error of the strongest light that is answered
    in_view_deg: list[float] = field(default_factory=list)  # the same, where a shadow is seen
    worst_deg: list[float] = field(default_factory=list)  # of the true light that is found worst
    within: list[bool] = field(default_factory=list)  # whether the first is in its 95 % ellipse
    lamps: int = 0  # answers whose first light is a lamp's
    distances: list[float] = field(default_factory=list)  # relative errors of those that are lamps
    ambient: list[tuple[float, float]] = field(default_factory=list)  # by an even sky, by a leaning one

    def add(self, estimate: LightEstimate, picture: CubePicture) -> None:
        errors = _errors_deg(estimate, picture.lights)
        is_sure = np.array([(light.confidence or 0.0) > BAD_CONFIDENCE for light in estimate.lights])
        self.wrong += bool((is_sure & (errors > BAD_DEG).all(axis=1)).any())
        self.counted.append(len(estimate.lights) == len(picture.lights))
        if not len(picture.lights):
            return
        self.first_deg.append(errors[0].min())
        self.in_view_deg += [errors[0].min()] if self.seen[-1] else []
        self.worst_deg.append(errors.min(axis=0).max())
        true, light = picture.lights[int(errors[0].argmin())], estimate.lights[0]
        assert light.covariance_rad2 is not None
        self.within.append(squared_sigmas(light.to_light_marker, light.covariance_rad2, true[:3]) <= ELLIPSE_95)
        self.lamps += light.inverse_distance > 0
        if light.inverse_distance > 0 and true[3] > 0:
            true_m = float(np.linalg.norm(true[:3]) / true[3])
            self.distances.append(abs(true_m * light.inverse_distance - 1))
        self.ambient.append(ambient_errors(picture.sky_on_ball, picture.table_rgb, estimate.illumination))

    def row(self, name: str) -> Json:
        first, in_view = self.first_deg, self.in_view_deg
        return {
            "set": name,
            "pictures": len(self.seen),
            "answered": len(self.counted) / max(len(self.seen), 1),
            "median_deg": median(first),
            "percentile_95_deg": percentile(first, 95),
            "largest_deg": max(first, default=None),
            "shadow_hidden": 1 - float(np.mean(self.seen)) if self.seen else None,
            "percentile_95_of_others_deg": percentile(in_view, 95),
            "sure_and_wrong": self.wrong,
            "in_95_percent_ellipse": share(self.within),
            "count_right": share(self.counted),
            "worse_median_deg": median(self.worst_deg),
            "ambient_even": median(even for even, _ in self.ambient),
            "ambient_leaning": median(leaning for _, leaning in self.ambient),
            "stated_as_lamps": self.lamps / len(first) if first else None,
            "distance_relative_error": median(self.distances),
            "ms": median(self.spent_ms),
        }


def _errors_deg(estimate: LightEstimate, lights: Float) -> Float:
    """(answered lights, true lights) angles between them."""
    errors = [[angular_error_deg(light.to_light_marker, true[:3]) for true in lights] for light in estimate.lights]
    return np.array(errors).reshape(len(estimate.lights), len(lights))
