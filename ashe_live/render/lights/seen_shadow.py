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
from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT, REC709_LUMINANCE
from ashe_live.core.light import Light
from ashe_live.core.proxy import Proxy
from ashe_live.core.transforms import camera_centre
from ashe_live.core.types import TrackedFrame
from ashe_live.render.camera.in_frame import project_distorted, rays_of_pixels
from ashe_live.render.lights.cast_shadows import shadow_hull_of_point
from ashe_live.render.lights.lighting import measured_ratio

MOST_TEXELS = 384  # a side of the rectified plane
# Over the root of the area of the body's shadow: how far outside its shadow may be found, how far beyond that ground is
# looked at, and the standard deviation of the weight of ground by its distance.
REACH, BAND, SPREAD = 0.1, 0.6, 0.5
SHEET = 2.0  # assumed side of the marker's sheet, over that of its square, on which nothing is found
OBJECT_PX = 3  # around the body in the picture, where the object itself may be
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


def seen_shadows(body: Proxy, seen_in: TrackedFrame | None, lights: tuple[Light, ...]) -> tuple[SeenShadow, ...]:
    """What `seen_in`, a frame that shows the body's shadows in these lights, says of each of them.

    Nothing of a mesh, whose shadow several views gave, nor of a body that the marker is on.
    """
    if seen_in is None or seen_in.marker is None or seen_in.marker.body is not None or body.mesh is not None:
        return ()
    lights = tuple(light for light in lights if light.to_light_marker[2] > 0)
    points = body.points_marker(48)
    hulls = [shadow_hull_of_point(points, np.array([*each.to_light_marker, each.inverse_distance])) for each in lights]
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
    plane = _Plane.around(seen_in, hull)
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
    dark = inside & ~lit
    clearly_dark = (inside & (odds < -CLEAR)).sum()
    if clearly_dark < max(LEAST_SHARE * inside.sum(), lit.sum()):
        return None
    shaded = _without_lines((near & (odds < -CONNECTED)) | shadow) & near & ~shadow
    shaded &= _connected(shaded | dark, dark)
    values = np.stack([np.where(shaded | (shadow & ~lit), 0.0, 1.0), (lit | shaded).astype(np.float64)], axis=2)
    # What is told counts up to the border of what the body says.
    told = cv2.GaussianBlur(values, (0, 0), BORDER)
    share = np.round(255 * np.stack([told[..., 0], np.minimum(2 * told[..., 1], 1)], axis=2)).astype(np.uint8)
    homogeneous = np.array([*light.to_light_marker, light.inverse_distance])
    return SeenShadow(homogeneous, plane.bounds, share, reach * plane.texel_m)


