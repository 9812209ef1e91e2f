"""The body by which a real object is drawn, against pictures of objects that are a little larger or smaller than it."""

from dataclasses import replace

import cv2
import numpy as np
import pytest

from ashe_live.core.light import Illumination, Light
from ashe_live.core.proxy import Proxy, ProxyMesh
from ashe_live.core.transforms import project
from ashe_live.core.types import Frame
from ashe_live.models.placement import Placement
from ashe_live.models.primitives import box
from ashe_live.render.occlusion.drawn_body import drawn_surface
from ashe_live.render.scene import Scene

GROUND, OBJECT, LETTERS, NOISE = 150, 90, 220, 6.0  # grey levels
FINER = 8  # pixels to a side in which a pixel of a painted picture is divided


def _cup(scale: float = 1.0) -> Proxy:
    return Proxy("frustum", np.array([(0.0, 0.1, 0.0, 0.03 * scale, 0.0), (0.0, 0.1, 0.1, 0.04 * scale, 0.0)]))


def _box(half: float) -> Proxy:
    corners = [(x, 0.1 + y, z, 0.0, 0.0) for x in (-half, half) for y in (-half, half) for z in (0.0, 0.08)]
    return Proxy("box", np.array(corners))


def _pixels(points, tracked) -> np.ndarray:
    return project(tracked.camera, tracked.marker.T_cam_marker, points)


def _outline(points, tracked) -> np.ndarray:
    """(m, 2) the convex hull in the picture."""
    return cv2.convexHull(_pixels(points, tracked).astype(np.float32))[:, 0]


def _photo(stage, body: Proxy, inner: float = 0.93):
    """A frame of a body on grainy ground, with a pale disc on it that leaves a rim of the object around it."""
    tracked = stage.tracked(GROUND, stage.pose(-60, 40, 0.4, (0, 0.1, 0.04)))
    width, height = tracked.frame.size
    hull = _outline(body.surface()[0], tracked)
    middle = hull.mean(axis=0)
    grey = np.full((height * FINER, width * FINER), GROUND, np.uint8)
    for outline, level in ((hull, OBJECT), (middle + inner * (hull - middle), LETTERS)):
        cv2.fillPoly(grey, [np.rint((outline + 0.5) * FINER - 0.5).astype(np.int32)], level)
    grey = cv2.resize(grey, (width, height), interpolation=cv2.INTER_AREA).astype(np.float64)
    noise = np.random.default_rng(3).normal(0, NOISE, grey.shape)
    picture = np.clip(np.rint(cv2.GaussianBlur(grey, (0, 0), 0.6) + noise), 0, 255).astype(np.uint8)
    return replace(tracked, frame=Frame(np.repeat(picture[:, :, None], 3, axis=2), 0, 0.0))


def _farthest_px(points, body: Proxy, tracked) -> float:
    """Of the outline of points from that of a body, both convex."""
    true = _outline(body.surface()[0], tracked)
    return max(abs(cv2.pointPolygonTest(true, tuple(map(float, at)), True)) for at in _outline(points, tracked))


@pytest.mark.parametrize("scale", [0.94, 0.97, 1.0, 1.03, 1.06])
def test_body_is_drawn_where_the_objects_outline_is(stage, scale) -> None:
    tracked = _photo(stage, _cup())
    points, _ = drawn_surface(_cup(scale), tracked)
    assert _farthest_px(points, _cup(), tracked) < 1.0
    if scale != 1.0:
        assert _farthest_px(_cup(scale).surface()[0], _cup(), tracked) > 1.5


def test_box_bends_onto_the_outline_of_a_round_object(stage) -> None:
    """Its flat sides have no points but corners, so that they must have been divided."""
    body, cylinder = _box(0.026), Proxy("cylinder", np.array([(0, 0.1, 0, 0.03, 0), (0, 0.1, 0.08, 0.03, 0)]))
    tracked = _photo(stage, cylinder)
    fitted, drawn, true = (
        _silhouette(*surface, tracked) for surface in (body.surface(), drawn_surface(body, tracked), cylinder.surface())
    )
    assert (drawn != true).sum() < 0.6 * (fitted != true).sum()


def _silhouette(points, triangles, tracked) -> np.ndarray:
    """(h, w) 1 where triangles are seen."""
    seen = np.zeros(tracked.frame.size[::-1], np.uint8)
    for each in np.rint(_pixels(points, tracked)).astype(np.int32)[triangles.astype(int)]:
        cv2.fillConvexPoly(seen, each, 1)
    return seen


