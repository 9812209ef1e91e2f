"""The renderer as a whole: what is uploaded when, sizes, presets, lenses, and that nothing is kept."""

from dataclasses import replace

import cv2
import numpy as np
import pytest

from ashe_live.core.arrays import Image
from ashe_live.core.camera import Camera
from ashe_live.core.light import Illumination, Light
from ashe_live.core.transforms import project
from ashe_live.errors import UserError
from ashe_live.models.catalogue import load_model, model_names
from ashe_live.models.placement import placed_on_marker
from ashe_live.models.primitives import box
from ashe_live.quality import ACCURATE, BALANCED, FAST
from ashe_live.render.gl.offscreen import graphics_failures_reported, live_gl_objects
from ashe_live.render.passes.frame_texture import FrameTexture
from ashe_live.render.passes.surface import Surface, supported_samples
from ashe_live.render.passes.video import Video
from ashe_live.render.renderer import SceneRenderer
from ashe_live.render.scene import Overlay, Scene


@pytest.fixture
def uploads(monkeypatch) -> list[Image]:
    """The frames that are uploaded from now on."""
    uploaded, write = [], FrameTexture.write

    def noted(texture: FrameTexture, image_bgr: Image) -> None:
        uploaded.append(image_bgr)
        write(texture, image_bgr)

    monkeypatch.setattr(FrameTexture, "write", noted)
    return uploaded


def test_frame_is_uploaded_once_however_often_it_is_shown(make_renderer, stage, uploads) -> None:
    renderer = make_renderer()
    first, second = stage.tracked(stage.noise(1), None), stage.tracked(stage.noise(2), None)
    for tracked in (first, first, first, second, second):
        np.testing.assert_array_equal(stage.picture(renderer, Scene(tracked)), tracked.frame.image_bgr)
    assert len(uploads) == 2


def test_shadow_map_is_drawn_only_for_a_new_light_or_model(make_renderer, stage) -> None:
    renderer = make_renderer()
    model = stage.placed(box((0.03, 0.03, 0.03)))
    for azimuth_deg in (0, 20, 40):  # the camera moves
        renderer.render(
            Scene(stage.tracked(90, stage.pose(azimuth_deg, 40)), model, Illumination((stage.light(10, 30),)))
        )
    assert renderer._models_on_video.shadows.renders == 1
    renderer.render(Scene(stage.tracked(90, stage.pose(0, 40)), model, Illumination((stage.light(11, 30),))))
    assert renderer._models_on_video.shadows.renders == 2
    renderer.render(
        Scene(stage.tracked(90, stage.pose(0, 40)), stage.placed(box((1, 1, 1))), Illumination((stage.light(11, 30),)))
    )
    assert renderer._models_on_video.shadows.renders == 3


def test_picture_does_not_depend_on_what_was_drawn_before(make_renderer, stage) -> None:
    model, other = stage.placed(box((0.03, 0.03, 0.03))), stage.placed(box((0.06, 0.02, 0.05)))
    scene = Scene(
        stage.tracked(stage.noise(), stage.pose(30, 40)), model, Illumination((stage.light(10, 30),)), shows_light=True
    )
    fresh = make_renderer()
    fresh.render(scene)
    used = make_renderer(ACCURATE.render, (64, 48))
    used.render(Scene(stage.tracked(3, stage.pose(90, 70)), other, Illumination((stage.light(70, 80),))))
    used.render(Scene())
    used.preset = FAST.render
    used.resize((480, 360))
    np.testing.assert_array_equal(stage.picture(used, scene), fresh.read_bgr())


@pytest.mark.parametrize("quality", [FAST, BALANCED, ACCURATE], ids=lambda quality: quality.name)
def test_shadows_of_former_models_and_lights_leave_nothing_behind(make_renderer, stage, quality) -> None:
    """In a picture that is smaller than the depth maps, and with the passes of every preset between them."""
    renderer, tracked = make_renderer(quality.render), stage.tracked(stage.noise(), stage.pose(30, 40))
    tall, flat = stage.placed(box((0.02, 0.02, 0.09))), stage.placed(box((0.08, 0.08, 0.01)))
    for model, azimuth_deg in ((tall, 10), (flat, 100), (tall, 200), (flat, 10)):
        scene = Scene(tracked, model, Illumination((stage.light(azimuth_deg, 30), stage.light(azimuth_deg + 50, 60))))
        renderer.render(scene)
        np.testing.assert_array_equal(renderer.read_bgr(), stage.picture(make_renderer(quality.render), scene))


def test_without_a_marker_there_is_only_video(make_renderer, stage) -> None:
    renderer = make_renderer(BALANCED.render)
    image = stage.noise()
    renderer.render(
        Scene(stage.tracked(image, None), stage.placed(box((1, 1, 1))), Illumination((stage.light(0, 40),)))
    )
    np.testing.assert_array_equal(renderer.read_bgr(), image)


def test_without_video_the_picture_is_black(make_renderer, stage) -> None:
    renderer = make_renderer()
    renderer.render(Scene(stage.tracked(200, None)))
    assert not stage.picture(renderer, Scene()).any()


