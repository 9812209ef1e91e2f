"""Where the real object's shadow is seen to end elsewhere than where its body casts it.

The body is convex and of a family: a mug's handle, a notch or a step of the object let light through that it does not.
In the picture, ground in the shadow is lit ground times the light's ratio. So each place has two explanations: ground
that is seen beside the shadow, or such ground times the ratio. The picture is rectified to the marker's plane; what
ground there is beside the shadow is a histogram of brightness and hue that varies over the plane, which allows for
patterns of several colours (tiles, bricks, planks).
"""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float, Mask
from ashe_live.core.colour import REC709_LUMINANCE
from ashe_live.core.light import Light
from ashe_live.core.proxy import Proxy
from ashe_live.core.types import TrackedFrame
from ashe_live.render.lights.cast_shadows import shadow_hull_of_point
from ashe_live.render.lights.lighting import measured_ratio
from ashe_live.render.lights.seen.lit_ground import LitGround, lit_ground
from ashe_live.render.lights.seen.plane import PlaneInPicture

MOST_TEXELS = 384  # a side of the rectified plane
# Over the root of the area of the body's shadow: how far outside its shadow may be found, how far beyond that ground is
# looked at, and the standard deviation of the weight of ground by its distance.
REACH, BAND, SPREAD = 0.1, 0.6, 0.5
BRIGHTNESS_STEP, HUE_STEP = 0.06, 0.1  # of the histogram, in logarithms of light and of red over blue
MOST_STEPS = 40
FLOOR = 0.02  # share of the lit ground's light that is added before a logarithm is taken
DARKEST = 1e-5  # that is added at least, as ground may be black
BLUR = 0.8  # of the picture, texels, before colours are compared
COARSER = 4  # texels in one of the histogram's map
UNEXPLAINED = 0.02  # likelihood, over that of the commonest ground, of what is seen nowhere beside the shadow
SMOOTHED, CLEAR = 1.2, 1.0  # the odds' smoothing, texels, and from which log odds on they count
CONNECTED = 0.3  # the same for what is connected with the body's shadow, and goes on beyond it
LEAST_TEXELS = 1.5  # what is narrower than twice this, as a joint, is no part of a shadow, nor a gap in it
# Of what is seen of the body's shadow so much must look dark, and more of it than looks lit, or it is not that shadow.
LEAST_SHARE = 0.25
BORDER = 0.7  # the answer's smoothing, texels


@dataclass(frozen=True, slots=True, eq=False)
class SeenShadow:
    """A part of the marker's plane in which a picture shows where a light is kept away, beside what a body says."""

    light: Float  # (4,) homogeneous, marker frame, metres, whose shadow it is
    bounds: Float  # (4,) lower x, y and upper x, y, metres
    share: NDArray[np.uint8]  # (h, w, 2) rows by y: share of the light that arrives, and how far the picture says so
    reach_m: float  # how far beyond the body's shadow it is told
    ground: LitGround | None = None  # at its border; None where too little is seen, or beside other lights


def seen_shadows(body: Proxy, seen_in: TrackedFrame | None, lights: tuple[Light, ...]) -> tuple[SeenShadow, ...]:
    """What `seen_in`, a frame that shows the body's shadows in these lights, says of each of them.

    Nothing of a mesh, whose shadow several views gave, nor of a body that the marker is on.
    """
    if seen_in is None or seen_in.marker is None or seen_in.marker.body is not None or body.mesh is not None:
        return ()
    lights = tuple(light for light in lights if light.to_light_marker[2] > 0)
    points = body.points_marker(48)
    hulls = [shadow_hull_of_point(points, each.homogeneous) for each in lights]
    found = []
    for number, light in enumerate(lights):
        ratio = measured_ratio(light)
        others = hulls[:number] + hulls[number + 1 :]
        shadow = None if ratio is None else _seen_shadow(points, seen_in, light, ratio, hulls[number], others)
        if shadow is not None:
            found.append(shadow)
    return tuple(found)