@pytest.mark.parametrize("body", [_cup(1.05), _box(0.03)], ids=["cup", "box"])
def test_drawn_surface_is_closed_and_stands_on_the_plane(stage, body) -> None:
    tracked = _photo(stage, _cup(1.1))
    points, triangles = drawn_surface(body, tracked)
    edges = np.concatenate([triangles, np.roll(triangles, -1, axis=1)]).reshape(2, -1).T
    forward = {tuple(each) for each in edges.tolist()}
    assert len(forward) == len(edges)
    assert forward == {(b, a) for a, b in forward}  # each has a triangle on either side, turned alike
    assert points[:, 2].min() >= -1e-12
    assert np.isfinite(points).all()


def test_object_hides_a_model_up_to_its_own_outline_and_casts_the_bodys_shadow(make_renderer, stage) -> None:
    renderer, tracked, body = make_renderer(), _photo(stage, _cup()), _cup(0.94)
    model = stage.placed(stage.glowing_green(box((0.3, 0.3, 0.1))))
    behind = Placement(shift_m=(-0.11, 0.29))
    inside = np.zeros(tracked.frame.size[::-1], np.uint8)
    cv2.fillPoly(inside, [np.rint(_outline(_cup().surface()[0], tracked)).astype(np.int32)], 1)
    inside = cv2.erode(inside, np.ones((5, 5), np.uint8))
    greens = []
    for illumination in (Illumination(real_object=body), Illumination(real_object=body).as_seen_in(tracked)):
        picture = stage.picture(renderer, Scene(tracked, model, illumination, placement=behind)).astype(int)
        greens.append(((picture[..., 1] > picture[..., 2] + 60) & (inside > 0)).sum())
    assert greens[0] > 20
    assert greens[1] == 0
    assert np.array_equal(renderer._models_on_video.layers.real.points, body.surface()[0])


def test_window_does_not_wait_for_an_outline_and_shows_the_former_object_until_it_is_found(
    make_renderer, stage
) -> None:
    renderer, tracked = make_renderer(), _photo(stage, _cup())
    layers = renderer._models_on_video.layers
    model = stage.placed(box((0.02, 0.02, 0.02)))

    def drawn_after(body: Proxy) -> Proxy | None:
        lit = Illumination(real_object=body).as_seen_in(tracked)
        renderer.render(Scene(tracked, model, lit), waits=False)
        return None if layers.real is None else layers.real.proxy

    first, skipped, last = _cup(0.94), _cup(0.96), _cup(1.05)
    assert drawn_after(first) is None
    layers._drawn_bodies._coming.body.result()
    assert drawn_after(first) is first
    assert drawn_after(skipped) is first
    layers._drawn_bodies._coming.body.result()
    assert drawn_after(last) is first, "what was found is of another body"
    layers._drawn_bodies._coming.body.result()
    assert drawn_after(last) is last
    assert np.array_equal(layers.real.drawn_points, drawn_surface(last, tracked)[0])


def test_body_stays_where_no_picture_shows_it_and_where_several_views_gave_a_mesh(stage) -> None:
    tracked = _photo(stage, _cup(1.05))
    points, triangles = _cup().surface()
    mesh = replace(_cup(), mesh=ProxyMesh(points, triangles))
    for body, seen_in in ((_cup(), None), (mesh, tracked), (_cup(), replace(tracked, marker=None))):
        drawn, drawn_triangles = drawn_surface(body, seen_in)
        assert np.array_equal(drawn, points)
        assert np.array_equal(drawn_triangles, triangles)


def test_plain_picture_moves_nothing(stage) -> None:
    tracked = stage.tracked(GROUND, stage.pose(-60, 40, 0.4, (0, 0.1, 0.04)))
    assert _farthest_px(drawn_surface(_cup(), tracked)[0], _cup(), tracked) < 0.05


def test_frame_is_asked_only_while_the_object_stands_where_it_showed_it(stage) -> None:
    tracked = _photo(stage, _cup())
    read = Illumination((Light((0, 0.6, 0.8)),), real_object=_cup()).as_seen_in(tracked)
    assert Scene(illumination=read).object_seen_in is tracked
    assert Scene(illumination=read.relit((), None)).object_seen_in is tracked
    moved = replace(read, real_object=_cup(), as_read=read)
    assert Scene(illumination=moved).object_seen_in is None
