"""Systematic errors of a square's corners, beside the noise of its edges: pixels, curled paper, the camera's tones.

"Bleeding": a camera whose tone curve is not sRGB's, or that clips white, displaces all edges alike, towards black or
towards white. The edges inside the print are displaced as well, and so measure it (`PrintAlignment.bleed_px`).
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.tracking.edges.edge_lines import BEFORE, NEXT
from ashe_live.tracking.edges.squares import FittedSquare

# A bleed measured below this is noise.
LEAST_BLEED_PX = 0.03
# Noise alone gives a side a sagitta of about this.
BOW_NOISE_PX = 0.1


@dataclass(frozen=True, slots=True)
class CornerErrors:
    """Standard deviations, fitted by `ashe-live bench track --scenes` to path-traced pictures with known poses."""

    end_px: float  # of each end of a side, in every picture: assumed for printers and pixels, not fitted
    correlated: float  # of each end, as a multiple of FittedSquare.correlated_px
    curl: float  # of each end, as a multiple of the largest sagitta of a side, beyond BOW_NOISE_PX
    bleed_share: float  # displacement of the outer edges over the bleed measured inside
    bleed_px: float  # of the displacement that remains after correction, where the bleed is large
    bleed_half_px: float  # the bleed at which half of `bleed_px` remains
    weight: float  # of these errors as a prior for the scale of the pose's residuals, in degrees of freedom


FITTED = CornerErrors(
    end_px=0.012, correlated=1.8, curl=0.49, bleed_share=0.68, bleed_px=0.117, bleed_half_px=0.142, weight=1.87
)


def corrected(square: FittedSquare, bleed_px: float | None, errors: CornerErrors = FITTED) -> FittedSquare:
    """`square` with its sides moved back inwards by the bleed that the inside has measured."""
    moved_px = _moved_px(bleed_px, errors)
    corners = square.corners_px - moved_px * _outwards(square.corners_px) if moved_px else square.corners_px
    return replace(square, corners_px=corners, bleed_px=bleed_px)


def grown(square: FittedSquare, by_px: float) -> FittedSquare:
    """`square` with its sides moved outwards."""
    return replace(square, corners_px=square.corners_px + by_px * _outwards(square.corners_px))


def uncorrected_px(square: FittedSquare) -> Float:
    """(4, 2) the corners where `corrected` found them."""
    moved_px = _moved_px(square.bleed_px, FITTED)
    return np.asarray(square.corners_px + moved_px * _outwards(square.corners_px)) if moved_px else square.corners_px


def _moved_px(bleed_px: float | None, errors: CornerErrors) -> float:
    """How far the sides are displaced outwards, for a measured bleed."""
    if bleed_px is None:
        return 0.0
    return errors.bleed_share * math.copysign(max(abs(bleed_px) - LEAST_BLEED_PX, 0.0), bleed_px)


def systematic(square: FittedSquare, errors: CornerErrors = FITTED) -> Float:
    """(8, 8) covariance of corners_px.ravel(), px^2, without noise; zero where edges were not measured."""
    if square.bows is None:
        return np.zeros((8, 8))
    by_normals = np.linalg.inv(_normals(square.corners_px))
    sides = square.corners_px[NEXT] - square.corners_px
    sagitta_px = float((square.bows * np.hypot(sides[:, 0], sides[:, 1])).max())
    curl_px2 = errors.curl**2 * max(sagitta_px**2 - BOW_NOISE_PX**2, 0.0)
    covariance = np.zeros((4, 2, 4, 2))
    corner = np.arange(4)
    end_px2 = errors.end_px**2 + (errors.correlated * square.correlated_px) ** 2
    covariance[corner, :, corner, :] = (end_px2 + curl_px2) * (by_normals @ by_normals.transpose(0, 2, 1))
    bleed_px = math.inf if square.bleed_px is None else abs(square.bleed_px)
    share = 1.0 if math.isinf(bleed_px) else bleed_px / (bleed_px + errors.bleed_half_px)
    together = (errors.bleed_px * share) * by_normals.sum(axis=2).ravel()
    return np.asarray(covariance.reshape(8, 8) + np.outer(together, together))


def _normals(corners_px: Float) -> Float:
    """(4, 2, 2) at each corner the outward normals of the side that begins and of the side that ends there."""
    sides = corners_px[NEXT] - corners_px
    outwards = np.column_stack([sides[:, 1], -sides[:, 0]]) / np.hypot(sides[:, 0], sides[:, 1])[:, None]
    return np.stack([outwards, outwards[BEFORE]], axis=1)


def _outwards(corners_px: Float) -> Float:
    """(4, 2) how corners move when each side moves outwards by one."""
    return np.asarray(np.linalg.inv(_normals(corners_px)).sum(axis=2))