def _seen_shadow(
    points: Float, seen_in: TrackedFrame, light: Light, ratio: Float, hull: Float, others: list[Float]
) -> SeenShadow | None:
    """None where too little is seen, or where the shadow is not seen. hull (n, 2): that of the body's shadow."""
    plane = PlaneInPicture.around(seen_in, hull, REACH + BAND, MOST_TEXELS)
    if plane is None:
        return None
    shadow = plane.within(hull)
    hidden = plane.hidden(seen_in, points)
    for other in others:
        hidden |= plane.within(other)
    reach = plane.size * REACH
    near = _grown(shadow, reach) & ~hidden
    ground = _grown(shadow, reach + plane.size * BAND) & ~_grown(shadow, 0.5 * reach) & ~hidden
    inside = shadow & ~hidden
    if ground.sum() < 0.1 * plane.size**2 or not inside.any():
        return None
    odds = _log_odds_of_light(plane.linear_rgb, ground, ratio, plane.size * SPREAD)
    seen = cv2.GaussianBlur(near.astype(np.float32), (0, 0), SMOOTHED)
    odds = cv2.GaussianBlur(np.where(near, odds, 0).astype(np.float32), (0, 0), SMOOTHED) / np.maximum(seen, 0.05)
    lit = _without_lines((inside & (odds > CLEAR)) | (~shadow & ~hidden)) & inside
    seen_dark = inside & ~lit
    clearly_dark = (inside & (odds < -CLEAR)).sum()
    if clearly_dark < max(LEAST_SHARE * inside.sum(), lit.sum()):
        return None
    shaded = _without_lines((near & (odds < -CONNECTED)) | shadow) & near & ~shadow
    shaded &= _connected(shaded | seen_dark, seen_dark)
    dark = shaded | (shadow & ~lit)
    values = np.stack([np.where(dark, 0.0, 1.0), (lit | shaded).astype(np.float64)], axis=2)
    # What is told counts up to the border of what the body says.
    told = cv2.GaussianBlur(values, (0, 0), BORDER)
    share = np.round(255 * np.stack([told[..., 0], np.minimum(2 * told[..., 1], 1)], axis=2)).astype(np.uint8)
    at_border = None if others else lit_ground(points, seen_in, light, ratio, plane, dark)
    return SeenShadow(light.homogeneous, plane.bounds, share, reach * plane.texel_m, at_border)


def _log_odds_of_light(linear_rgb: NDArray[np.float32], ground: Mask, ratio: Float, spread: float) -> Float:
    """(h, w) of lit ground like that in the mask `ground` against the same times a ratio (3,)."""
    smooth = cv2.GaussianBlur(linear_rgb, (0, 0), BLUR)
    logs = np.log(smooth + np.maximum(FLOOR * smooth[ground].mean(axis=0), DARKEST))
    ratio_log = np.log(np.clip(ratio, 0.01, 1.0))
    weights = REC709_LUMINANCE, np.array([1.0, 0.0, -1.0])
    features = np.stack([logs @ each for each in weights], axis=2)
    shift = np.array([ratio_log @ each for each in weights])
    low = np.quantile(features[ground], 0.01, axis=0) - 0.1
    high = np.quantile(features[ground], 0.99, axis=0) + 0.1
    step = np.maximum((BRIGHTNESS_STEP, HUE_STEP), (high - low) / MOST_STEPS)
    count = np.ceil((high - low) / step).astype(int) + 2  # with a rim that stays empty
    maps = _histograms(np.where(ground[..., None], (features - low) / step + 1, -1), count, spread)
    rows, columns = np.arange(ground.shape[0])[:, None] // COARSER, np.arange(ground.shape[1]) // COARSER
    commonest = np.maximum(maps.max(axis=(0, 1)), 1e-9)[rows, columns]

    def likelihood(values: Float) -> Float:
        steps = np.clip(np.floor((values - low) / step + 1), 0, count - 1).astype(int)
        at = steps[..., 0], steps[..., 1], rows, columns
        return np.asarray(maps[at] / commonest + UNEXPLAINED)

    return np.log(likelihood(features) / likelihood(features - shift))


def _histograms(steps: Float, count: NDArray[np.int_], spread: float) -> NDArray[np.float32]:
    """(a, b, h, w) coarser maps of the share of each of a x b kinds of ground about there, by steps (h, w, 2)."""
    kinds, within = int(count.prod()), np.floor(steps).astype(int)
    is_one = (within >= 1).all(axis=2) & (within < count - 1).all(axis=2)
    height, width = (-(-n // COARSER) for n in steps.shape[:2])
    row, column = np.nonzero(is_one)
    block = row // COARSER * width + column // COARSER
    counts = np.bincount(within[is_one] @ (count[1], 1) * (height * width) + block, minlength=kinds * height * width)
    maps = counts.astype(np.float32).reshape(kinds, height, width)
    for kind in np.flatnonzero(maps.any(axis=(1, 2))):
        maps[kind] = cv2.GaussianBlur(maps[kind], (0, 0), spread / COARSER)
    maps = maps.reshape(*count, height, width)
    for axis in (0, 1):
        maps = 0.5 * maps + 0.25 * (np.roll(maps, 1, axis) + np.roll(maps, -1, axis))
    return np.asarray(maps)


def _without_lines(mask: Mask) -> Mask:
    """(h, w) without what is narrower than LEAST_TEXELS to either side."""
    across = 2 * int(np.ceil(LEAST_TEXELS)) + 1
    kernel = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (across, across))
    return np.asarray(cv2.morphologyEx(mask.astype(np.uint8), cv2.MORPH_OPEN, kernel).astype(bool))


def _connected(mask: Mask, to: Mask) -> Mask:
    """(h, w) the parts of a mask that have something of another one in them."""
    _, labels = cv2.connectedComponents(mask.astype(np.uint8), connectivity=8)
    return np.asarray(mask & np.isin(labels, np.unique(labels[to & mask])))


def _grown(mask: Mask, by: float) -> Mask:
    return np.asarray(cv2.distanceTransform((~mask).astype(np.uint8), cv2.DIST_L2, 3) <= by) if mask.any() else mask
