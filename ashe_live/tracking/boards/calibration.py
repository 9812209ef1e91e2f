"""Calibrates a camera by views of a flat board: K, distortion and their uncertainties; refuses insufficient views.

Zhang, "A flexible new technique for camera calibration", PAMI 2000, by OpenCV. Beyond that, the lens model is the
simplest that explains the views, views that contradict the others are left out, and uncertainties come from a grouped
jackknife: OpenCV's own formula assumes a perfectly flat board and independent errors.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import compress
from typing import Any

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Mask, set_frozen
from ashe_live.core.camera import Camera, Size
from ashe_live.errors import UserError
from ashe_live.tracking.boards.calibration_board import BoardView

# OpenCV's flags for lenses, simplest first: none, k1, k2, tangential, k3, rational.
NO_TANGENT = cv2.CALIB_ZERO_TANGENT_DIST
LENSES = (
    NO_TANGENT | cv2.CALIB_FIX_K1 | cv2.CALIB_FIX_K2 | cv2.CALIB_FIX_K3,
    NO_TANGENT | cv2.CALIB_FIX_K2 | cv2.CALIB_FIX_K3,
    NO_TANGENT | cv2.CALIB_FIX_K3,
    cv2.CALIB_FIX_K3,
    0,
    cv2.CALIB_RATIONAL_MODEL,
)
# A richer lens model must reduce the error by this factor. With a smaller gain it fits the noise, and distorts the
# parts of the picture that no view covers.
NEARLY = 1.05
MIN_VIEWS = 8
# A view contradicts the others if its error exceeds both this multiple of the median and this many pixels.
OUTLIER_RATIO = 2.5
OUTLIER_PX = 0.25
JACKKNIFE_GROUPS = 10
# Shares of the focal length. SYSTEMATIC: an uncertainty that no number of views reduces, as a print is never quite
# square and flat. A calibration is refused above the others: the sigma of the focal length, and that of the principal
# point (which matters as an angle of the camera).
SYSTEMATIC = 0.002
MAX_SIGMA_F = 0.01
MAX_SIGMA_C = 0.015
# Largest RMS over the picture's width, and at least a pixel: a larger one is not noise but a bent board.
MAX_RMS = 0.0015


@dataclass(frozen=True, slots=True)
class CameraCalibration:
    """A camera and its uncertainty."""

    camera: Camera
    rms_px: float  # of all corners of the views used
    sigma_f_px: Float  # (2,) of fx and fy
    sigma_c_px: Float  # (2,) of cx and cy
    sigma_dist: Float  # (5 or 8,) of the coefficients
    view_rms_px: Float  # (n,) of every view given, also those left out
    used: Mask  # (n,) views that were not outliers

    def __post_init__(self) -> None:
        for name in ("sigma_f_px", "sigma_c_px", "sigma_dist", "view_rms_px", "used"):
            value = np.array(getattr(self, name))
            value.flags.writeable = False
            set_frozen(self, **{name: value})

    def to_json(self) -> dict[str, Any]:
        """The content of a camera file, with further figures for people to read."""
        return {
            "size": list(self.camera.size),
            "K": self.camera.K.tolist(),
            "dist": self.camera.dist.tolist(),
            "rms_px": self.rms_px,
            "sigma": {
                "f_px": self.sigma_f_px.tolist(),
                "c_px": self.sigma_c_px.tolist(),
                "dist": self.sigma_dist.tolist(),
            },
            "views": [
                {"rms_px": float(rms), "used": bool(used)}
                for rms, used in zip(self.view_rms_px, self.used, strict=True)
            ],
        }


@dataclass(frozen=True, slots=True)
class _Fit:
    rms_px: float
    K: Float  # (3, 3)
    dist: Float  # (5 or 8,)
    sigma: Float  # (9 or 12,) of fx, fy, cx, cy and the coefficients
    view_rms_px: Float  # (n,)

    @property
    def parameters(self) -> Float:
        return np.concatenate([self.K[(0, 1, 0, 1), (0, 1, 2, 2)], self.dist])


def calibrate(views: Sequence[BoardView], size: Size) -> CameraCalibration:
    """The camera that took `views` in pictures of `size`.

    Raises UserError, with what is missing, when they do not determine it.
    """
    if len(views) < MIN_VIEWS:
        raise UserError(
            f"the board was seen in too few different views ({len(views)})",
            f"show it in at least {MIN_VIEWS} places, tilted to every side",
        )
    used, fit, flags = _without_outliers(views, size)
    chosen = list(compress(views, used))
    sigma = np.maximum(fit.sigma, _jackknife(chosen, size, fit, flags))
    sigma[:4] = np.hypot(sigma[:4], SYSTEMATIC * fit.K[0, 0])
    _refuse_unknown(fit, sigma, size)
    camera = Camera(size, fit.K, fit.dist, "file")
    errors = np.array([_view_rms(view, camera) for view in views])
    return CameraCalibration(
        camera=camera,
        rms_px=fit.rms_px,
        sigma_f_px=sigma[:2],
        sigma_c_px=sigma[2:4],
        sigma_dist=sigma[4:],
        view_rms_px=errors,
        used=used,
    )


def _without_outliers(views: Sequence[BoardView], size: Size) -> tuple[Mask, _Fit, int]:
    """Which views agree, what they say together, and the lens model that was best for them."""
    used = np.ones(len(views), dtype=bool)
    while True:
        chosen = list(compress(views, used))
        fit, flags = _best_lens(chosen, size)
        bound = max(OUTLIER_RATIO * float(np.median(fit.view_rms_px)), OUTLIER_PX)
        worst = int(fit.view_rms_px.argmax())
        if fit.view_rms_px[worst] <= bound or len(chosen) <= MIN_VIEWS:
            return used, fit, flags
        # One at a time: the worst one spoils the others' errors.
        used[np.flatnonzero(used)[worst]] = False


def _best_lens(views: Sequence[BoardView], size: Size) -> tuple[_Fit, int]:
    """The simplest one that explains the views nearly as well as any other."""
    fits = [(fit, flags) for flags in LENSES if (fit := _fitted(views, size, flags)) is not None]
    if not fits:
        raise UserError("the views do not determine a camera", "show the board tilted to every side, and larger")
    least_px = min(fit.rms_px for fit, _ in fits)
    return next((fit, flags) for fit, flags in fits if fit.rms_px <= NEARLY * least_px)


def _fitted(views: Sequence[BoardView], size: Size, flags: int) -> _Fit | None:
    """The camera with the coefficients that `flags` leave free, as OpenCV fits it; None where the views give none."""
    points = [view.points.astype(np.float32)[:, None] for view in views]
    corners = [view.corners_px.astype(np.float32)[:, None] for view in views]
    try:
        rms, K, dist, _, _, sigma, _, view_rms = cv2.calibrateCameraExtended(
            points, corners, size, np.eye(3), np.zeros(14), flags=flags
        )
    except cv2.error:
        return None
    coefficients = np.asarray(dist, dtype=np.float64).ravel()[: 8 if flags & cv2.CALIB_RATIONAL_MODEL else 5]
    values = np.concatenate([K.ravel(), coefficients, [rms]])
    if not np.isfinite(values).all() or min(K[0, 0], K[1, 1]) <= 0:
        return None
    # Not a number: a coefficient that another one can undo.
    stated = np.nan_to_num(np.asarray(sigma, dtype=np.float64).ravel()[: 4 + len(coefficients)], nan=0.0)
    return _Fit(
        float(rms),
        np.asarray(K, dtype=np.float64),
        coefficients,
        stated,
        np.asarray(view_rms, dtype=np.float64).ravel(),
    )


def _jackknife(views: Sequence[BoardView], size: Size, fit: _Fit, flags: int) -> Float:
    """Standard deviations of `fit.parameters` from leaving out one group of views after another."""
    groups = min(JACKKNIFE_GROUPS, len(views))
    found = []
    for group in range(groups):
        others = [view for at, view in enumerate(views) if at % groups != group]
        part = _fitted(others, size, flags)
        if part is None:
            return np.full(len(fit.sigma), math.inf)
        found.append(part.parameters)
    spread = np.array(found) - np.mean(found, axis=0)
    return np.asarray(np.sqrt((groups - 1) / groups * (spread**2).sum(axis=0)))


def _refuse_unknown(fit: _Fit, sigma: Float, size: Size) -> None:
    part_f = float(max(sigma[0] / fit.K[0, 0], sigma[1] / fit.K[1, 1]))
    axis_rad = float(max(sigma[2:4]) / fit.K[0, 0])
    if not part_f <= MAX_SIGMA_F:
        raise UserError(
            f"the views leave the focal length uncertain by {_percent(part_f)}",
            "tilt the board more, by 30 to 45 degrees to every side, and bring it nearer",
        )
    if not axis_rad <= MAX_SIGMA_C:
        raise UserError(
            f"the views leave the principal point uncertain by {math.degrees(axis_rad):.1f} degrees",
            "tilt the board to every side, and show it in every corner of the picture",
        )
    if fit.rms_px > max(1.0, MAX_RMS * size[0]):
        raise UserError(
            f"the board's corners are {fit.rms_px:.1f} px off any camera's",
            "fix the board on something flat, hold still",
        )


def _percent(part: float) -> str:
    return f"{100 * part:.1f} %" if part < 1 else "more than all of it"


def _view_rms(view: BoardView, camera: Camera) -> float:
    """RMS error of the corners, in pixels, at the pose that explains this view best."""
    _, rvec, tvec = cv2.solvePnP(view.points, view.corners_px, camera.K, camera.dist)
    projected, _ = cv2.projectPoints(view.points, rvec, tvec, camera.K, camera.dist)
    return math.sqrt(float(((projected.reshape(-1, 2) - view.corners_px) ** 2).sum(axis=1).mean()))
