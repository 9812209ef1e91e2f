"""What is measured of the video, and that the model takes it on."""

import math
from dataclasses import replace
from itertools import pairwise
from operator import ne
from statistics import NormalDist

import cv2
import numpy as np
import pytest

from ashe_live.bench.cube.painted_scene import level_of
from ashe_live.core.colour import linear_from_srgb, srgb_from_linear
from ashe_live.core.light import Light
from ashe_live.core.transforms import project
from ashe_live.core.types import Frame, MarkerPose, TrackedFrame
from ashe_live.models.primitives import box
from ashe_live.quality import BALANCED, FAST
from ashe_live.render.camera.edges import blur_and_sharpening, edge_blur_px
from ashe_live.render.camera.grain import has_coarse_chroma, noise_levels
from ashe_live.render.camera.held_look import CUT_S, LOOK_HELD_S, HeldLook
from ashe_live.render.camera.video_look import VideoLook, noise_of, sharpness_of
from ashe_live.render.camera.white import (
    ASSUMED_WHITE,
    BODY_PRINT_SHARE,
    EXPOSURE_SPREAD,
    INK_RATIO,
    INK_SPREAD,
    INK_TINT,
    PAPER_ALBEDO,
    WHITE_TINT,
    light_on_print,
    white_of,
)
from ashe_live.render.lights.lighting import lighting_of
from ashe_live.render.scene import Scene
from ashe_live.tracking.cube.faces import TAG_SHARE
from ashe_live.tracking.families.layout import cube_layout
from ashe_live.tracking.tracker import MarkerTracker
from tests.painted_cubes import CAMERA, EDGE_M, CubeScene, PaintedLight, frame_of, lamp, looking, sun

SIDE = 0.08
FINE = 4  # the printed sheet is drawn that much finer, then averaged


def _corners(half: float) -> np.ndarray:
    return half * np.array([(-1, 1, 0), (1, 1, 0), (1, -1, 0), (-1, -1, 0)], dtype=float)


def _sheet(
    stage,
    white: tuple[float, ...] = (0.7, 0.7, 0.7),
    blur: float = 0.0,
    noise: float = 0.0,
    ink: float | np.ndarray = 0.02,
    sharpening: float = 0.0,
    distance: float = 0.3,
) -> TrackedFrame:
    """A black square on paper of a linear RGB, on darker ground."""
    T_cam_marker = stage.pose(-80, 50, distance, target=(0, 0, 0))
    camera = stage.camera()
    canvas = np.full((camera.size[1] * FINE, camera.size[0] * FINE, 3), 0.25)
    for half, colour in ((0.72 * SIDE, np.array(white) * PAPER_ALBEDO), (SIDE / 2, np.full(3, ink))):
        outline = (project(camera, T_cam_marker, _corners(half)) + 0.5) * FINE - 0.5
        mask = cv2.fillConvexPoly(np.zeros(canvas.shape[:2], np.uint8), np.round(outline * 16).astype(int), 1, shift=4)
        canvas[mask > 0] = colour
    linear = cv2.resize(canvas, camera.size, interpolation=cv2.INTER_AREA)
    if blur:
        linear = cv2.GaussianBlur(linear, (0, 0), blur)
    encoded = srgb_from_linear(linear)
    encoded += sharpening * (encoded - cv2.GaussianBlur(encoded, (0, 0), 1.0))
    encoded = 255 * encoded + np.random.default_rng(1).normal(0, 1, linear.shape[:2])[..., None] * noise
    image = np.clip(np.round(encoded), 0, 255).astype(np.uint8)[..., ::-1]
    corners = project(camera, T_cam_marker, _corners(SIDE / 2))
    return TrackedFrame(
        Frame(np.ascontiguousarray(image), 3, 0.0), camera, MarkerPose(T_cam_marker, corners, SIDE, 0, None)
    )


def _sharpness(tracked: TrackedFrame) -> tuple[float, float]:
    return sharpness_of(tracked, white_of(tracked))


@pytest.mark.parametrize("white", [(0.7, 0.7, 0.7), (0.3, 0.3, 0.3), (0.9, 0.8, 0.6)])
def test_white_is_the_papers(stage, white: tuple[float, ...]) -> None:
    np.testing.assert_allclose(white_of(_sheet(stage, white)), white, rtol=0.02)


