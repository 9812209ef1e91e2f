"""A rough upright body and rough lights from the outlines, as the start of the search."""

import math
from dataclasses import dataclass

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.caster import Caster
from ashe_live.core.transforms import camera_centre
from ashe_live.light.shape.body import BodyFrame
from ashe_live.light.shape.layout import ParameterLayout
from ashe_live.light.shape.outlines.silhouettes import Outlines
from ashe_live.light.shape.sight import Sight

SLENDEREST, FLATTEST = 8.0, 0.3  # height over radius
HIGHEST = 0.85  # guessed height as a fraction of that at which a slab's far edge would be at the outline's top


@dataclass(frozen=True, slots=True, eq=False)
class FirstGuess:
    """An upright cylinder on the ground, in units of the larger of its radius and height, and the lights."""

    frame: BodyFrame
    radius: float
    height: float
    lights: Float  # (l, 4) homogeneous points, in that frame


def guess_scene(sight: Sight, outlines: Outlines, caster: Caster | None) -> FirstGuess | None:
    """A cylinder that covers the object's outline, and lights that cast its top to the tips of the shadows.

    caster: the object, where its size is known: the cylinder's. The sight's pixels must be counted from the outlines'
    centre. None where the camera looks along the ground or from below it, or object or shadow lie above the horizon.
    """
    ground_from_image = _ground_from_image(sight.P_marker)
    if camera_centre(sight.T_cam_marker)[2] <= 0 or ground_from_image is None:
        return None
    cylinder = _cylinder_over(outlines.body.hull_px, sight, ground_from_image, caster)
    if cylinder is None:
        return None
    displacements = []
    for shadow in outlines.shadows:
        points = _on_ground(ground_from_image, shadow.hull_px)
        if not len(points):
            return None
        displacements.append(_displacement(points, cylinder))
    frame, layout = cylinder.frame, ParameterLayout(len(outlines.shadows))
    lights = layout.lights_of(np.concatenate(displacements))
    return FirstGuess(frame, cylinder.radius / frame.unit_m, cylinder.height / frame.unit_m, lights)


@dataclass(frozen=True, slots=True, eq=False)
class _Cylinder:
    """An upright cylinder on the ground."""

    radius: float  # metres
    height: float  # metres
    frame: BodyFrame  # about its foot, in units of the larger of the two


def _cylinder_over(hull_px: Float, sight: Sight, ground_from_image: Float, caster: Caster | None) -> _Cylinder | None:
    """The cylinder that covers an object's hull (m, 2); of the caster's size, where that is known."""
    P = sight.P_marker
    # The image of "up" at the outlines' centre. For a camera that looks straight down, any direction will do.
    length = float(np.linalg.norm(P[:2, 2]))
    up = P[:2, 2] / length if length > 0 else np.array([0.0, -1.0])
    side = np.array([-up[1], up[0]])
    across, along = hull_px @ side, hull_px @ up
    breadth = max(float(np.ptp(across)), 1.0)
    foot_px = side * (across.max() - breadth / 2) + up * along.min()
    step = 0.02 * breadth * up
    foot = _on_ground(ground_from_image, np.array([foot_px, foot_px + step]))
    if len(foot) < 2:
        return None
    away = (foot[1] - foot[0]) / max(float(np.linalg.norm(foot[1] - foot[0])), 1e-300)
    depth = float(P[2] @ (*foot[0], 0.0, 1.0))
    seen_radius = 0.5 * breadth * depth / math.sqrt(sight.camera.K[0, 0] * sight.camera.K[1, 1])
    radius = seen_radius if caster is None else caster.radius_m
    centre = foot[0] + radius * away
    height = _height(P, centre, up, float(along.max()), radius) if caster is None else caster.height_m
    unit = max(radius, height)
    frame = BodyFrame(centre, unit)
    is_seen = math.isfinite(unit) and unit > 0 and P[2] @ frame.T_marker_body[:, 3] > 0
    return _Cylinder(radius, height, frame) if is_seen else None


def _displacement(shadow: Float, cylinder: _Cylinder) -> Float:
    """(2,) by which a light displaces shadows per height, if it casts the cylinder's top to the tip of one.

    shadow: (n, 2) the corners of that shadow on the ground, metres.
    """
    frame, radius, height = cylinder.frame, cylinder.radius, cylinder.height
    offsets = (shadow - frame.origin_marker) / frame.unit_m
    mean = offsets.mean(axis=0)
    towards = mean / max(float(np.linalg.norm(mean)), 1e-12)
    reach = float((offsets @ towards).max()) - 0.7 * radius / frame.unit_m
    return np.asarray(-towards * max(reach, 0.1 * radius / frame.unit_m) * frame.unit_m / height)


def _height(P: Float, centre: Float, up: Float, top_px: float, radius: float) -> float:
    """The height of an upright cylinder about `centre` (2,) whose top is seen `top_px` along the unit vector `up`."""
    image = P @ (*centre, 0.0, 1.0)
    gain = float(P[:2, 2] @ up - top_px * P[2, 2])
    missing = float(top_px * image[2] - image[:2] @ up)
    height = HIGHEST * missing / gain if gain > 0 else math.inf
    return min(max(height, FLATTEST * radius), SLENDEREST * radius)


def _ground_from_image(P: Float) -> Float | None:
    """(3, 3) homography from pixels to ground points; the last coordinate is positive in front of the camera.

    None where it is singular: the camera lies in the ground's plane.
    """
    image_from_ground = P[:, [0, 1, 3]]
    scale = float(np.abs(image_from_ground).max())
    determinant = float(np.linalg.det(image_from_ground / scale)) if scale > 0 else 0.0
    if not math.isfinite(determinant) or abs(determinant) < 1e-12:
        return None
    return np.asarray(np.linalg.inv(image_from_ground))


def _on_ground(ground_from_image: Float, pixels: Float) -> Float:
    """(m, 2) ground points of those of the pixels (n, 2) that lie below the horizon."""
    points = np.column_stack([pixels, np.ones(len(pixels))]) @ ground_from_image.T
    # The last coordinate is 0 on the horizon; points close to it are too far away to be of use.
    seen = points[points[:, 2] > 1e-4 * np.abs(ground_from_image[2, 2])]
    return np.asarray(seen[:, :2] / seen[:, 2:])
