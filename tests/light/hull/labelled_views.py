"""Views of bodies of any shape whose every pixel is known to be lit ground, shadow or object."""

import math

import numpy as np

from ashe_live.core.arrays import Float, Float32, Mask
from ashe_live.core.transforms import raycast_to_plane
from ashe_live.light.edges.steps import LightPicture
from ashe_live.light.hull.labelled import MOST_COST, Labelled
from ashe_live.light.pixels.view import View
from tests.light.synthetic_masks import MaskedScene, Parts, box, camera_towards, render

SIZE = (240, 180)
TO_LIGHT_DEG = (200.0, 40.0)
# No upright convex body is like it: a tall post, a low block apart from it, and a beam across.
ODD: Parts = [
    *box(0.0, 0.0, (0.02, 0.02, 0.08)),
    *box(0.035, 0.02, (0.03, 0.03, 0.03), 30.0),
    box(0.0, 0.0, (0.07, 0.015, 0.012), 60.0)[0] + np.array([0, 0, 0.055]),
]
SHADES = {"lit": 190, "shadow": 80, "body": 30}


def views_of(parts: Parts, to_light: Float, headings_deg: tuple[float, ...]) -> list[Labelled]:
    """The body as seen along several headings, from half a metre away and 45 degrees above."""
    poses = [camera_towards((0.01, 0.01), 0.35, 45.0, heading) for heading in headings_deg]
    return [_labelled(render(parts, [to_light], pose, SIZE)) for pose in poses]


def headings(span_deg: float, count: int) -> tuple[float, ...]:
    return tuple(90 + span_deg * (i / (count - 1) - 0.5) for i in range(count))


def _labelled(scene: MaskedScene) -> Labelled:
    body, shadow = scene.body, scene.shadows[0]
    lit = ~(body | shadow)
    image = np.select([body, shadow], [SHADES["body"], SHADES["shadow"]], SHADES["lit"]).astype(np.uint8)
    everywhere = np.ones(body.shape, np.bool_)
    view = View(np.repeat(image[..., None], 3, axis=2), scene.camera, scene.T_cam_marker, 0.08, everywhere)
    v, u = np.mgrid[: SIZE[1], : SIZE[0]]
    plane = raycast_to_plane(scene.camera, scene.T_cam_marker, np.stack([u, v], axis=-1).reshape(-1, 2).astype(float))
    return Labelled(
        P=scene.camera.K @ scene.T_cam_marker[:3],
        as_lit=_cost(lit),
        as_shadow=_cost(shadow),
        as_body=_cost(body),
        never_body=~body,
        surely_lit=lit,
        frame_px=(0.0, 0.0, SIZE[0] - 1.0, SIZE[1] - 1.0),
        unreliable=np.zeros_like(body),
        plane_xy=plane.reshape(SIZE[1], SIZE[0], -1)[..., :2],
        focal_px=float(scene.camera.K[0, 0]),
        picture=LightPicture.of(view),
        picture_from_region=np.eye(3),
        shift=2.2 * math.log(SHADES["shadow"] / SHADES["lit"]),
    )


def _cost(mask: Mask) -> Float32:
    return np.where(mask, 0.0, MOST_COST).astype(np.float32)
