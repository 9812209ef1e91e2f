"""Broad areas in the colours of joints: between planks and tiles the ground is as dark as in a pale shadow.

A palette that has the colour of joints explains a shadow of that colour as lit ground. But joints are narrow: where
their colours fill an area that is broader, in metres, than anywhere else, and that touches an unlit area, it is rather
the shadow of what stands there. How far the pixels of an area are from its border is their reach: in pixels of the
picture, or in those that they would be at the marker's distance, which are proportional to metres.
"""

from collections.abc import Iterator
from dataclasses import replace

import cv2
import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float32, Mask
from ashe_live.core.transforms import image_from_plane
from ashe_live.light.ground.lit_ground import SPECK_SHARE, UNLIT_DISTANCE, BroadAreas, LitGround, unlit_mask
from ashe_live.light.pixels.areas import areas_by_size, distance_to, grown, majority, thick
from ashe_live.light.pixels.mixtures import Mixture, nearest_centres
from ashe_live.light.pixels.view import View

DARKER = 0.15  # log brightness below the palette's mean: joints are at least so much darker
# Ground nearer than this, as a share of the picture's width, to an unlit area may be in shadow. The rest, which must be
# this share of the picture, shows how broad joints are.
BESIDE, LEAST_ELSEWHERE = 0.06, 0.1
# An area is broad where its reach is this many times that of joints elsewhere, at this percentile of the pixels in
# their middle; and where it is at least so many pixels of the picture.
BROADER, PERCENTILE, LEAST_REACH_PX = 1.3, 99.5, 2.0
LEAST_JOINTS, JOINT_REACH = 6, 1.0  # pixels in the middle of joints; their reach where there are fewer
MIXED_PX = 3  # across a joint, beside twice its reach: its middle pixel, and a mixed one on either side
FARTHEST = 50.0  # of the ground, over the marker's distance: beyond, near the horizon, lengths grow no more
LEAST_SHARE = 0.002  # of the picture: smaller areas are knots and stains
TOUCHING_PX, TOUCHING_SHARE, TOUCHING_LEAST_PX = 4, 0.02, 3  # how much of an area is near an unlit one, at least


def with_broad_areas(ground: LitGround, view: View) -> LitGround:
    """The ground with the areas that only colours of its joints explain, and that are too broad for joints.

    view: the one that `ground` was fitted to.
    """
    unlit = unlit_mask(ground, view.is_ground, round(SPECK_SHARE * view.is_ground.size))
    lit = view.is_ground & ~unlit & (ground.squared_distance <= UNLIT_DISTANCE)
    elsewhere = lit & ~grown(unlit, round(BESIDE * view.size[0]))
    if np.count_nonzero(elsewhere) < LEAST_ELSEWHERE * elsewhere.size:
        return ground
    near, distance = grown(unlit, TOUCHING_PX), _relative_distance(view)
    centres = ground.palette.centres
    colours = nearest_centres(ground.colours.reshape(-1, 3), centres).reshape(unlit.shape)
    found, of_joints = np.zeros_like(unlit), np.zeros(len(centres), np.bool_)
    for dark in _darkest(ground.palette):
        new = _broad(majority(lit & dark[colours]), elsewhere, near, distance)
        if new.any():
            found, of_joints = found | new, dark
    found &= view.is_ground
    if not found.any():
        return ground
    return replace(ground, broad=BroadAreas(found, ground.palette.only(~of_joints)))


def _darkest(palette: Mixture) -> Iterator[NDArray[np.bool_]]:
    """(k,) the palette's colours that are darker than its mean: the darkest, the two darkest, and so on."""
    brightness = palette.centres[:, 0]
    limit = float(np.average(brightness, weights=palette.weights)) - DARKER
    for threshold in np.sort(brightness)[:-1]:
        if threshold > limit:
            return
        yield brightness <= threshold


def _relative_distance(view: View) -> Float32:
    """(h, w) depth of the ground at each pixel over the marker's distance, by which lengths are scaled."""
    height, width = view.is_ground.shape
    plane_from_image = np.linalg.inv(image_from_plane(view.camera, view.T_cam_marker))
    columns, rows = np.arange(width), np.arange(height)
    inverse_depth = plane_from_image[2, 0] * columns + (plane_from_image[2, 1] * rows + plane_from_image[2, 2])[:, None]
    away = float(np.linalg.norm(view.T_cam_marker[:3, 3]))
    return np.asarray(1 / np.maximum(inverse_depth * away, 1 / FARTHEST), dtype=np.float32)


def _broad(dark: Mask, elsewhere: Mask, near: Mask, distance: Float32) -> Mask:
    """(h, w) the areas of `dark` that touch what is `near`, and are broader than nearly all of it `elsewhere`.

    distance: (h, w) as by `_relative_distance`.
    """
    reach_px = distance_to(~dark)
    reach = reach_px * distance
    ridge = dark & elsewhere & (reach >= cv2.dilate(reach, np.ones((3, 3), np.uint8)))
    joints = reach[ridge]
    widest = float(np.percentile(joints, PERCENTILE)) if len(joints) >= LEAST_JOINTS else JOINT_REACH
    core = (reach > BROADER * widest) & (reach_px >= LEAST_REACH_PX)
    if not core.any():
        return core
    # Without the joints that end at it.
    across_px = 2 * round(widest / float(np.median(distance[core]))) + MIXED_PX
    several = areas_by_size(thick(dark, across_px), round(LEAST_SHARE * dark.size))
    broad = np.zeros_like(dark)
    for area in several:
        beside = np.count_nonzero(area & near)
        if (area & core).any() and beside > TOUCHING_SHARE * np.count_nonzero(area) + TOUCHING_LEAST_PX:
            broad |= area
    return broad
