"""The sky's share of the light on open ground, from that in the real object's shadow.

The shadow's ratio is measured beside the object, which hides a part of the sky there and reflects light into the
shadow. The object's albedo is its brightness in the picture over the light on it.
"""

from dataclasses import dataclass

import cv2
import numpy as np

from ashe_live.core.arrays import Float, directions_on_spiral
from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT
from ashe_live.core.proxy import Proxy
from ashe_live.core.transforms import camera_centre
from ashe_live.core.types import TrackedFrame
from ashe_live.render.camera.in_frame import project_distorted, rays_of_pixels
from ashe_live.render.lights.cast_shadows import is_inside, shadow_hull_of_point
from ashe_live.render.lights.lighting import LEAST_LAMP_DISTANCE, MAX_ALBEDO, Lighting

SKY = directions_on_spiral(48, 1.0, 0.0)  # (48, 3) evenly over the sky
SKY_WEIGHTS = SKY[:, 2] / SKY[:, 2].sum()  # of their light on level ground
SLANTS = directions_on_spiral(60)  # (60, 3) normals of planes around a body, besides those of its upright walls
PLACES = 6  # columns and rows of places around the shadow, and of pixels around the object
FEWEST = 3  # least number of either for a median
LEAST_FACING = 0.25  # least cosine to the line of sight of surfaces whose colour is read: rims mix with what is behind
# A third of the ground's light on a wall comes from nearer than 1.1 times the height, another from farther than 2.8
# times. These are the middles of the three thirds (as in ground_shadow.glsl).
THIRDS = (0.66, 1.73, 5.92)


@dataclass(frozen=True, slots=True, eq=False)
class _Hull:
    """The real object as the points between planes that touch it."""

    points: Float  # (n, 3) metres, marker frame
    normals: Float  # (m, 3) unit, outwards
    reach: Float  # (m,) metres, of the planes from the marker's centre along their normals

    def entered(self, origins: Float, directions: Float) -> tuple[Float, Float]:
        """(n,) metres from origins (n, 3) along unit directions (n, 3) to where rays enter, NaN where none does;
        (n, 3) the surface's normals there."""
        along = directions @ self.normals.T
        at = (self.reach - origins @ self.normals.T) / np.where(np.abs(along) < 1e-9, 1e-9, along)
        entries, leaves = np.where(along < 0, at, -np.inf), np.where(along > 0, at, np.inf).min(axis=1)
        nearest = entries.max(axis=1)
        normals = self.normals[entries.argmax(axis=1)]
        return np.where((nearest > 0) & (nearest <= leaves), nearest, np.nan), normals


def open_sky(seen_in: TrackedFrame, body: Proxy, lighting: Lighting, white_rgb: Float) -> Float:
    """(3,) the sky's share of the light on level ground that no object hides any of the sky from, linear RGB.

    `lighting`: of one light, whose `sky` is what is left in the shadow of `body`. `white_rgb`: (3,) linear RGB that
    white, fully lit, has in the picture. `lighting.sky` where the camera does not see the object and its shadow.

    At a place of the shadow the object hides a share O of the sky, by cosine, and sends its albedo times what its sides
    get: sky = A (1 - O) + sent. A is the median over places.
    """
    in_shadow = np.array(lighting.sky)
    hull = _hull_of(body)
    shadow = shadow_hull_of_point(hull.points, lighting.lights[0].homogeneous)
    T_cam_marker = seen_in.pose.T_cam_marker
    eye = camera_centre(T_cam_marker)
    ground = _seen_shadow(hull, shadow, eye)
    albedo = _albedo_of(seen_in, hull, shadow, eye, lighting, white_rgb)
    if len(ground) < FEWEST or albedo is None:
        return in_shadow
    origins, directions = np.repeat(ground, len(SKY), axis=0), np.tile(SKY, (len(ground), 1))
    far, normals = hull.entered(origins, directions)
    hides = np.isfinite(far)
    sending = np.zeros((len(far), 3))
    sides = origins[hides] + far[hides, None] * directions[hides]
    sending[hides] = albedo * _irradiance(lighting, shadow, sides, normals[hides])
    per_place = len(ground), len(SKY)
    hidden = hides.reshape(per_place) @ SKY_WEIGHTS
    sent = np.einsum("pdc,d->pc", sending.reshape(*per_place, 3), SKY_WEIGHTS)
    return np.asarray(np.clip(np.median((in_shadow - sent) / (1 - hidden[:, None]), axis=0), 0.0, 1.0))


