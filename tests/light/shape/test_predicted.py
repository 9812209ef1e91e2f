"""Predicted silhouettes beside those of plain projective geometry."""

import numpy as np
import pytest

from ashe_live.core.arrays import Float, Mask
from ashe_live.core.camera import Camera, Size
from ashe_live.core.proxy import Proxy
from ashe_live.light.pixels.areas import grown
from ashe_live.light.pixels.view import View
from ashe_live.light.shape.light_points import at_infinity
from ashe_live.light.shape.predicted import Predicted, predicted
from tests.light.painted_scenes import SIDE_M, overlap
from tests.light.synthetic_masks import MaskedScene, Parts, ball, box, camera_towards, direction, render, turned

VIEWS = {
    "usual": camera_towards((0.08, 0.0), 0.5, 35.0),
    "from above": camera_towards((0.08, 0.0), 0.5, 90.0),
    "low": camera_towards((0.08, 0.0), 0.5, 10.0),
}
USUAL = VIEWS["usual"]


def proxy_of(parts: Parts) -> Proxy:
    points = np.concatenate(parts)
    return Proxy("points", np.column_stack([points, np.zeros((len(points), 2))]))


BODIES: dict[str, tuple[Proxy, Parts]] = {
    "box": (proxy_of(box(0.1, 0.02, (0.06, 0.04, 0.08), 25.0)), box(0.1, 0.02, (0.06, 0.04, 0.08), 25.0)),
    "cylinder": (
        Proxy("frustum", np.array([(0.1, 0.02, 0, 0.03, 0), (0.1, 0.02, 0.1, 0.03, 0)])),
        turned(0.1, 0.02, [(0.03, 0.0), (0.03, 0.1)]),
    ),
    "cone": (
        Proxy("frustum", np.array([(0.1, 0.02, 0, 0.04, 0), (0.1, 0.02, 0.09, 0, 0)])),
        turned(0.1, 0.02, [(0.04, 0.0), (0.0, 0.09)]),
    ),
    "ball": (Proxy("sphere", np.array([(0.1, 0.02, 0.035, 0.035, 0.035)])), ball(0.1, 0.02, 0.035)),
}


def view_of(scene: MaskedScene) -> View:
    return blank(scene.camera.size, scene.T_cam_marker, scene.camera)


def blank(size: Size, T_cam_marker: Float, camera: Camera | None = None) -> View:
    shape = size[::-1]
    camera = camera or Camera.from_focal(size, 400.0)
    return View(np.zeros((*shape, 3), np.uint8), camera, T_cam_marker, SIDE_M, np.ones(shape, bool))


def looks(proxy: Proxy, light: Float, view: View) -> Predicted:
    return predicted(proxy, at_infinity(light[None]), view)


def agree_within(reach_px: int, a: Mask, b: Mask) -> bool:
    return not (a & ~grown(b, reach_px)).any() and not (b & ~grown(a, reach_px)).any()


@pytest.mark.parametrize("view", VIEWS)
@pytest.mark.parametrize(("azimuth_deg", "elevation_deg"), [(20, 40), (110, 35), (200, 60), (290, 25), (330, 80)])
@pytest.mark.parametrize("name", BODIES)
def test_silhouettes_are_those_of_geometry(name: str, azimuth_deg: float, elevation_deg: float, view: str) -> None:
    proxy, parts = BODIES[name]
    light = direction(azimuth_deg, elevation_deg)
    scene = render(parts, [light], VIEWS[view])
    found = looks(proxy, light, view_of(scene))
    # Rings are drawn as polygons.
    assert agree_within(1 if name == "box" else 2, found.body, scene.body)
    # A tip that is thinner than a pixel is drawn, or is not.
    assert overlap(found.whole, scene.body | scene.shadows[0]) > 0.95


@pytest.mark.parametrize(
    ("azimuth_deg", "elevation_deg"),
    [(20, 5), (110, 10), (200, 2), (290, 5), (20, 2), (80, 5), (110, 3), (110, 1)],
)
def test_a_shadow_that_leaves_the_frame_is_seen_as_far_as_the_frame(azimuth_deg: float, elevation_deg: float) -> None:
    proxy, parts = BODIES["box"]
    light = direction(azimuth_deg, elevation_deg)
    scene = render(parts, [light], USUAL)
    assert agree_within(2, looks(proxy, light, view_of(scene)).whole, scene.body | scene.shadows[0])


def test_no_pixel_is_body_and_shadow() -> None:
    proxy, parts = BODIES["box"]
    scene = render(parts, [direction(110, 35)], USUAL)
    found = looks(proxy, direction(110, 35), view_of(scene))
    assert not (found.body & found.shadow).any()
    np.testing.assert_array_equal(found.whole, found.body | found.shadow)


def test_a_body_behind_the_camera_is_not_seen() -> None:
    proxy, _ = BODIES["box"]
    assert not looks(proxy, direction(110, 35), blank((64, 48), camera_towards((0.08, 0.0), -0.5, 40.0))).whole.any()


@pytest.mark.parametrize("size", [(1, 1), (1, 50), (50, 1)])
@pytest.mark.parametrize("light", [(0, 0, 1), (1, 0, 0), (0.6, 0.8, 1e-12)])
def test_any_light_and_size_has_silhouettes(light: tuple[float, ...], size: tuple[int, int]) -> None:
    for proxy, _ in BODIES.values():
        assert looks(proxy, np.array(light, float), blank(size, USUAL)).whole.shape == size[::-1]