@pytest.mark.parametrize("size", [(960, 360), (480, 720), (1, 1), (7, 300)])
def test_video_is_letterboxed_on_black(make_renderer, stage, size: tuple[int, int]) -> None:
    renderer = make_renderer(size=size)
    renderer.render(Scene(stage.tracked(150, stage.pose(0, 40)), stage.placed(box((0.03, 0.03, 0.03)))))
    picture = renderer.read_bgr()
    assert picture.shape == (size[1], size[0], 3)
    if size == (960, 360):
        assert not picture[:, :240].any()
        assert not picture[:, 720:].any()
        assert (picture[:, 240] == 150).all()
        assert (picture[:, 719] == 150).all()


@pytest.mark.parametrize("side", [3, 4, 5])
def test_a_large_picture_in_a_small_window_is_the_mean_of_its_pixels(make_renderer, stage, uploads, side: int) -> None:
    """And no moire of a fine weave, of which some pixels are looked up and others are not."""
    weave = (np.indices((360 * 4, 480 * 4)).sum(axis=0) % side == 0) * np.uint8(255)
    tracked = stage.tracked(np.ascontiguousarray(weave[..., None].repeat(3, axis=2)), None)
    renderer = make_renderer()
    for _ in range(2):
        seen = stage.picture(renderer, Scene(tracked)).astype(float)
        blocks = weave.reshape(360, 4, 480, 4).mean(axis=(1, 3))
        np.testing.assert_allclose(seen, blocks[..., None].repeat(3, axis=2), atol=1)
    assert len(uploads) == 1


def test_model_stays_on_its_marker_at_every_window_size(make_renderer, stage) -> None:
    tracked = stage.tracked(20, stage.pose(-90, 40))
    model = stage.placed(box((0.03, 0.03, 0.03), (1, 1, 1, 1)))
    first = None
    for size in ((480, 360), (1200, 360), (240, 180), (960, 720)):
        picture = stage.picture(make_renderer(size=size), Scene(tracked, model))
        rows, columns = np.nonzero(picture[..., 1] > 60)
        scale = min(size[0] / 480, size[1] / 360)
        left = (size[0] - 480 * scale) / 2
        place = np.array([columns.mean() + 0.5 - left, rows.mean() + 0.5]) / scale
        first = place if first is None else first
        np.testing.assert_allclose(place * scale, first * scale, atol=0.6)


def test_minimised_window_is_survived(make_renderer, stage) -> None:
    renderer = make_renderer()
    renderer.resize((0, 0))
    renderer.render(Scene(stage.tracked(150, None)))
    assert renderer.size == (1, 1)


def test_the_video_as_a_pinhole_camera_shows_it_is_freed_of_the_lens(ctx, stage) -> None:
    """A dot that the lens put somewhere else is shown where a pinhole camera, and so the model, has it."""
    camera = Camera((480, 360), stage.camera().K, np.array([-0.25, 0.08, 0.002, -0.001, 0.0]), "file")
    T_cam_marker = stage.pose(-90, 40)
    point = np.array([(0.12, -0.05, 0.0)])
    rvec = cv2.Rodrigues(T_cam_marker[:3, :3])[0]
    bent = cv2.projectPoints(point, rvec, T_cam_marker[:3, 3], camera.K, camera.dist)[0].ravel()
    straight = project(camera, T_cam_marker, point)[0]
    assert np.linalg.norm(bent - straight) > 3
    rows, columns = np.mgrid[0:360, 0:480]
    dot = 255 * np.exp(-((columns - bent[0]) ** 2 + (rows - bent[1]) ** 2) / 18)
    image = np.repeat(dot.astype(np.uint8)[..., None], 3, axis=2)
    whole = (0, 0, 480, 360)
    surface, video = Surface(ctx, (480, 360), 0), Video(ctx)
    video.show(stage.tracked(image, T_cam_marker, camera), whole, camera)
    video.copy_or_draw(surface.colour, whole)
    shown = surface.read_bgr()[..., 0].astype(float)
    ctx.detect_framebuffer(0).use()  # what is bound must not be released
    for held in (video, surface):
        held.release()
    centre = np.array([(shown * columns).sum(), (shown * rows).sum()]) / shown.sum()
    np.testing.assert_allclose(centre, straight, atol=0.2)


def test_switching_models_and_presets_keeps_no_gl_objects(ctx, make_renderer, stage) -> None:
    renderer = make_renderer()
    models = [placed_on_marker(load_model(name), 0.08) for name in model_names()[:3]]

    def switch(rounds: int) -> None:
        for turn in range(rounds):
            tracked = stage.tracked(stage.noise(turn), stage.pose(10 * turn, 40))
            overlay = Overlay(np.zeros((4, 4, 4), np.uint8), 0, 0)
            for model in models:
                renderer.render(Scene(tracked, model, Illumination((stage.light(20 * turn, 40),)), True, (overlay,)))
            renderer.preset = FAST.render if turn % 2 else BALANCED.render
            renderer.resize((480, 360 + turn % 2))

    switch(4)
    ctx.gc_mode = "context_gc"  # collects what Python drops without its being released
    try:
        before = live_gl_objects()
        ctx.objects.clear()
        switch(2)
        assert live_gl_objects() == before
        assert all(type(dropped).__name__ == "InvalidObject" for dropped in ctx.objects)  # released before
    finally:
        ctx.gc_mode = None