def test_white_of_overexposed_paper_is_measured_by_the_ink(stage) -> None:
    """Paper is at most 1 in the picture; ink goes on becoming brighter. It may be pale, so no more than half counts."""
    whites = [1.3, 1.6, 2.2]
    found = [white_of(_sheet(stage, (white,) * 3, ink=INK_RATIO * PAPER_ALBEDO * white))[1] for white in whites]
    least = 0.98 / PAPER_ALBEDO
    assert (np.diff([least, *found]) > 0).all()
    assert (np.diff(np.log(found)) < 0.5 * np.diff(np.log(whites))).all()


def test_overexposed_paper_is_on_the_whole_as_bright_as_it_is_found(stage) -> None:
    """Over exposures and inks as they are assumed to occur; no more than a twentieth for prints that might be pale."""
    quantiles = [NormalDist().inv_cdf(share) for share in (0.1, 0.3, 0.5, 0.7, 0.9)]
    overs = [NormalDist().inv_cdf(0.5 + share / 2) for share in (0.1, 0.3, 0.5, 0.7, 0.9)]
    errors = []
    for over in overs:
        paper = math.exp(EXPOSURE_SPREAD * over)
        for each in quantiles:
            ink = INK_RATIO * paper * math.exp(INK_SPREAD * each)
            found = white_of(_sheet(stage, (paper / PAPER_ALBEDO,) * 3, ink=ink))[1]
            errors.append(math.log(found * PAPER_ALBEDO / paper))
    assert abs(np.mean(errors)) < 0.06


def test_colour_of_overexposed_paper_errs_less_than_ink_or_none_would(stage) -> None:
    """Over cameras' whites and inks as they are assumed to occur: black print is tinted more than white is."""
    quantiles = [NormalDist().inv_cdf(share) for share in (0.1, 0.3, 0.5, 0.7, 0.9)]
    tints, errors, by_ink = [], [], []
    for white_tint in quantiles:
        for ink_tint in quantiles:
            white = 1.5 * np.exp(np.array([0.5, -0.5, 0]) * WHITE_TINT * white_tint)
            ink = INK_RATIO * PAPER_ALBEDO * white * np.exp(np.array([0.5, -0.5, 0]) * INK_TINT * ink_tint)
            found = white_of(_sheet(stage, tuple(white), ink=ink))
            tints.append(math.log(white[0] / white[1]))
            errors.append(math.log(found[0] / found[1]) - tints[-1])
            by_ink.append(math.log(ink[0] / ink[1]) - tints[-1])
    assert abs(np.mean(errors)) < 0.02
    assert np.std(errors) < 0.9 * min(np.std(tints), np.std(by_ink))


def test_overexposed_channels_are_no_darker_than_seen_and_the_others_as_they_are(stage) -> None:
    white = np.array([1.7, 1.3, 0.9])
    found = white_of(_sheet(stage, tuple(white), ink=0.12 * PAPER_ALBEDO * white))  # paler than print is as a rule
    assert found[2] == pytest.approx(0.9, rel=0.02)
    assert min(found[:2]) > 0.98 / PAPER_ALBEDO


def test_pale_print_is_no_overexposure(stage) -> None:
    found = white_of(_sheet(stage, (1.25,) * 3, ink=0.25))
    np.testing.assert_allclose(found, 1.25, rtol=0.06)


@pytest.mark.parametrize("distance", [0.3, 0.5, 0.7])
def test_sharpening_makes_paper_no_brighter(stage, distance: float) -> None:
    found = white_of(_sheet(stage, blur=0.5, sharpening=1.0, distance=distance))
    np.testing.assert_allclose(found, 0.7, rtol=0.04)


def test_white_is_assumed_where_there_is_no_paper(stage) -> None:
    assert white_of(stage.tracked(120, stage.pose(-80, 50))) == (ASSUMED_WHITE,) * 3


@pytest.mark.parametrize("blur", [0.0, 0.6, 1.0, 1.6, 2.2])
def test_blur_is_measured_at_the_markers_edges(stage, blur: float) -> None:
    assert _sharpness(_sheet(stage, blur=blur, noise=1.0))[0] == pytest.approx(blur, abs=0.2)


@pytest.mark.parametrize("over", [1.1, 1.2, 1.3])  # brightness of the paper over what the picture can show
@pytest.mark.parametrize("blur", [0.3, 0.5, 0.8, 1.2])
def test_overexposed_paper_has_edges_as_soft_as_the_lens_made_them(stage, blur: float, over: float) -> None:
    """A half of such an edge is cut off by the picture's white, which leaves it steeper."""
    tracked = _sheet(stage, (over / PAPER_ALBEDO,) * 3, ink=INK_RATIO * over, blur=blur, noise=1.0)
    assert _sharpness(tracked)[0] == pytest.approx(blur, abs=0.15)
    unknown = sharpness_of(tracked, (1.0 / PAPER_ALBEDO,) * 3)[0]
    assert unknown < _sharpness(tracked)[0] - 0.04


