"""Estimator `paper`: the method of the AShE paper as published, kept as the baseline.

Source: "A Shadow Estimator for Augmented Reality Systems on Mobile Platforms" (AShE). Its steps are the functions of
`masks` and `geometry`; here they are called in the paper's order. It gives no uncertainty or confidence.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Mask
from ashe_live.core.camera import Camera, Size
from ashe_live.core.light import Illumination, Light, LightEstimate, StageClock
from ashe_live.core.square import square_corners
from ashe_live.core.transforms import undistorted
from ashe_live.core.types import MarkerPose, TrackedFrame
from ashe_live.light.paper import geometry, masks
from ashe_live.light.paper.shadow_colour import shadow_rgb_ratio

SHEET_OVER_MARKER = 1.4  # the printed sheet with its white margin, over the black square's side
SMALLEST_SHARE = 0.001  # fraction of the picture; smaller regions are specks
LEAST_SIDE_PX = 16  # at the working size: a narrower picture holds no object beside its shadow


@dataclass(frozen=True, slots=True)
class PaperEstimator:
    """AShE from one frame; see Estimator."""

    size: Size = (640, 480)  # at which it works, as published
    grabcut_iterations: int = 25  # as published

    @property
    def name(self) -> str:
        return "paper"

    def estimate(
        self,
        tracked: TrackedFrame,
        others: Sequence[TrackedFrame] = (),  # noqa: ARG002 - as published, it answers from one frame
    ) -> LightEstimate:
        """The paper's estimate; no lights and a reason if a step finds nothing or the light is not above the ground.

        others: left out, as the method is one for a single frame. Raises ValueError when the frame has no marker.
        """
        if tracked.marker is None:
            raise ValueError("an estimate needs a frame with a marker")
        clock = StageClock()
        found = self._found(tracked, tracked.marker, clock)
        lit = Illumination(() if found.light is None else (found.light,))
        masks_found = found.object_mask, found.shadow_mask
        return LightEstimate(self.name, tracked.frame.index, lit, found.reason, *masks_found, clock.timing_ms())

    def _found(self, tracked: TrackedFrame, marker: MarkerPose, clock: StageClock) -> "_Found":
        """The steps in the paper's order, up to the first that finds nothing."""
        size = masks.working_size(tracked.frame.size, self.size)
        if min(size) < LEAST_SIDE_PX:
            return _Found("the picture is too narrow")
        camera = tracked.camera.resized(size)
        smallest_px = SMALLEST_SHARE * size[0] * size[1]

        cube_hull, sheet_hull = _hulls(camera, marker)
        if cube_hull is None or sheet_hull is None:
            return _Found("the virtual object reaches behind the camera")
        # The marker lies inside the cube's mask, its white margin beside it: neither object nor shadow.
        cube, sheet = masks.filled(cube_hull, size), masks.filled(sheet_hull, size)

        image = masks.resized(tracked.frame.image_bgr, size)
        dark = masks.darkest_clusters(image, masks.lab_clusters(image), ~sheet)
        foreground: Mask | None = None
        if dark.any():
            foreground = masks.grabcut_foreground(image, self.grabcut_iterations)
        clock.end("segment")
        if foreground is None:
            return _Found("nothing in the picture is dark enough for a shadow")

        object_mask = masks.largest_object(foreground, dark, cube | sheet, smallest_px)
        shadow_mask: Mask | None = None
        if object_mask is not None:
            shadow_mask = masks.shadow_of(object_mask, dark & ~cube, smallest_px)
        clock.end("associate")
        if object_mask is None:
            return _Found("no object found beside the marker")
        if shadow_mask is None:
            return _Found("no shadow found beside the object", object_mask)

        to_light = _to_light(camera, marker, cube_hull, object_mask, shadow_mask)
        clock.end("fit")
        if to_light is None or to_light[2] <= 0:
            clock.end("judge")
            return _Found("the shadow does not fit a light above the ground", object_mask, shadow_mask)
        ratio = shadow_rgb_ratio(image, shadow_mask, object_mask | sheet)
        clock.end("judge")
        return _Found(None, object_mask, shadow_mask, Light(to_light, shadow_rgb_ratio=ratio))


@dataclass(frozen=True, slots=True, eq=False)
class _Found:
    """What the steps found, at the working size, and why there is no light."""

    reason: str | None
    object_mask: Mask | None = None
    shadow_mask: Mask | None = None
    light: Light | None = None


def _hulls(camera: Camera, marker: MarkerPose) -> tuple[Float | None, Float | None]:
    """(n, 2) pixels, of the virtual cube and of the printed sheet; None for one that reaches behind the camera."""
    bodies = geometry.cube_corners(marker.side_m), square_corners(SHEET_OVER_MARKER * marker.side_m)
    cube, sheet = (masks.hull_of_points(camera, marker.T_cam_marker, corners) for corners in bodies)
    return cube, sheet


def _to_light(
    camera: Camera, marker: MarkerPose, cube_hull: Float, object_mask: Mask, shadow_mask: Mask
) -> Float | None:
    """(3,) towards the light, marker frame; None where the ray through the shadow's centre misses the ground."""
    centres_px = np.array([masks.centre_of_mass(object_mask), masks.centre_of_mass(shadow_mask)])
    object_px, shadow_px = undistorted(camera, centres_px)
    scale = geometry.real_to_virtual_scale(cv2.contourArea(cube_hull.astype(np.float32)), float(object_mask.sum()))
    return geometry.to_light_from_centres(camera, marker.T_cam_marker, marker.side_m, object_px, shadow_px, scale)
