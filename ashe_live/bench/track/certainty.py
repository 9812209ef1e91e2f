"""Whether poses are as certain as they say, on pictures whose poses are known, and the figures that make them so."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, replace

import numpy as np

from ashe_live.bench.cases import Case
from ashe_live.bench.descent import coordinate_descent
from ashe_live.bench.track.measures import MEDIAN_6, pose_error
from ashe_live.bench.track.tables import Figure
from ashe_live.core.arrays import Float
from ashe_live.core.camera import Camera
from ashe_live.core.square import square_corners
from ashe_live.core.types import MarkerPose
from ashe_live.tracking.edges.corner_errors import FITTED, CornerErrors, corrected, uncorrected_px
from ashe_live.tracking.edges.squares import FittedSquare
from ashe_live.tracking.families.markers import Marker, parse_marker
from ashe_live.tracking.poses.pose import Sighting, Tolerance, pose_of_squares
from ashe_live.tracking.preset import TrackingPreset
from ashe_live.tracking.search import anywhere, refined

WITHIN_95_PERCENT_6 = 12.592  # of the chi-squared distribution with six degrees of freedom
LEAST_RATIO, MOST_RATIO = 0.6, 1.4
LEAST_WITHIN, MOST_WITHIN = 90.0, 98.0
# Where a marker that was seen has no pose, its squared error: far beyond any ellipsoid.
NO_POSE = 1e3
# How many of the errors the ellipsoids of 95 % are to hold, and what a lower share costs in logarithms of their volume.
WANTED_WITHIN, SHORTFALL_COST = 0.95, 100.0
# What pictures whose print is exact cannot tell: they drive it to 0.
STATED = ("end_px",)
# Factors by which each figure is varied in turn, until none of them improves the ellipsoids.
FACTORS = 1.5, 1.2, 1.08
GAIN = 1e-3  # of the logarithm of their volume, below which none counts


@dataclass(frozen=True, slots=True)
class SeenMarker:
    """A marker found in a picture, and where it is in truth."""

    square: FittedSquare
    camera: Camera
    side_m: float
    truth: Float  # (4, 4) T_cam_marker

    def pose(self, errors: CornerErrors) -> MarkerPose | None:
        """The pose, its corners taken to be as uncertain as `errors` has them."""
        square = replace(self.square, corners_px=uncorrected_px(self.square))
        square = corrected(square, self.square.bleed_px, errors)
        sighting, tolerance = Sighting(square_corners(self.side_m), square), Tolerance(errors)
        return pose_of_squares([sighting], self.camera, self.side_m, tolerance=tolerance)


def look_at(cases: Sequence[Case], preset: TrackingPreset) -> list[SeenMarker | None]:
    """What is found of the markers that the cases name, each without a frame before; None where nothing is."""
    return [_seen(parse_marker(case.marker_spec), case, preset) for case in cases if case.marker_spec is not None]


def certainty_figures(name: str, seen: Sequence[SeenMarker | None]) -> Iterator[Figure]:
    """The squared errors of poses over their covariances: the median, and the share in the 95 % ellipsoid."""
    squares = np.array([_squared_error(one, FITTED)[0] for one in seen if one is not None])
    if seen:
        yield Figure(f"found, {name} ({len(seen)})", "%", None, 100 * len(squares) / len(seen), None)
    if not len(squares):
        return
    ratio = float(np.median(squares)) / MEDIAN_6
    yield Figure(f"squared error over its covariance, {name}", "", None, ratio, MOST_RATIO, LEAST_RATIO)
    within = 100 * float((squares <= WITHIN_95_PERCENT_6).mean())
    yield Figure(f"in the ellipsoid of 95 %, {name}", "%", None, within, MOST_WITHIN, LEAST_WITHIN)


def fitted(
    seen: Sequence[SeenMarker | None], start: CornerErrors = FITTED, stated: Sequence[str] = STATED
) -> CornerErrors | None:
    """The standard deviations with the smallest ellipsoids that hold 95 % of the errors, near `start`.

    By coordinate descent; what is `stated` stays. Errors have heavier tails than a normal distribution, whose likeliest
    ellipsoids hold too few. None where no marker is found.
    """
    known = [one for one in seen if one is not None]
    if not known:
        return None
    varied = {name: value for name, value in asdict(start).items() if name not in stated}

    def errors(values: Sequence[float]) -> CornerErrors:
        return replace(start, **dict(zip(varied, values, strict=True)))

    values, limits = list(varied.values()), [(0.0, math.inf)] * len(varied)
    return errors(coordinate_descent(values, lambda tried: _cost(known, errors(tried)), FACTORS, limits, GAIN))


def _seen(marker: Marker, case: Case, preset: TrackingPreset) -> SeenMarker | None:
    image = case.tracked().frame.image_bgr
    for thorough in (False, True):
        for coarse_px in anywhere([marker], image, preset.detection_width_px, thorough)[0][:1]:
            square = refined(marker, image, case.camera, coarse_px, preset.edge_samples)
            if square is not None:
                return SeenMarker(square, case.camera, case.marker.side_m, case.marker.T_cam_marker)
    return None


def _cost(seen: Sequence[SeenMarker], errors: CornerErrors) -> float:
    """The mean logarithm of the ellipsoids' volumes, with what they cost that hold too few errors."""
    squared, log_volumes = np.array([_squared_error(one, errors) for one in seen]).T
    within = float((squared <= WITHIN_95_PERCENT_6).mean())
    return float(log_volumes.mean()) + SHORTFALL_COST * max(0.0, WANTED_WITHIN - within)


def _squared_error(seen: SeenMarker, errors: CornerErrors) -> tuple[float, float]:
    """The squared error of the pose in standard deviations, and the logarithm of the ellipsoid's volume."""
    pose = seen.pose(errors)
    if pose is None or pose.covariance is None:
        return NO_POSE, 0.0
    error = pose_error(pose.T_cam_marker, seen.truth)
    return float(error @ np.linalg.solve(pose.covariance, error)), float(np.linalg.slogdet(pose.covariance)[1]) / 2
