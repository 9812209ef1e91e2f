"""How high the marker lies above the ground, as several views show it: it may be printed on card, or lie on a board.

What lies in a plane is seen by every camera where that plane's homography takes it (plane plus parallax: Irani and
Anandan, 1996). The ground around the sheet agrees best between views for the plane that it really lies in
(docs/maths, "The ground's height").
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import cv2
import numpy as np

from ashe_live.core.arrays import SIGMA_OVER_MAD, Float, Float32, lowest_on_parabola
from ashe_live.core.light import Illumination
from ashe_live.core.transforms import inverse_rigid, pixels_by_pose, raycast_to_plane, rigid
from ashe_live.core.types import TrackedFrame
from ashe_live.light.pixels.log_colour import log_opponent
from ashe_live.light.pixels.view import View, plane_homography
from ashe_live.light.views.moved_frame import moved_body, moved_light, with_moved_marker

COMPARED = 3  # number of other views
WIDTH_PX = 320  # of the pictures compared
# The greatest height that is looked for, in sides of the marker: card, a board or a tablet. On something higher the
# object may stand as well.
HIGHEST = 0.12
STEP_PX = 0.5  # by which the ground moves in the other view from one height that is tried to the next
# Poses, lenses and sharpening misplace whole pictures by less than this; no lower height can be measured.
LEAST_PX = 0.4
LEAST_LOG_ODDS = 10.0  # of a height, to pay for sheets that lie flat, and for those tried
PIXELS_PER_SAMPLE = 40.0  # pixels over their effective sample size, as neighbours are blurred alike
LEAST_PIXELS = 2000  # of ground that both views show
FINEST_PX, COARSEST_PX = 0.8, 4.0  # standard deviations of the blurs between which texture is compared
DARKEST = -4.0  # log brightness: below it is noise
LEAST_NOISE = 0.01  # of log brightness


def height_above_ground(several: Sequence[TrackedFrame]) -> float:
    """Metres by which the marker's plane lies above the ground's; 0 where the views show no other height for sure.

    several: frames of one scene with a marker, first the one that the others are compared with.
    """
    if len(several) < 2:
        return 0.0
    first, *others = (_Textured.of(View.of(each, WIDTH_PX)) for each in several[: 1 + COMPARED])
    moves = [_moved_px_per_metre(first, other) for other in others]
    highest = HIGHEST * first.view.side_m
    widest = int(np.argmax(moves))
    if moves[widest] * highest < LEAST_PX:
        return 0.0
    step = STEP_PX / moves[widest]
    tried = np.arange(0.0, highest + step, step)
    best = int(np.argmin(_misfits(first, others[widest], tried)))
    if best == 0:
        return 0.0
    around = tried[best] + step * np.array([-0.5, 0.0, 0.5])
    by_pair = np.array([_misfits(first, other, np.append(around, 0.0)) for other in others])
    below, here, above, flat = by_pair.sum(axis=0)
    # The best height in one pair need not be the best in all, so that the parabola's bottom may lie elsewhere.
    height = lowest_on_parabola(around, np.array([below, here, above]))
    surely = flat - here > LEAST_LOG_ODDS and bool((by_pair[:, 1] <= by_pair[:, 3]).all())
    least_px = max(LEAST_PX, math.hypot(_misplaced_px(first), _misplaced_px(others[widest])))
    return height if surely and moves[widest] * height > least_px else 0.0


@dataclass(frozen=True, slots=True, eq=False)
class _Textured:
    """A view and its texture: log brightness without exposure, shading and noise."""

    view: View
    texture: Float32  # (h, w)

    @staticmethod
    def of(view: View) -> "_Textured":
        brightness = np.maximum(log_opponent(view.image_bgr)[..., 0], DARKEST)
        fine, coarse = (cv2.GaussianBlur(brightness, (0, 0), sigma) for sigma in (FINEST_PX, COARSEST_PX))
        return _Textured(view, np.asarray(fine - coarse, dtype=np.float32))


def _moved_px_per_metre(one: _Textured, other: _Textured) -> float:
    """By how many pixels, root mean square, the other view shows the ground elsewhere, for each metre it is lower.

    Of the ground that is in its picture at either height: beyond, towards the horizon, any height moves it by any way.
    """
    height = HIGHEST * one.view.side_m
    rows, columns = np.nonzero(one.view.is_ground[::8, ::8])
    pixels = np.stack([8.0 * columns, 8.0 * rows, np.ones(len(rows))])
    if not pixels.size:
        return 0.0
    projected = np.stack([_homography(one.view, other.view, each) @ pixels for each in (0.0, height)])
    projected = projected[:, :, (projected[:, 2] > 0).all(axis=0)]
    there = projected[:, :2] / projected[:, 2:]
    inside = ((there >= 0) & (there < np.array(other.view.size)[:, None])).all(axis=(0, 1))
    if not inside.any():
        return 0.0
    moved = (there[1] - there[0])[:, inside]
    return float(np.sqrt((moved**2).sum(axis=0).mean())) / height


def _misplaced_px(one: _Textured) -> float:
    """Standard deviation of the place of ground in the picture, root mean square, by the pose; 0 for an exact pose."""
    view = one.view
    covariance = view.pose_covariance
    rows, columns = np.nonzero(view.is_ground[::8, ::8])
    if covariance is None or not len(rows):
        return 0.0
    ground = raycast_to_plane(view.camera, view.T_cam_marker, np.column_stack([8.0 * columns, 8.0 * rows]))
    turned = ground[:, :2] @ view.T_cam_marker[:3, :2].T
    by_pose = pixels_by_pose(turned, turned + view.T_cam_marker[:3, 3], view.camera.K)
    return float(np.sqrt(np.einsum("nij,jk,nik->n", by_pose, covariance, by_pose).mean()))


def _misfits(one: _Textured, other: _Textured, heights_m: Float) -> Float:
    """(n,) minus the log likelihoods of n heights by one pair of views, but for a constant; 0 if they show too little.

    The differences are Cauchy distributed, as what stands on the ground shears; their scale is that of the best height.
    """
    flags = cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP
    differences, both = [], one.view.is_ground.copy()
    for height in heights_m:
        H = _homography(one.view, other.view, float(height))
        there = cv2.warpPerspective(other.texture, H, one.view.size, flags=flags)
        seen = cv2.warpPerspective(other.view.is_ground.astype(np.uint8), H, one.view.size, flags=flags)
        both &= seen > 0
        differences.append(one.texture - there)
    if np.count_nonzero(both) < LEAST_PIXELS:
        return np.zeros(len(heights_m))
    away = np.abs(np.array([each[both] for each in differences]))
    scale = 2 * max(SIGMA_OVER_MAD * float(np.median(away, axis=1).min()), LEAST_NOISE)
    return np.asarray(np.log1p((away / scale) ** 2).sum(axis=1, dtype=np.float64) / PIXELS_PER_SAMPLE)


def _homography(one: View, other: View, height_m: float) -> Float:
    """(3, 3) from the pixels of one view to another's, through the plane that lies so far below the marker's."""
    T_marker_ground = inverse_rigid(_above_ground(height_m))
    return plane_homography(*(replace(each, T_cam_marker=each.T_cam_marker @ T_marker_ground) for each in (one, other)))


def seen_from_ground(tracked: TrackedFrame, height_m: float) -> TrackedFrame:
    """The frame with the ground below the marker's centre in the marker's place, that far below it."""
    return tracked if tracked.marker is None else with_moved_marker(tracked, _above_ground(height_m))


def seen_from_marker(illumination: Illumination, height_m: float) -> Illumination:
    """What was found in the ground's frame, in the marker's, that far above it: body and lamps are lower there."""
    T_marker_ground, body = inverse_rigid(_above_ground(height_m)), illumination.real_object
    return replace(
        illumination,
        lights=tuple(moved_light(light, T_marker_ground) for light in illumination.lights),
        real_object=body and moved_body(body, T_marker_ground),
    )


def _above_ground(height_m: float) -> Float:
    """(4, 4) from the marker's frame to that of the ground so far below its centre."""
    return rigid(np.eye(3), [0.0, 0.0, height_m])
