"""A model that was moved by hand: the same picture as of a model that was built there, and nothing uploaded for it."""

import dataclasses
import math

import numpy as np
import pytest

from ashe_live.core.light import Illumination, Light
from ashe_live.core.proxy import Proxy
from ashe_live.core.transforms import direction_from_angles, raycast_to_plane
from ashe_live.models.catalogue import load_model
from ashe_live.models.material import Alpha, Material
from ashe_live.models.mesh import Mesh, Model, Motion
from ashe_live.models.placement import PlacedModel, Placement, placed_on_marker
from ashe_live.models.primitives import box
from ashe_live.quality import BALANCED, FAST, QUALITIES
from ashe_live.render.gl.offscreen import live_gl_objects
from ashe_live.render.scene import Overlay, Scene
from tests.render.in_turns import in_turns

GROUND = 200
GREEN = (0.0, 1.0, 0.0, 1.0)
RATIO = (0.2, 0.2, 0.2)


def _built_there(model: Model, placement: Placement) -> PlacedModel:
    matrix = placement.marker_from_placed
    turn = matrix[:3, :3] / placement.scale
    parts = tuple(
        Mesh(
            (part.vertices @ matrix[:3, :3].T + matrix[:3, 3]).astype(np.float32),
            (part.normals @ turn.T).astype(np.float32),
            part.triangles,
            part.uvs,
            part.colours,
            part.material,
        )
        for part in model.parts
    )
    moved = Model(model.name, parts)
    return PlacedModel(moved, moved.bounds)


# Textured; polished, with something to be seen through.
@pytest.mark.parametrize(("quality", "name"), in_turns([("mug",), ("mug",), ("goblet",), ("goblet",)]))
def test_it_looks_as_if_it_had_been_built_there(make_renderer, stage, quality: str, name: str) -> None:
    model = placed_on_marker(load_model(name), 0.08)
    placement = Placement(1.4, math.radians(70), (0.03, -0.02))
    cup = Proxy("cup", np.array([(-0.07, 0.02, z, 0.02, 0) for z in (0.0, 0.05)]))
    tracked = stage.tracked(stage.noise(), stage.pose(-70, 40, 0.6))
    pictures = []
    for shown, moved in ((model, placement), (_built_there(model.model, placement), Placement())):
        renderer = make_renderer(QUALITIES[quality].render)
        lights = (stage.light(120, 40, RATIO), stage.light(20, 60, (0.8, 0.8, 0.8)))
        renderer.render(Scene(tracked, shown, Illumination(lights, real_object=cup), placement=moved))
        pictures.append(renderer.read_bgr().astype(float))
    here = np.abs(pictures[0] - pictures[1]).max(axis=2)
    changed = np.abs(pictures[1] - tracked.frame.image_bgr).max(axis=2) > 8
    assert changed.sum() > 10_000
    # Texels of depth maps and the directions of the sky that the contact is made of fall a little differently.
    assert np.mean(here[changed] > 8) < 0.002
    assert here.mean() < 0.15


def test_what_the_ground_throws_onto_its_walls_is_as_blurred_at_any_scale(make_renderer, stage) -> None:
    """Over its own shadow and beyond: all lengths are those of the model, however large that is."""
    wall = stage.placed(box((0.06, 0.02, 0.06), (1.0, 1.0, 1.0, 1.0)))
    on_walls = []
    for scale in (0.2, 5.0):
        renderer = make_renderer(BALANCED.render)
        tracked = stage.tracked(GROUND, stage.pose(-70, 35, 0.3 * scale, target=(0, 0, 0)))
        lit = Illumination((stage.light(90, 30, (0.02,) * 3),))
        renderer.render(Scene(tracked, wall, lit, placement=Placement(scale)))
        (texture,) = renderer._models_on_video.layers.catcher._walls[0]._canvas.textures
        on_walls.append(np.frombuffer(texture.read(), np.float32))
    assert np.abs(on_walls[0] - on_walls[1]).mean() < 0.002


def _shadow_points(picture: np.ndarray, tracked) -> np.ndarray:
    """(n, 2) ground of the pixels that are in full shadow."""
    blue, green, red = np.moveaxis(picture.astype(int), 2, 0)
    is_shadow = ~((green > red + 10) & (green > blue + 10)) & (green < 150)
    rows, columns = np.nonzero(is_shadow)
    pixels = np.column_stack([columns, rows]).astype(float)
    return raycast_to_plane(tracked.camera, tracked.marker.T_cam_marker, pixels)[:, :2]


