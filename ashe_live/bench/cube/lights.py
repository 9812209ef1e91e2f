"""What the estimator tells of the lights of a set of cubes: errors, counts, calibration, lamps, ambient light, time."""

import math
import time
from collections.abc import Iterable, Sequence
from itertools import chain

import numpy as np

from ashe_live.bench.cube.ambient import ambient_errors
from ashe_live.bench.cube.pictures import CubePicture
from ashe_live.bench.metrics import ELLIPSE_95, squared_sigmas
from ashe_live.core.arrays import Float
from ashe_live.core.contract import Json
from ashe_live.core.transforms import angle_between
from ashe_live.core.types import Frame, Light, LightEstimate
from ashe_live.light.estimators.estimator import make_estimator
from ashe_live.quality import Quality
from ashe_live.tracking.families.layout import cube_layout
from ashe_live.tracking.tracker import MarkerTracker

FPS = 30  # of frames by which a cube is followed
SURE, WRONG_RAD = 0.5, math.radians(15)  # confidence above which, and error beyond which, an answer is a confident lie


def light_row(name: str, pictures: Iterable[CubePicture], quality: Quality) -> Json:
    """Errors of the strongest light, of the true one that is found worst, and of the ambient light.

    Each picture is a cube's first, or the last of those in which it was followed, with the tracker's own pose.
    """
    estimator = make_estimator("proxy", quality.light)
    first, worse, ambient, counted, spent, answered, attempted = [], [], [], [], [], 0, 0
    within, distances, in_view, seen, wrong, lamps = [], [], [], [], 0, 0
    for picture in pictures:
        attempted += 1
        seen.append(picture.shows_shadows)
        tracker = MarkerTracker(cube_layout(), picture.camera, picture.edge_m, quality.tracking)
        for index, image in enumerate(chain(picture.before, [picture.image])):
            tracked = tracker.track(Frame(image, index, index / FPS))
        if tracked.marker is None:
            continue
        begin = time.thread_time()
        estimate = estimator.estimate(tracked)
        spent.append(1e3 * (time.thread_time() - begin))
        if not estimate.lights:
            continue
        answered += 1
        wrong += _is_sure_and_wrong(estimate, picture.lights)
        counted.append(len(estimate.lights) == len(picture.lights))
        if len(picture.lights):
            errors = _errors_deg(estimate, picture.lights)
            first.append(errors[0].min())
            in_view += [errors[0].min()] if seen[-1] else []
            worse.append(errors.min(axis=0).max())
            true = picture.lights[int(errors[0].argmin())]
            light = estimate.lights[0]
            assert light.covariance_rad2 is not None
            squared = squared_sigmas(light.to_light_marker, light.covariance_rad2, true[:3])
            within.append(squared <= ELLIPSE_95)
            lamps += light.inverse_distance > 0
            if light.inverse_distance > 0 and true[3] > 0:
                distances.append(abs(_true_over_found_distance(light, true) - 1))
            ambient.append(ambient_errors(picture.sky_on_ball, picture.table_rgb, estimate.illumination))
    return {
        "set": name,
        "pictures": attempted,
        "answered": answered / max(attempted, 1),
        "median_deg": median(first),
        "percentile_95_deg": float(np.percentile(first, 95)) if first else None,
        "largest_deg": max(first, default=None),
        "shadow_hidden": 1 - float(np.mean(seen)) if seen else None,
        "percentile_95_of_others_deg": float(np.percentile(in_view, 95)) if in_view else None,
        "sure_and_wrong": wrong,
        "in_95_percent_ellipse": float(np.mean(within)) if within else None,
        "count_right": float(np.mean(counted)) if counted else None,
        "worse_median_deg": median(worse),
        "ambient_even": median([even for even, _ in ambient]),
        "ambient_leaning": median([leaning for _, leaning in ambient]),
        "stated_as_lamps": lamps / len(first) if first else None,
        "distance_relative_error": median(distances),
        "ms": median(spent),
    }


def median(values: Sequence[float]) -> float | None:
    """None without any."""
    return float(np.median(values)) if len(values) else None


def _errors_deg(estimate: LightEstimate, lights: Float) -> Float:
    """(answered lights, true lights) angles between them."""
    return np.array(
        [[math.degrees(angle_between(light.to_light_marker, true[:3])) for true in lights] for light in estimate.lights]
    )


def _is_sure_and_wrong(estimate: LightEstimate, lights: Float) -> bool:
    """Whether a light is stated as likelier right than wrong, far from every true one (n, 4)."""
    return any(
        (light.confidence or 0.0) > SURE
        and all(angle_between(light.to_light_marker, true[:3]) > WRONG_RAD for true in lights)
        for light in estimate.lights
    )


def _true_over_found_distance(light: Light, true: Float) -> float:
    """1 of what is told rightly, for a lamp (4,)."""
    return float(np.linalg.norm(true[:3]) / true[3] * light.inverse_distance)
