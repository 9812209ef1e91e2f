"""How large the light looks: a shadow's edge is the wider, the farther it falls from what casts it."""

import math

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Mask
from ashe_live.core.proxy import Proxy
from ashe_live.core.transforms import project, tangent_basis
from ashe_live.light.areas import grown
from ashe_live.light.log_colour import Float32
from ashe_live.light.predicted import Predicted
from ashe_live.light.view import View

REACH_PX = 11.0  # on either side of the edge
STEP_PX = 0.5
END_SAMPLES = 6  # that tell how deep it is inside and outside
LEAST_DEPTH = 0.6  # shares of the shift between the two, in an edge worth measuring
APART_M = 0.004
BESIDE_OBJECT_PX = 2
FEWEST_EDGES = 12
# The penumbra's part of the widest edges' variance, over the blur's, below which it cannot be told from blur.
VISIBLE = 0.5
SURELY = 3.0  # its standard errors
CORRELATED = 6.0  # neighbouring places on an edge: so many tell what one would
LARGEST_RAD = math.radians(20)
ROBUST_ROUNDS = 6


def angular_size(proxy: Proxy, to_light_marker: Float, share: Float32, masks: Predicted, view: View) -> float | None:
    """The light's angular diameter (rad); None where its penumbra cannot be told from the picture's own blur.

    share: (h, w) of the shadow's shift that each pixel of `view` shows. A disc of diameter d spreads the edge cast from
    height z by z |J'n| d / 4 (standard deviation, across the edge n; J: the displacement s by the direction), beside
    which the picture's blur is the same everywhere: a straight line in the squares (docs/maths.md, "Penumbra").
    """
    spreads, variances = _edges(proxy, to_light_marker, share, masks, view)
    if len(spreads) < FEWEST_EDGES:
        return None
    design = np.column_stack([np.ones(len(spreads)), spreads**2])
    weights = np.ones(len(spreads))
    blur, squared, scale = 0.0, 0.0, 1.0
    for _ in range(ROBUST_ROUNDS):
        (blur, squared), *_ = np.linalg.lstsq(design * weights[:, None], variances * weights, rcond=None)
        rest = variances - design @ np.array([blur, squared])
        scale = 1.48 * float(np.median(np.abs(rest))) + 1e-3
        weights = 1 / np.sqrt(1 + (rest / (2 * scale)) ** 2)
    information = (design * weights[:, None]).T @ (design * weights[:, None])
    error = scale * math.sqrt(CORRELATED * float(np.linalg.inv(information)[1, 1]))
    if squared <= SURELY * error or squared * np.percentile(spreads, 90) ** 2 < VISIBLE * max(blur, 0.25):
        return None
    size = math.sqrt(squared)
    return size if size < LARGEST_RAD else None


def _edges(proxy: Proxy, to_light_marker: Float, share: Float32, masks: Predicted, view: View) -> tuple[Float, Float]:
    """(n,) pixels by which a light of 1 rad would spread each place of the shadow's edge, and its variance (px^2)."""
    points = proxy.points_marker()
    slant = to_light_marker[:2] / to_light_marker[2]
    cast = points[:, :2] - points[:, 2:] * slant
    rim = cv2.convexHull(cast.astype(np.float32), returnPoints=False)[:, 0]
    corners, heights = cast[rim], points[rim, 2]
    by_direction = np.linalg.inv(tangent_basis(to_light_marker)[:, :2] / math.hypot(*slant, 1.0))
    clear = view.is_ground & ~grown(masks.body, BESIDE_OBJECT_PX)
    offsets = np.arange(-REACH_PX, REACH_PX + STEP_PX / 2, STEP_PX)
    centre = corners.mean(axis=0)
    spreads, variances = [], []
    for start, end, low, high in zip(corners, np.roll(corners, -1, axis=0), heights, np.roll(heights, -1), strict=True):
        along = end - start
        length = math.hypot(*along)
        if length < 1e-9:
            continue
        outward = np.array([along[1], -along[0]]) / length
        outward *= np.sign(outward @ (0.5 * (start + end) - centre)) or 1.0
        count = max(1, min(int(length / APART_M), 50))
        for part in (np.arange(count) + 0.5) / count:
            place = start + part * along
            step = 1e-3 * outward
            pixels = project(view.camera, view.T_cam_marker, np.array([[*place, 0.0], [*(place + step), 0.0]]))
            across = pixels[1] - pixels[0]
            scale = math.hypot(*across)
            if not (math.isfinite(scale) and scale > 1e-6):
                continue
            variance = _variance(share, clear, pixels[0] + offsets[:, None] * (across / scale), offsets)
            if variance is not None:
                height = low + part * (high - low)
                spreads.append(height * float(np.linalg.norm(by_direction.T @ outward)) / 4 * scale / 1e-3)
                variances.append(variance)
    return np.array(spreads), np.array(variances)


def _variance(share: Float32, clear: Mask, line_px: Float, offsets: Float) -> float | None:
    """Variance (px^2) of the step from shadow to light along a line from within; None where there is no clear step."""
    height, width = share.shape
    nearest = np.rint(line_px).astype(int)
    if nearest.min() < 1 or nearest[:, 0].max() > width - 2 or nearest[:, 1].max() > height - 2:
        return None
    if not clear[nearest[:, 1], nearest[:, 0]].all():
        return None
    x, y = line_px.astype(np.float32).T
    profile = cv2.remap(share, x[None], y[None], cv2.INTER_LINEAR)[0]
    inside, outside = float(np.median(profile[:END_SAMPLES])), float(np.median(profile[-END_SAMPLES:]))
    if inside - outside < LEAST_DEPTH:
        return None
    lost = np.maximum(-np.diff(np.clip((profile - outside) / (inside - outside), 0, 1)), 0.0)
    middles = 0.5 * (offsets[1:] + offsets[:-1])
    lost /= max(float(lost.sum()), 1e-9)
    mean = float(lost @ middles)
    return float(lost @ (middles - mean) ** 2)