@pytest.mark.parametrize("scale", [0.5, 1.7])
def test_its_shadow_grows_with_it_about_its_foot(make_renderer, stage, scale: float) -> None:
    """From far above, so that the box hides nothing of its shadow's end."""
    pole = stage.placed(box((0.02, 0.02, 0.05), GREEN))
    foot = np.array((0.03, -0.02))
    tracked = stage.tracked(GROUND, stage.pose(-90, 70, 0.6, target=(0, 0, 0)))
    light = stage.light(150, 35, RATIO)
    away = -light.to_light_marker[:2] / np.linalg.norm(light.to_light_marker[:2])
    reach = []
    for placement in (Placement(1.0, 0.0, tuple(foot)), Placement(scale, 0.0, tuple(foot))):
        renderer = make_renderer(FAST.render)
        renderer.render(Scene(tracked, pole, Illumination((light,)), placement=placement))
        points = _shadow_points(renderer.read_bgr(), tracked) - foot
        reach.append(float((points @ away).max()))
    expected = 0.05 / math.tan(math.radians(35)) + 0.01 * np.abs(away).sum()  # the far corner of the top
    assert reach[0] == pytest.approx(expected, abs=0.0025)  # a pixel is 1.2 mm there
    assert reach[1] / reach[0] == pytest.approx(scale, rel=0.03)


def test_moving_it_uploads_nothing(make_renderer, stage) -> None:
    renderer, model = make_renderer(BALANCED.render), placed_on_marker(load_model("mug"), 0.08)
    tracked, light = stage.tracked(GROUND, stage.pose(-90, 40)), stage.light(120, 40)
    renderer.render(Scene(tracked, model, Illumination((light,))))
    before, shadows = live_gl_objects(), renderer._models_on_video.shadows
    draws = shadows.renders
    for step in range(1, 5):
        renderer.render(
            Scene(tracked, model, Illumination((light,)), placement=Placement(1 + step / 10, step, (step / 100, 0.0)))
        )
    assert live_gl_objects() == before
    assert shadows.renders == draws + 4
    for _ in range(3):  # an equal one, whichever object
        renderer.render(Scene(tracked, model, Illumination((light,)), placement=Placement(1.4, 4, (0.04, 0.0))))
    assert shadows.renders == draws + 4


@pytest.mark.parametrize("shift_m", [(40.0, 0.0), (0.0, -5.0), (-0.2, -0.35)])  # beside, behind, around the camera
def test_out_of_the_picture_it_leaves_the_video_alone(make_renderer, stage, shift_m) -> None:
    renderer = make_renderer(BALANCED.render)
    image = stage.noise()
    tracked = stage.tracked(image, stage.pose(-90, 40))
    model = stage.placed(box((0.03, 0.03, 0.03)))
    renderer.render(
        Scene(tracked, model, Illumination((stage.light(90, 60),)), True, placement=Placement(1.0, 0.0, shift_m))
    )
    np.testing.assert_array_equal(renderer.read_bgr(), image)


def test_placements_keep_the_plane_and_are_finite() -> None:
    matrix = Placement(2.0, math.radians(90), (0.5, 0.25)).marker_from_placed
    np.testing.assert_allclose(matrix @ (0.1, 0, 0, 1), (0.5, 0.45, 0, 1), atol=1e-12)
    np.testing.assert_allclose(matrix @ (0, 0, 0.1, 1), (0.5, 0.25, 0.2, 1), atol=1e-12)
    up = direction_from_angles(0, math.pi / 2)
    np.testing.assert_allclose(matrix[:3, :3] @ up, 2 * up, atol=1e-12)
    for wrong in ((0.0, 0.0), (-1.0, 0.0), (math.nan, 0.0), (math.inf, 0.0), (1.0, math.nan)):
        with pytest.raises(ValueError, match="must be a number"):
            Placement(*wrong)
    with pytest.raises(ValueError, match="must be a number"):
        Placement(shift_m=(math.nan, 0.0))


def test_a_model_without_its_shadow_leaves_the_ground_as_it_is(make_renderer, stage) -> None:
    renderer = make_renderer()
    tracked = stage.tracked(150, stage.pose(-90, 45, 0.4))
    sun = Illumination((Light((1.0, 0.2, 1.0)),))
    pictures = []
    for shown in (Scene(tracked), Scene(tracked, stage.placed(box((0.03, 0.03, 0.03))), sun)):
        for casts_shadow in (True, False):
            pictures.append(stage.picture(renderer, dataclasses.replace(shown, casts_shadow=casts_shadow)).astype(int))
    bare, _, whole, without = pictures
    darker = (bare - whole).max(axis=2) > 10
    assert (darker & ((bare - without).max(axis=2) <= 1)).sum() > 200  # where the shadow was, there is none
    assert (np.abs(without - bare).max(axis=2) > 10).sum() > 200  # the model is there


def test_half_of_a_split_picture_is_the_video(make_renderer, stage) -> None:
    renderer = make_renderer()
    tracked = stage.tracked(stage.noise(), stage.pose(-90, 45, 0.4))
    whole = Scene(tracked, stage.placed(box((0.03, 0.03, 0.03))), Illumination((Light((1.0, 0.2, 1.0)),)))
    pictures = []
    for scene in (whole, dataclasses.replace(whole, is_split=True)):
        pictures.append(stage.picture(renderer, scene))
    middle = renderer.size[0] // 2
    assert (pictures[0][:, :middle] != tracked.frame.image_bgr[:, :middle]).any()
    np.testing.assert_array_equal(pictures[1][:, :middle], tracked.frame.image_bgr[:, :middle])
    np.testing.assert_array_equal(pictures[1][:, middle:], pictures[0][:, middle:])


