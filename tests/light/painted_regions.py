"""The regions of painted scenes, and the truth in them: what the stages after `regions` are asked about."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache, cached_property
from typing import Any

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Image, Mask
from ashe_live.core.transforms import angle_between
from ashe_live.light.estimators.preset import BALANCED
from ashe_live.light.explanation.explanation import Explanation
from ashe_live.light.explanation.scene_view import SceneView
from ashe_live.light.ground.lit_ground import LitGround, fit_lit_ground, unlit_mask
from ashe_live.light.ground.regions import Region, unlit_regions
from ashe_live.light.ground.shadow_shift import voted_for
from ashe_live.light.labels.materials import Materials, materials_of
from ashe_live.light.pixels.log_colour import log_opponent
from ashe_live.light.pixels.view import View
from tests.light.painted_scenes import SHADOW_RATIO, Caster, Painted, paint, tracked_frame

LEAST_PX = 40
Look = Callable[[Image], Image]


@dataclass(frozen=True, eq=False)
class PaintedRegion:
    """The largest region of a scene, and what it truly shows."""

    scene: Painted
    ground: LitGround
    unlit: Mask  # (h, w) of the coarse frame
    regions: list[Region]
    region: Region
    body: Mask  # (h, w) of the region
    shadow: Mask  # (h, w) of the region
    true_shift: Float  # (3,) of the painted shadow

    @cached_property
    def view(self) -> SceneView:
        fine = View.of(self.scene.tracked, BALANCED.fine_width_px)
        return SceneView(self.scene.tracked.frame.index, fine, fine.scaled(BALANCED.coarse_width_px), self.ground)

    def error_deg(self, explanation: Explanation) -> float:
        """Between an explanation's first light and the one that the scene is painted in."""
        return math.degrees(angle_between(explanation.lights[0].to_light_marker, self.scene.to_light))

    @cached_property
    def materials(self) -> Materials:
        return materials_of(self.region, self.ground, self.true_shift)

    @cached_property
    def shifts(self) -> list[Float]:
        (shifts,) = voted_for(self.region.colours[self.region.unlit], self.ground, BALANCED.shifts)
        return shifts


@cache
def painted_region(
    *casters: Caster, lamp_m: tuple[float, ...] | None = None, seen_as: Look | None = None, **how: Any
) -> PaintedRegion:
    """The region of painted casters, as the balanced preset looks at it.

    seen_as: what a camera makes of the picture.
    """
    how["lamp_m"] = None if lamp_m is None else np.array(lamp_m)
    scene, empty = paint(*casters, **how), paint(**how)
    if seen_as is not None:
        scene, empty = _seen(scene, seen_as), _seen(empty, seen_as)
    fine = View.of(scene.tracked, BALANCED.fine_width_px)
    coarse = fine.scaled(BALANCED.coarse_width_px)
    ground = fit_lit_ground(coarse.image_bgr, coarse.is_ground, BALANCED.ground)
    assert ground is not None
    unlit = unlit_mask(ground, coarse.is_ground, LEAST_PX)
    regions = unlit_regions(fine, unlit, ground, BALANCED.region_px, BALANCED.regions)
    # A shadow that leaves the picture may be taken for surroundings as well, in a region before this one.
    region = next(each for each in regions if each.surroundings is None)
    body, shadow = in_region(region, scene.body), in_region(region, scene.shadow)
    return PaintedRegion(scene, ground, unlit, regions, region, body, shadow, _true_shift(scene, empty))


def blurred_and_grey(image: Image) -> Image:
    """As by a lens that is not quite in focus, without colours."""
    grey = cv2.cvtColor(cv2.GaussianBlur(image, (0, 0), 1.2), cv2.COLOR_BGR2GRAY)
    return np.asarray(cv2.cvtColor(grey, cv2.COLOR_GRAY2BGR), np.uint8)


def _seen(scene: Painted, look: Look) -> Painted:
    tracked = scene.tracked
    return replace(scene, tracked=tracked_frame(look(tracked.frame.image_bgr), tracked.camera))


def in_region(region: Region, mask: Mask) -> Mask:
    """A mask of the whole frame, of any size, as one of the region."""
    size = region.frame_shape[1], region.frame_shape[0]
    scaled = cv2.resize(mask.astype(np.float32), size, interpolation=cv2.INTER_AREA)
    return np.asarray(scaled[region.window] > 0.5)


def _true_shift(scene: Painted, empty: Painted) -> Float:
    """What the shadow changed, well within it."""
    inner = cv2.erode(scene.shadow.astype(np.uint8), np.ones((7, 7), np.uint8)) > 0
    assert inner.any()
    shaded, lit = (log_opponent(painted.tracked.frame.image_bgr)[inner] for painted in (scene, empty))
    return np.asarray(np.median(shaded - lit, axis=0), dtype=np.float64)


def shift_of(ratio_rgb: Float = SHADOW_RATIO) -> Float:
    """(3,) the shift that multiplies linear RGB by a ratio, on a ground so light that nothing is lost in the dark."""
    red, green, blue = np.log(ratio_rgb)
    return np.array([(red + green + blue) / 3, 1.2 * (red - blue), 1.2 * (red + blue - 2 * green)])