@dataclass(frozen=True, slots=True, eq=False)
class _Plane:
    """A part of the marker's plane as a picture shows it."""

    bounds: Float  # (4,) lower x, y and upper x, y, metres
    texel_m: float
    size: float  # the root of the area of the body's shadow as far as it is seen, texels
    pixels: NDArray[np.float32]  # (h, w, 2) where its texels are in the picture
    linear_rgb: NDArray[np.float32]  # (h, w, 3)

    @staticmethod
    def around(seen_in: TrackedFrame, hull: Float) -> "_Plane | None":
        """Around what is seen of a convex polygon (n, 2), metres."""
        camera, T_cam_marker = seen_in.camera, seen_in.pose.T_cam_marker
        corners = np.column_stack([hull, np.zeros(len(hull))])
        if len(hull) < 3 or (corners @ T_cam_marker[2, :3] + T_cam_marker[2, 3]).min() <= 1e-3:
            return None
        width, height = seen_in.frame.size
        picture = np.array([(0, 0), (width - 1, 0), (width - 1, height - 1), (0, height - 1)], np.float32)
        outline = cv2.convexHull(project_distorted(camera, T_cam_marker, corners).astype(np.float32))
        area_px, visible = cv2.intersectConvexConvex(outline, picture)
        if visible is None or area_px < 25:
            return None
        on_plane = _ground_at(seen_in, visible.reshape(-1, 2).astype(np.float64))
        area_m2 = abs(cv2.contourArea(on_plane.astype(np.float32)))
        margin = (REACH + BAND) * np.sqrt(area_m2)
        lower, upper = on_plane.min(axis=0) - margin, on_plane.max(axis=0) + margin
        texel_m = max(np.sqrt(area_m2 / area_px), (upper - lower).max() / MOST_TEXELS)
        count = np.maximum(np.ceil((upper - lower) / texel_m), 2).astype(int)
        upper = lower + count * texel_m
        axes = (low + (np.arange(n) + 0.5) * texel_m for low, n in zip(lower, count, strict=True))
        texels = np.stack([*np.meshgrid(*axes), np.zeros(count[::-1])], axis=2).reshape(-1, 3)
        in_front = texels @ T_cam_marker[2, :3] + T_cam_marker[2, 3] > 1e-3
        texels = np.where(in_front[:, None], texels, corners[0])
        at = project_distorted(camera, T_cam_marker, texels)
        at = np.where(in_front[:, None], at, -1e4).reshape(*count[::-1], 2)
        pixels = np.asarray(at, np.float32)
        blur_px = 0.5 * texel_m / np.sqrt(area_m2 / area_px)
        image = seen_in.frame.image_bgr
        blurred = cv2.GaussianBlur(image, (0, 0), blur_px) if blur_px > 0.75 else image
        x, y = pixels[..., 0], pixels[..., 1]
        colours = cv2.remap(blurred, x, y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
        linear = np.asarray(LINEAR_FROM_SRGB_8BIT[colours[..., ::-1]], np.float32)
        size = float(np.sqrt(area_m2) / texel_m)
        return _Plane(np.array([*lower, *upper]), float(texel_m), size, pixels, linear)

    def within(self, polygon: Float) -> Mask:
        """(h, w) what a convex polygon (n, 2), metres, covers."""
        mask = np.zeros(self.pixels.shape[:2], np.uint8)
        at = (polygon - self.bounds[:2]) / self.texel_m - 0.5
        cv2.fillConvexPoly(mask, np.round(np.clip(at, -1e4, 1e4)).astype(np.int32), 1)
        return mask.astype(bool)

    def hidden(self, seen_in: TrackedFrame, points: Float) -> Mask:
        """(h, w) what the picture does not show, what a body of points (n, 3) hides there, and the marker's sheet."""
        T_cam_marker = seen_in.pose.T_cam_marker
        shown = np.zeros(seen_in.frame.image_bgr.shape[:2], np.uint8)
        shown[1:-1, 1:-1] = 1
        corners = seen_in.pose.corners_px
        sheet = corners.mean(axis=0) + SHEET * (corners - corners.mean(axis=0))
        for outline in (project_distorted(seen_in.camera, T_cam_marker, points), sheet):
            cv2.fillConvexPoly(shown, cv2.convexHull(np.round(np.clip(outline, -1e4, 1e4)).astype(np.int32)), 0)
        kernel = np.ones((2 * OBJECT_PX + 1, 2 * OBJECT_PX + 1), np.uint8)
        shown = np.asarray(cv2.erode(shown, kernel), np.uint8)
        at = self.pixels
        return np.asarray(cv2.remap(shown, at[..., 0], at[..., 1], cv2.INTER_NEAREST, borderValue=0) == 0)


def _ground_at(seen_in: TrackedFrame, pixels: Float) -> Float:
    """(n, 2) metres, where the rays of pixels (n, 2) meet the marker's plane."""
    T_cam_marker = seen_in.pose.T_cam_marker
    rays, eye = rays_of_pixels(seen_in.camera, T_cam_marker, pixels), camera_centre(T_cam_marker)
    return np.asarray((eye - rays * (eye[2] / rays[:, 2:]))[:, :2])


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