def test_shaded_paper_has_its_own_edges_however_bright_lit_paper_is(stage) -> None:
    shaded = _sheet(stage, blur=0.6)
    assert sharpness_of(shaded, (1.6,) * 3) == sharpness_of(shaded, (0.7,) * 3)


@pytest.mark.parametrize("noise", [1.0, 3.0, 8.0])
def test_noise_is_measured_around_the_marker(stage, noise: float) -> None:
    dark, dim, *_ = noise_of(_sheet(stage, noise=noise))
    # Black ink is clipped where it would be darker than black.
    assert dim * 255 == pytest.approx(noise, rel=0.2, abs=0.3)
    assert dark <= dim * 1.2


def test_noise_goes_with_brightness() -> None:
    """As a sensor's does: four strips of grey, each with noise of its own."""
    greys, sigmas = np.array([30, 100, 150, 220]), np.array([1.5, 3.0, 4.0, 6.0])
    noise = np.random.default_rng(5).normal(0, 1, (60, 4, 60)) * sigmas[:, None]
    picture = np.round(greys[:, None] + noise).reshape(60, 240).astype(np.uint8)
    np.testing.assert_allclose(np.array(noise_levels(picture)) * 255, sigmas, rtol=0.15)


def test_a_brightness_that_does_not_occur_has_the_nearest_ones_noise() -> None:
    noise = np.random.default_rng(5).normal(0, 4, (100, 100))
    dark, dim, light, bright = noise_levels(np.round(160 + noise).astype(np.uint8))
    assert dark == dim == light == bright > 0


def test_in_a_picture_of_nothing_but_edges_no_noise_is_measured() -> None:
    ramp = np.tile(np.arange(0, 240, 8, dtype=np.uint8), (30, 1))
    assert noise_levels(ramp) == (0, 0, 0, 0)


@pytest.mark.parametrize(("blur", "amount"), [(0.0, 0.0), (0.4, 0.0), (0.9, 0.0), (1.6, 0.0), (0.4, 0.5), (0.4, 1.2)])
def test_sharpening_is_measured_at_the_markers_edges(stage, blur: float, amount: float) -> None:
    tracked = _sheet(stage, blur=blur)
    grey = cv2.cvtColor(tracked.frame.image_bgr, cv2.COLOR_BGR2GRAY).astype(float)
    sharp = grey + amount * (grey - cv2.GaussianBlur(grey, (0, 0), 1.0))
    picture = np.clip(np.round(sharp), 0, 255).astype(np.uint8)
    sigma_px, found = blur_and_sharpening(picture, tracked.marker.corners_px)
    assert found == pytest.approx(amount, rel=0.3, abs=0.15)
    assert sigma_px == pytest.approx(blur, abs=0.3)


def test_models_edges_are_as_soft_as_the_markers(make_renderer, stage) -> None:
    """A white sheet in the marker's place has edges to the dark ground that the same measure finds as blurred."""
    tracked = _sheet(stage, (0.25, 0.25, 0.25), blur=1.4)
    model = stage.placed(box((SIDE, SIDE, 0.0), (0.0, 0.0, 0.0, 1.0)))
    picture = stage.picture(make_renderer(BALANCED.render), Scene(tracked, model))
    grey = cv2.cvtColor(picture, cv2.COLOR_BGR2GRAY)
    # The sharp paper around it is left as it is; what the model covers is the whole of the square.
    assert edge_blur_px(grey, tracked.marker.corners_px) == pytest.approx(1.4, abs=0.5)


@pytest.mark.parametrize("repeats", [True, False])
def test_coarse_chroma_is_distinguished_from_colours_of_every_pixel(repeats: bool) -> None:
    rng = np.random.default_rng(3)
    ycrcb = rng.integers(90, 160, (80, 80, 3), dtype=np.uint8)
    coarse = np.ascontiguousarray(ycrcb[::2, ::2, 1:])
    how = cv2.INTER_NEAREST if repeats else cv2.INTER_LINEAR
    assert not has_coarse_chroma(cv2.cvtColor(ycrcb, cv2.COLOR_YCrCb2BGR))
    ycrcb[..., 1:] = cv2.resize(coarse, (80, 80), interpolation=how)
    assert has_coarse_chroma(cv2.cvtColor(ycrcb, cv2.COLOR_YCrCb2BGR))