def test_a_mirror_turns_the_picture_and_not_what_is_written_on_it(make_renderer, stage) -> None:
    renderer = make_renderer(size=(600, 400))
    tracked = stage.tracked(stage.noise(), stage.pose(-90, 45, 0.4))
    as_it_is = Scene(tracked, stage.placed(box((0.03, 0.03, 0.03))), Illumination((Light((1.0, 0.2, 1.0)),)))
    plate = Overlay(np.full((20, 30, 4), 255, np.uint8), 0, 0)
    pictures = []
    for is_mirrored in (False, True):
        renderer.render(dataclasses.replace(as_it_is, is_mirrored=is_mirrored, overlays=(plate,)))
        pictures.append(renderer.read_bgr())
    straight, turned = pictures
    assert (turned[:20, :30] == 255).all()
    below = slice(20, None)
    np.testing.assert_array_equal(turned[below], straight[below, ::-1])
    assert (straight[below] != straight[below, ::-1]).any()


@pytest.mark.parametrize("waits", [False, True])  # in this order: what is known by then is there at once
def test_a_model_that_moves_is_drawn_as_one_that_stands_there(make_renderer, stage, waits: bool) -> None:
    renderer = make_renderer()
    tracked = stage.tracked(150, stage.pose(-90, 45, 0.4))
    sun = Illumination((Light((1.0, 0.2, 1.0)),))
    still = box((0.03, 0.03, 0.03))
    low, high = (still.moved(1.0, np.array((x, 0, 0))) for x in (-0.03, 0.03))
    motion = Motion(np.stack([low.vertices, high.vertices]), np.stack([still.normals] * 2), 2.0)
    moving = stage.placed(dataclasses.replace(low, motion=motion))

    def drawn(model: PlacedModel, time_s: float) -> np.ndarray:
        scene = Scene(tracked, model, sun, time_s=time_s)
        renderer.render(scene, waits)
        while not renderer.is_settled:
            renderer.render(scene, waits)
        return renderer.read_bgr().astype(int)

    for time_s, x in ((0.0, -0.03), (0.5, -0.015), (3.0, 0.0)):
        there, pictured = drawn(stage.placed(still.moved(1.0, np.array((x, 0, 0)))), 0.0), drawn(moving, time_s)
        # The contact shadow of one that moves is the mean over its poses.
        assert (np.abs(there - pictured).max(axis=2) > 40).mean() < 2e-3
    assert (np.abs(drawn(moving, 0.0) - drawn(moving, 1.5)).max(axis=2) > 12).mean() > 0.01


def test_what_is_cut_out_gives_the_same_picture_over_the_video(make_renderer, stage) -> None:
    renderer = make_renderer(BALANCED.render)
    tracked = stage.tracked(stage.noise(), stage.pose(-90, 45, 0.4))
    sun = Illumination((Light((1.0, 0.2, 1.0)),))
    green = Material(base_colour=(0.0, 1.0, 0.0, 0.4), alpha=Alpha.BLEND)
    glass = dataclasses.replace(box((0.03, 0.03, 0.03)).moved(1.0, np.array((0.04, 0.0, 0.0))), material=green)
    whole = Scene(tracked, stage.placed(box((0.03, 0.03, 0.03)), glass), sun)
    wanted = stage.picture(renderer, whole).astype(float)
    for parts in ({}, {"shows_model": False}, {"casts_shadow": False}):
        scene = dataclasses.replace(whole, **parts)
        wanted = stage.picture(renderer, scene).astype(float)
        renderer.render(dataclasses.replace(scene, is_cut_out=True))
        cut_out = renderer.read_bgra().astype(float)
        alpha = cut_out[..., 3:] / 255
        over = cut_out[..., :3] * alpha + tracked.frame.image_bgr * (1 - alpha)
        assert np.abs(over - wanted).max() < 2
        assert (alpha == 0).mean() > 0.5
        if scene.shows_model:
            assert (alpha == 1).sum() > 500


def test_a_shadow_is_there_without_its_model(make_renderer, stage) -> None:
    renderer = make_renderer()
    tracked = stage.tracked(150, stage.pose(-90, 45, 0.4))
    black = stage.placed(box((0.03, 0.03, 0.03), (0.0, 0.0, 0.0, 1.0)))  # whose sides light none of the ground
    scene = Scene(tracked, black, Illumination((Light((1.0, 0.2, 1.0)),)))
    pictures = []
    for shows_model in (True, False):
        pictures.append(stage.picture(renderer, dataclasses.replace(scene, shows_model=shows_model)).astype(int))
    whole, shadow = pictures
    assert shadow.max() <= 150  # nothing but darker ground
    assert ((whole < 120) & (shadow < 120)).any(axis=2).sum() > 200
    assert (np.abs(whole - shadow).max(axis=2) > 10).sum() > 200
