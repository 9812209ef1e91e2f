"""Estimates the focal length while a marker is tracked, if no calibration is given."""

import math
from dataclasses import dataclass

import numpy as np

from ashe_live.core.arrays import Float, distinct
from ashe_live.core.camera import Camera, Size
from ashe_live.core.square import square_corners
from ashe_live.core.transforms import project
from ashe_live.core.types import MarkerPose, TrackedFrame
from ashe_live.tracking.edges.lens import source_from_ideal
from ashe_live.tracking.focal.focal_fit import fit_focal

# A fit of this many views takes a few milliseconds; one of fewer than the second number cannot be trusted.
MOST_VIEWS = 64
MIN_VIEWS = 10
# A fit is made each time the number of different views seen so far has grown by this factor.
GROWTH = 1.4
# Two views are 1 apart if the marker has moved by this share of its diagonal, if the logarithm of its size has changed
# by this, or if it has turned by this.
PLACE_SCALE = 0.1
SIZE_SCALE = 0.05
TURN_SCALE_RAD = math.radians(2.0)
# Views are kept if they are 1 apart. Once there are too many, that distance grows by this factor.
THINNING = 1.3
# Corners that fit a pose better than this were computed from it, and not measured.
LEAST_RESIDUAL_PX = 1e-4
# The stated sigma is the fit's own times CAUTION, with a systematic part (relative to the focal length) added.
CAUTION = 1.3
SYSTEMATIC = 0.005
# Bounds of the relative sigma. Below KNOWN_SIGMA an estimate replaces an assumed focal length (corners of something
# that is no square are seen to give up to 0.13). A later estimate replaces it if its sigma is below MUCH_SURER times
# that of the one in use. Below FOUND_SIGMA the search ends.
KNOWN_SIGMA = 0.1
MUCH_SURER = 0.7
FOUND_SIGMA = 0.012


@dataclass(frozen=True, slots=True)
class FocalEstimate:
    """A focal length and its uncertainty."""

    size: Size
    focal_px: float
    sigma_px: float  # standard deviation, systematic errors included
    views: int

    @property
    def relative_sigma(self) -> float:
        return self.sigma_px / self.focal_px

    def camera(self) -> Camera:
        return Camera.from_focal(self.size, self.focal_px, "estimated", self.sigma_px)


@dataclass(frozen=True, slots=True)
class _View:
    corners_px: Float  # (4, 2)
    R: Float  # (3, 3) camera from marker
    # What views are compared by, as plain numbers: every frame is compared with all views that are kept.
    middle_px: tuple[float, float]
    diagonal_px: float
    normal: tuple[float, float, float]

    @classmethod
    def of(cls, corners_px: Float, R: Float) -> "_View":
        x, y = corners_px.mean(axis=0).tolist()
        a, b, c = R[:, 2].tolist()
        return cls(corners_px, R, (x, y), math.dist(corners_px[0], corners_px[2]), (a, b, c))

    def distance(self, other: "_View") -> float:
        moved = math.dist(self.middle_px, other.middle_px) / max(self.diagonal_px, other.diagonal_px)
        resized = abs(math.log(self.diagonal_px / other.diagonal_px))
        # Of the normals: a turn within the marker's own plane adds no information.
        (a, b, c), (d, e, f) = self.normal, other.normal
        turned = math.acos(min(max(a * d + b * e + c * f, -1.0), 1.0))
        return math.hypot(moved / PLACE_SCALE, resized / SIZE_SCALE, turned / TURN_SCALE_RAD)


class FocalEstimator:
    """Collects views of one marker that differ from each other, and fits the focal length to them from time to time."""

    def __init__(self, size: Size) -> None:
        self.estimate: FocalEstimate | None = None  # of the last fit, however uncertain
        self._size = size
        self._views: list[_View] = []
        self._spacing = 1.0
        self._seen = 0  # different views, including those dropped since
        self._next_fit = MIN_VIEWS

    def add(self, tracked: TrackedFrame) -> FocalEstimate | None:
        """Takes what a frame showed; a new estimate when this led to one. Raises ValueError for another size."""
        if tracked.frame.size != self._size:
            raise ValueError(f"a frame of {tracked.frame.size} among frames of {self._size}")
        marker = tracked.marker
        if marker is None or marker.bridged or not _is_measured(marker, tracked.camera):
            return None
        view = _View.of(marker.corners_px, marker.measured_T_cam_marker[:3, :3])
        if any(self._are_near(view, kept) for kept in self._views):
            return None
        self._views.append(view)
        self._seen += 1
        if len(self._views) > MOST_VIEWS:
            self._thin_out()
        if self._seen < self._next_fit:
            return None
        self._next_fit = math.ceil(GROWTH * self._seen)
        self.estimate = self._fitted(tracked.camera)
        return self.estimate

    def _thin_out(self) -> None:
        while len(self._views) > 0.75 * MOST_VIEWS:
            self._spacing *= THINNING
            self._views = distinct(self._views, self._are_near)

    def _are_near(self, view: _View, other: _View) -> bool:
        return view.distance(other) < self._spacing

    def _fitted(self, camera: Camera) -> FocalEstimate | None:
        corners = np.array([view.corners_px for view in self._views])
        rotations = np.array([view.R for view in self._views])
        fit = fit_focal(corners, rotations, float(camera.K[0, 0]), self._size)
        if not (math.isfinite(fit.focal_px) and math.isfinite(fit.relative_sigma)):
            return None
        sigma = math.hypot(CAUTION * fit.relative_sigma, SYSTEMATIC) * fit.focal_px
        return FocalEstimate(self._size, fit.focal_px, sigma, len(self._views))


def _is_measured(marker: MarkerPose, camera: Camera) -> bool:
    """False if the corners follow from the pose, as for a marker half outside the picture, or one of several."""
    predicted_px = source_from_ideal(
        camera, project(camera, marker.measured_T_cam_marker, square_corners(marker.side_m))
    )
    return bool(np.abs(predicted_px - marker.corners_px).max() > LEAST_RESIDUAL_PX)