def test_in_a_picture_without_colour_no_chroma_blur_is_measured() -> None:
    grey = np.random.default_rng(3).integers(0, 255, (80, 80, 1), dtype=np.uint8)
    assert not has_coarse_chroma(np.repeat(grey, 3, axis=2))


def test_what_is_drawn_is_sharpened_as_the_video_is(make_renderer, stage) -> None:
    """A grey sheet in the marker's place: beside its edge it overshoots where the marker's own edges do."""
    plain = _sheet(stage, (0.25, 0.25, 0.25), blur=0.4)
    grey = plain.frame.image_bgr.astype(float)
    sharp = np.clip(np.round(grey + 1.0 * (grey - cv2.GaussianBlur(grey, (0, 0), 1.0))), 0, 255).astype(np.uint8)
    model = stage.placed(box((SIDE, SIDE, 0.0), (0.0, 0.0, 0.0, 1.0)))
    found = []
    for image in (plain.frame.image_bgr, sharp):
        renderer = make_renderer(BALANCED.render)
        renderer.render(Scene(replace(plain, frame=Frame(image, 0, 0.0)), model))
        picture = cv2.cvtColor(renderer.read_bgr(), cv2.COLOR_BGR2GRAY)
        found.append(blur_and_sharpening(picture, plain.marker.corners_px)[1])
    assert found[0] == 0
    assert found[1] > 0.5


def test_models_noise_is_the_videos_and_new_in_every_frame(make_renderer, stage) -> None:
    renderer = make_renderer(BALANCED.render)
    tracked = _sheet(stage, noise=4.0)
    model = stage.placed(box((SIDE, SIDE, 0.0), (0.3, 0.3, 0.3, 1.0)))
    inside = np.zeros((360, 480), np.uint8)
    outline = project(tracked.camera, tracked.marker.T_cam_marker, _corners(0.4 * SIDE))
    cv2.fillConvexPoly(inside, np.round(outline).astype(int), 1)
    pictures = []
    for index in (0, 1):
        frame = Frame(tracked.frame.image_bgr, index, 0.0)
        renderer.render(Scene(TrackedFrame(frame, tracked.camera, tracked.marker), model))
        pictures.append(renderer.read_bgr().astype(float))
        assert pictures[-1][inside > 0].std() == pytest.approx(noise_of(tracked)[2] * 255, rel=0.25)
    assert (pictures[0] - pictures[1])[inside > 0].std() > 4.0
    far = cv2.dilate(inside, np.ones((61, 61))) == 0
    np.testing.assert_array_equal(pictures[0][far], tracked.frame.image_bgr[far])
    quiet = make_renderer(replace(FAST.render, matches_noise=False))
    assert stage.picture(quiet, Scene(tracked, model))[inside > 0].std() < 0.5


def test_exposure_and_white_balance_follow_the_camera(make_renderer, stage) -> None:
    renderer = make_renderer(FAST.render)
    model = stage.placed(box((SIDE, SIDE, 0.0), (0.5, 0.5, 0.5, 1.0)))
    for white in ((0.9, 0.9, 0.9), (0.4, 0.4, 0.4), (0.8, 0.7, 0.5)):
        tracked = _sheet(stage, white)
        picture = stage.picture(renderer, Scene(tracked, model))
        shown = linear_from_srgb(stage.rgb_at(picture, tracked, (0, 0, 0)) / 255)
        np.testing.assert_allclose(shown, 0.5 * np.array(white), rtol=0.04)


def test_of_a_cube_the_paper_on_its_top_is_white() -> None:
    assert BODY_PRINT_SHARE == TAG_SHARE
    scene = CubeScene(CAMERA, looking(0.35, 30, 40), [sun(200, 40)], blur_px=0.9)
    tracked = MarkerTracker(cube_layout(), CAMERA, EDGE_M, BALANCED.tracking).track(frame_of(scene))
    # The picture is exposed so that white in the open table's light has this level.
    assert np.mean(white_of(tracked)) == pytest.approx(scene.exposure, rel=0.1)
    assert _sharpness(tracked)[0] == pytest.approx(0.9, abs=0.3)


def _white_beside_cube(light: PaintedLight) -> float:
    """How bright fully lit white is found to be over its true level, where the light and the cube are known."""
    scene = CubeScene(CAMERA, looking(0.35, 30, 40), [light], blur_px=0.9)
    tracked = MarkerTracker(cube_layout(), CAMERA, EDGE_M, BALANCED.tracking).track(frame_of(scene))
    assert tracked.marker is not None
    place, inverse_distance = light.point[:3], light.point[3] / np.linalg.norm(light.point[:3])
    known = Light(place, shadow_rgb_ratio=scene.sky_rgb / level_of(scene), inverse_distance=inverse_distance)
    on_print = light_on_print(tracked, lighting_of((known,)), tracked.marker.body)
    return float(np.mean(white_of(tracked, on_print))) / scene.exposure