def test_multisampling_smooths_edges_only(ctx, make_renderer, stage) -> None:
    if supported_samples(4, ctx.max_samples) == 0:
        pytest.skip("this OpenGL has one sample a pixel")
    scene = Scene(stage.tracked(0, stage.pose(-70, 40)), stage.placed(box((0.05, 0.05, 0.05))))
    rough, smooth = make_renderer(FAST.render), make_renderer(BALANCED.render.with_samples(4))
    a, b = (stage.picture(renderer, scene)[..., 0].astype(int) for renderer in (rough, smooth))
    differs = a != b
    edges = cv2.dilate(cv2.morphologyEx(a.astype(np.uint8), cv2.MORPH_GRADIENT, np.ones((3, 3))), np.ones((3, 3))) > 0
    assert differs.sum() > 50
    assert not differs[~edges].any()


@pytest.mark.parametrize(
    ("wanted", "available", "given"), [(8, 4, 4), (8, 32, 8), (4, 3, 2), (0, 8, 0), (4, 0, 0), (4, 1, 0), (16, 6, 4)]
)
def test_samples_fall_back_to_what_there_is(wanted: int, available: int, given: int) -> None:
    assert supported_samples(wanted, available) == given


def test_presenting_copies_the_picture(ctx, make_renderer, stage) -> None:
    renderer = make_renderer()
    image = stage.noise()
    renderer.render(Scene(stage.tracked(image, None)))
    window = ctx.simple_framebuffer((480, 360))
    renderer.present(window)
    shown = np.frombuffer(window.read(components=3, alignment=1), np.uint8).reshape(360, 480, 3)[::-1, :, ::-1]
    window.release()
    np.testing.assert_array_equal(shown, image)


def _sign_px(stage, renderer: SceneRenderer, scene: Scene) -> np.ndarray:
    """(2,) the middle of what the light's sign changes in the picture."""
    without, shown = (stage.picture(renderer, replace(scene, shows_light=each)) for each in (False, True))
    rows, columns = np.nonzero((without != shown).any(axis=2))
    assert len(rows) > 50
    return np.array([columns.mean(), rows.mean()])


def test_arrow_comes_from_the_light(make_renderer, stage) -> None:
    renderer = make_renderer()
    model = stage.placed(box((0.03, 0.03, 0.03)))
    tracked = stage.tracked(90, stage.pose(-90, 89, 0.5, target=(0, 0, 0)))
    foot = project(tracked.camera, tracked.marker.T_cam_marker, [(0, 0, 0.015)])[0]
    for azimuth_deg in (0, 90, 200):
        scene = Scene(tracked, model, Illumination((stage.light(azimuth_deg, 20),)))
        right, down = _sign_px(stage, renderer, scene) - foot
        bearing_deg = np.degrees(np.arctan2(-down, right))
        assert abs((bearing_deg - azimuth_deg + 180) % 360 - 180) < 8


def test_a_lamp_in_view_has_a_bulb_in_its_place(make_renderer, stage) -> None:
    """Round about the lamp; out of view it is an arrow from where the lamp is, seen from the model."""
    renderer = make_renderer()
    model = stage.placed(box((0.03, 0.03, 0.03)))
    tracked = stage.tracked(90, stage.pose(-90, 60, 0.5, target=(0, 0, 0.05)))
    for place in ((0.1, 0.05, 0.1), (-0.08, -0.02, 0.12), (0.0, 0.0, 0.1), (2.0, 0.1, 1.0), (-1.0, -0.8, 0.3)):
        lamp = Light(place, inverse_distance=1 / np.linalg.norm(place), radius_m=0.01)
        seen_px = _sign_px(stage, renderer, Scene(tracked, model, Illumination((lamp,))))
        expected = np.array(place)
        if np.linalg.norm(place) > 1:
            from_model = expected - (0, 0, 0.015)
            expected = (0, 0, 0.015) + 0.04 * from_model / np.linalg.norm(from_model)
        (expected_px,) = project(tracked.camera, tracked.marker.T_cam_marker, [expected])
        assert np.hypot(*(expected_px - seen_px)) < 12


def test_a_driver_without_memory_left_is_reported_once_and_in_one_line(ctx, make_renderer, stage) -> None:
    renderer = make_renderer()
    renderer.render(Scene(stage.tracked(90, None)))
    renderer.finish()
    ctx.buffer(reserve=2**62).release()  # a GPU's driver takes 64 TB for a promise that need not be kept
    with (
        pytest.raises(UserError, match=r"the graphics driver failed \(GL_OUT_OF_MEMORY\)"),
        graphics_failures_reported(),
    ):
        renderer.finish()
    renderer.finish()