def _hull_of(body: Proxy) -> _Hull:
    """Upright walls are exact: those of the outline from above."""
    points = body.points_marker()
    outline = cv2.convexHull(points[:, :2].astype(np.float32), clockwise=False).reshape(-1, 2).astype(np.float64)
    x, y = (np.roll(outline, -1, axis=0) - outline).T
    walls = np.column_stack([y, -x, np.zeros(len(x))]) / np.maximum(np.hypot(x, y), 1e-12)[:, None]
    normals = np.concatenate([SLANTS, walls, [(0.0, 0.0, 1.0), (0.0, 0.0, -1.0)]])
    return _Hull(points, normals, np.asarray((points @ normals.T).max(axis=0)))


def _seen_shadow(hull: _Hull, shadow: Float, eye: Float) -> Float:
    """(n, 3) places of the shadow (m, 2) that are neither below the body nor behind it, seen from `eye` (3,)."""
    foot = cv2.convexHull(hull.points[:, :2].astype(np.float32)).reshape(-1, 2).astype(np.float64)
    places = _grid(shadow.min(axis=0), shadow.max(axis=0))
    distance = float(np.linalg.norm(eye))
    behind = shadow_hull_of_point(hull.points, np.append(eye, 1.0) / distance)
    seen = is_inside(shadow, places) & ~is_inside(foot, places) & ~is_inside(behind, places)
    return np.column_stack([places[seen], np.zeros(int(seen.sum()))])


def _albedo_of(
    seen_in: TrackedFrame, hull: _Hull, shadow: Float, eye: Float, lighting: Lighting, white_rgb: Float
) -> Float | None:
    """(3,) linear RGB: the median over what is seen of the object; None where too little of it is."""
    T_cam_marker, camera = seen_in.pose.T_cam_marker, seen_in.camera
    outline = project_distorted(camera, T_cam_marker, hull.points)
    pixels = np.round(
        _grid(np.maximum(outline.min(axis=0), 0), np.minimum(outline.max(axis=0), np.array(camera.size) - 1))
    )
    rays = rays_of_pixels(camera, T_cam_marker, pixels)
    rays /= np.linalg.norm(rays, axis=1)[:, None]
    far, normals = hull.entered(np.broadcast_to(eye, rays.shape), rays)
    seen = np.isfinite(far) & ((normals * rays).sum(axis=1) < -LEAST_FACING)
    if np.count_nonzero(seen) < FEWEST:
        return None
    column, row = pixels[seen].astype(int).T
    colours = LINEAR_FROM_SRGB_8BIT[seen_in.frame.image_bgr[row, column, ::-1]] / white_rgb
    gets = _irradiance(lighting, shadow, eye + far[seen, None] * rays[seen], normals[seen])
    return np.asarray(np.clip(np.median(colours / np.maximum(gets, 1e-3), axis=0), 0.0, MAX_ALBEDO))


def _irradiance(lighting: Lighting, shadow: Float, places: Float, normals: Float) -> Float:
    """(n, 3) over pi, on places (n, 3) of its sides: of sky, light and ground, with the shadow (m, 2) on it."""
    (light,) = lighting.lights
    below = [is_inside(shadow, places[:, :2] + third * places[:, 2:] * normals[:, :2]) for third in THIRDS]
    shaded = np.mean(below, axis=0)[:, None]
    upwards = 0.5 + 0.5 * normals[:, 2:]
    ground = np.array(lighting.bounce) * (1 - shaded * np.array(light.ground_share))
    towards = light.towards(places)
    distance = np.maximum(np.linalg.norm(towards, axis=1), LEAST_LAMP_DISTANCE)
    facing = np.maximum((normals * towards).sum(axis=1), 0.0) / distance**3
    from_sides = upwards * np.array(lighting.sky) + (1 - upwards) * ground
    return np.asarray(from_sides + facing[:, None] * np.array(light.irradiance))


def _grid(lower: Float, upper: Float) -> Float:
    """(PLACES², 2) places between two corners."""
    steps = (np.arange(PLACES) + 0.5) / PLACES
    return np.asarray(lower + np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2) * (upper - lower))