def test_a_cube_does_not_shade_the_paper_on_its_own_top() -> None:
    assert _white_beside_cube(sun(200, 40)) == pytest.approx(1.0, rel=0.1)


def test_a_cubes_paper_is_nearer_to_a_lamp_than_its_table() -> None:
    """High above it, as the painter lights all of a face as its middle."""
    assert _white_beside_cube(lamp(sun(200, 85), 0.25)) == pytest.approx(1.0, rel=0.1)


@pytest.mark.parametrize("apart_s", [0.03, 0.15, 0.9 * CUT_S])
def test_exposure_stays_while_the_paper_is_covered(stage, apart_s: float) -> None:
    """Also in a video of few frames a second, as by a webcam in dim light."""
    seen, covered = _sheet(stage, white=(0.5, 0.6, 0.7)), stage.tracked(120, stage.pose(-80, 50))
    unlit, held = lighting_of((), None), HeldLook(BALANCED.render)
    for number, scene in enumerate([seen, *[covered] * 5]):
        frame = Frame(scene.frame.image_bgr, number, number * apart_s)
        look = held.at(TrackedFrame(frame, seen.camera, seen.marker), unlit, None)
        assert look.white_rgb == pytest.approx(white_of(seen), rel=1e-9)
    # After a cut nothing is known of it.
    frame = Frame(covered.frame.image_bgr, 6, 5 * apart_s + CUT_S + 1e-6)
    assert held.at(TrackedFrame(frame, seen.camera, seen.marker), unlit, None).white_rgb == (ASSUMED_WHITE,) * 3


def test_what_is_saved_beside_a_window_has_the_look_of_the_video_that_is_shown_now(make_renderer, stage) -> None:
    """Though by its time the next video's frame might follow that of the one before."""
    window, model = make_renderer(FAST.render), stage.placed(box((SIDE, SIDE, 0.0), (0.0, 0.5, 0.0, 1.0)))
    scenes = []
    for seen, time_s in ((_sheet(stage, blur=2.0), 0.0), (_sheet(stage), LOOK_HELD_S / 2)):
        frame = Frame(seen.frame.image_bgr, 3, time_s)
        scenes.append(Scene(TrackedFrame(frame, seen.camera, seen.marker), model))
    saved, fresh = window.beside(window.size), make_renderer(FAST.render)
    saved.render(scenes[0])
    window.begin_anew()
    for renderer in (saved, fresh):
        renderer.render(scenes[1])
    np.testing.assert_array_equal(saved.read_bgr(), fresh.read_bgr())
    saved.release()


def test_of_a_video_that_flows_on_the_exposure_follows_and_one_other_part_is_measured_a_frame(stage) -> None:
    before, after = _sheet(stage, noise=1.0), _sheet(stage, white=(0.5, 0.5, 0.5), blur=1.5, noise=6.0)
    unlit, held = lighting_of((), None), HeldLook(BALANCED.render)

    def seen_at(time_s: float, scene: TrackedFrame) -> VideoLook:
        frame = Frame(scene.frame.image_bgr, 0, time_s)
        return held.at(TrackedFrame(frame, scene.camera, scene.marker), unlit, None)

    def parts(look: VideoLook) -> list[object]:
        return [(look.blur_sigma_px, look.sharpening), look.noise_sigmas]

    first = seen_at(0.0, before)
    whole = [_sharpness(after), noise_of(after)]
    looks = [first, *(seen_at(k / 60, after) for k in range(1, 30))]
    changes = [sum(map(ne, parts(a), parts(b))) for a, b in pairwise(looks)]
    assert max(changes) == 1
    assert parts(looks[math.ceil((LOOK_HELD_S + 2 / 60) * 60)]) == whole
    assert parts(first) == [_sharpness(before), noise_of(before)]
    assert first.white_rgb == pytest.approx(white_of(before), rel=1e-9)
    for look in looks[1:]:
        assert look.white_rgb == pytest.approx(white_of(after), rel=0.002)
    # After a cut, as after a step through a clip, and from one photo to the next, all of it is measured at once.
    assert parts(seen_at(29 / 60 + CUT_S + 1e-6, before)) == parts(first)
    assert parts(seen_at(0.0, after)) == whole
    assert parts(seen_at(0.0, before)) == parts(first)
