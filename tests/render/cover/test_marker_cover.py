"""The marker's sheet is covered by ground like that around it, which stays where it is and takes shadows."""

import itertools
import pickle
from dataclasses import replace

import cv2
import numpy as np
import pytest

from ashe_live.core.camera import Camera
from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT, srgb_from_linear
from ashe_live.core.light import Illumination, Light
from ashe_live.core.proxy import Proxy
from ashe_live.core.square import square_corners
from ashe_live.core.transforms import project, raycast_to_plane
from ashe_live.core.types import Frame, MarkerPose, TrackedFrame
from ashe_live.models.primitives import box
from ashe_live.quality import BALANCED, FAST
from ashe_live.render.camera.exposure import gain_and_slope
from ashe_live.render.camera.in_frame import project_distorted
from ashe_live.render.cover import cover_maker
from ashe_live.render.cover.ground_cover import DRAFT_SIDE_PX, HALF_SIDES, MOST_AROUND, GroundCover, ground_cover
from ashe_live.render.cover.marker_cover import MarkerCover
from ashe_live.render.cover.rectified import rectified
from ashe_live.render.cover.sheet import LEAST_HALF_SIDES, sheet_of
from ashe_live.render.scene import Scene

SIDE = 0.08
PAPER_HALF = 0.62 * SIDE
RATIO = (0.3, 0.4, 0.5)
MADE: dict[bytes, GroundCover | None] = {}


def known_cover(tracked: TrackedFrame, illumination: Illumination, is_draft: bool = False) -> GroundCover | None:
    """The cover of a picture that several tests show is made once: most are about what becomes of it."""
    asked = pickle.dumps((tracked, replace(illumination, seen_in=None), is_draft))
    if asked not in MADE:
        MADE[asked] = ground_cover(tracked, illumination, is_draft)
    return MADE[asked]


@pytest.fixture(autouse=True)
def _covers_made_once(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cover_maker, "ground_cover", known_cover)


def _ground(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """(..., 3) linear RGB of boards with a fine grain."""
    grain = 0.04 * np.sin(900 * y + 3 * np.sin(60 * x)) + 0.03 * np.sin(210 * y) + 0.02 * np.sin(70 * x)
    return np.stack([0.42 + grain, 0.28 + 0.7 * grain, 0.16 + 0.4 * grain], axis=-1)


def _view(
    stage,
    has_sheet: bool = True,
    shaded=None,
    noise: float = 0.0,
    index: int = 0,
    gain: float = 1.0,
    sheen: float = 0.0,
    target: tuple[float, ...] = (0, 0, 0),
    distance: float = 0.36,
):
    """A frame of the ground with a printed sheet on it; `shaded` (points) -> True where a shadow lies.

    sheen: how the logarithm of brightness changes along x (1/m).
    """
    T = stage.pose(-80, 55, distance, target=target)
    camera = stage.camera()
    rows, columns = np.mgrid[0:360, 0:480]
    pixels = np.column_stack([columns.ravel(), rows.ravel()]).astype(float)
    x, y, _ = raycast_to_plane(camera, T, pixels).T
    linear = _ground(x, y)
    if has_sheet:
        away = np.maximum(np.abs(x), np.abs(y))
        linear[away < PAPER_HALF] = 0.75
        linear[away < SIDE / 2] = 0.03
    if shaded is not None:
        linear[shaded(x, y)] *= RATIO
    linear *= np.exp(sheen * x)[:, None]
    picture = 255 * srgb_from_linear(np.clip(gain * linear, 0, 1)).reshape(360, 480, 3)[..., ::-1]
    picture = cv2.GaussianBlur(picture, (0, 0), 0.6)
    picture += np.random.default_rng(index).normal(0, 1, picture.shape) * noise
    corners = project(camera, T, SIDE / 2 * np.array([(-1, 1, 0), (1, 1, 0), (1, -1, 0), (-1, -1, 0)], float))
    frame = Frame(np.ascontiguousarray(np.clip(np.round(picture), 0, 255).astype(np.uint8)), index, index / 30)
    return TrackedFrame(frame, camera, MarkerPose(T, corners, SIDE, 0.0, None))


def _on_sheet(tracked: TrackedFrame, margin_m: float = 0.0) -> np.ndarray:
    """(h, w) where the sheet is, grown by a margin."""
    half = PAPER_HALF + margin_m
    corners = project(
        tracked.camera, tracked.marker.T_cam_marker, half * np.array([(-1, 1, 0), (1, 1, 0), (1, -1, 0), (-1, -1, 0)])
    )
    mask = np.zeros((360, 480), np.uint8)
    cv2.fillConvexPoly(mask, np.round(corners).astype(np.int32), 1)
    return mask > 0


def _difference(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """(h, w) CIE 1976 colour difference of what is alike after a blur: grain may lie elsewhere."""
    labs = [cv2.cvtColor(cv2.GaussianBlur(np.float32(each) / 255, (0, 0), 2), cv2.COLOR_BGR2LAB) for each in (a, b)]
    return np.linalg.norm(labs[0] - labs[1], axis=2)


# Beside the marker and low, so that it hides nothing of the sheet: a model must stand there for anything to be drawn.
def _aside(stage):
    return stage.placed(box((0.01, 0.01, 0.01)).moved(1.0, np.array((-0.075, 0.06, 0.0))))


def test_sheet_is_covered_by_ground_like_that_around_it(make_renderer, stage) -> None:
    tracked, bare = _view(stage, noise=0.7), _view(stage, has_sheet=False)
    picture = stage.picture(make_renderer(BALANCED.render), Scene(tracked, _aside(stage), covers_marker=True))
    around = _on_sheet(tracked, 0.008)
    assert _difference(picture, bare.frame.image_bgr)[around].mean() < 3
    assert _difference(tracked.frame.image_bgr, bare.frame.image_bgr)[around].mean() > 20
    # Its grain, too: neither a smooth patch nor a wilder one.
    deviations = [each[around].std(axis=0).mean() for each in (picture.astype(float), bare.frame.image_bgr)]
    assert 0.6 < deviations[0] / deviations[1] < 1.4
    far = ~_on_sheet(tracked, 0.03)
    far[:150, :220] = False  # the model
    np.testing.assert_array_equal(picture[far], tracked.frame.image_bgr[far])


def _through_lens(straight: TrackedFrame, dist: tuple[float, ...]) -> TrackedFrame:
    """The same view by a camera whose lens distorts."""
    lens = Camera(straight.camera.size, straight.camera.K, np.array(dist), "file")
    rows, columns = np.mgrid[0:360, 0:480].astype(np.float64)
    pixels = np.stack([columns, rows], axis=-1).reshape(-1, 1, 2)
    at = cv2.undistortPoints(pixels, lens.K, lens.dist, P=lens.K).reshape(360, 480, 2).astype(np.float32)
    image = cv2.remap(straight.frame.image_bgr, at, None, cv2.INTER_CUBIC, borderMode=cv2.BORDER_REPLICATE)
    corners = project_distorted(lens, straight.marker.T_cam_marker, square_corners(SIDE))
    return TrackedFrame(replace(straight.frame, image_bgr=image), lens, replace(straight.marker, corners_px=corners))


def test_a_lens_bends_the_cover_as_it_bends_the_ground(make_renderer, stage) -> None:
    dist = (-0.25, 0.06, 0.0, 0.0, 0.0)
    tracked, bare = (_through_lens(_view(stage, has_sheet=each), dist) for each in (True, False))
    renderer = make_renderer(BALANCED.render)
    renderer.render(Scene(tracked, _aside(stage), covers_marker=True))
    assert _difference(renderer.read_bgr(), bare.frame.image_bgr)[_on_sheet(tracked, 0.008)].mean() < 3


def test_ground_is_looked_up_where_the_lens_puts_it(stage) -> None:
    straight = _view(stage, target=(-0.12, 0.0, 0.0))
    planes = [
        rectified(each, Illumination(), 0.06, 120) for each in (straight, _through_lens(straight, (-0.3,) + 4 * (0.0,)))
    ]
    assert (planes[0].is_seen & planes[1].is_seen).mean() > 0.8
    apart = np.abs(planes[0].linear - planes[1].linear)[planes[0].is_seen & planes[1].is_seen]
    assert apart.mean() < 0.02


def test_exposure_is_compared_where_a_shadow_has_just_taken_half_of_the_ground(stage) -> None:
    """No point's change is then near the median of all."""
    tracked = _view(stage)
    cover = known_cover(tracked, Illumination())
    assert len(cover.around) <= MOST_AROUND
    count = 2 * (len(cover.around) // 2)
    factors = np.where(np.arange(count) % 2, 0.5, 1.5)[:, None]
    halved = replace(cover, around=cover.around[:count], around_rgb=cover.around_rgb[:count] / factors)
    gain, slope = gain_and_slope(tracked, halved.around, halved.around_rgb)
    assert np.isfinite([*gain, *slope]).all()
    assert gain == pytest.approx(np.full(3, 0.5), rel=0.05)


def test_no_object_is_taken_for_ground(stage) -> None:
    """A blue block stands beside the sheet, and no estimate has told of it."""
    tracked = _view(stage)
    image = tracked.frame.image_bgr.copy()
    image[60:200, 30:110] = (200, 60, 20)
    cover = known_cover(replace(tracked, frame=replace(tracked.frame, image_bgr=image)), Illumination())
    red, _, blue, alpha = np.moveaxis(cover.image_rgba.astype(int), 2, 0)
    assert not ((blue > red) & (alpha > 0)).any()


def test_cover_is_steady_at_rest(make_renderer, stage) -> None:
    renderer = make_renderer(replace(FAST.render, matches_noise=False))
    pictures = []
    for index in range(10):
        renderer.render(Scene(_view(stage, noise=0.7, index=index), _aside(stage), covers_marker=True))
        pictures.append(renderer.read_bgr().astype(float))
    inside = _on_sheet(_view(stage), -0.005)
    changes = [np.abs(b - a)[inside].mean() for a, b in itertools.pairwise(pictures)]
    assert max(changes) <= 0.5


def test_a_cover_that_was_not_shown_for_a_while_is_there_at_once_and_of_todays_exposure(make_renderer, stage) -> None:
    """As when C, or B, is pressed twice: no picture shows the sheet meanwhile."""
    renderer = make_renderer(FAST.render)
    renderer.render(Scene(_view(stage), _aside(stage), covers_marker=True))
    renderer.render(Scene(_view(stage, index=1), _aside(stage), covers_marker=False))
    tracked = _view(stage, gain=0.7, index=2)
    renderer.render(Scene(tracked, _aside(stage), covers_marker=True), waits=False)
    bare = _view(stage, has_sheet=False, gain=0.7)
    assert _difference(renderer.read_bgr(), bare.frame.image_bgr)[_on_sheet(tracked, 0.008)].mean() < 3


def test_cover_follows_the_exposure_in_the_frame_that_it_changes_in(make_renderer, stage) -> None:
    renderer = make_renderer(FAST.render)
    renderer.render(Scene(_view(stage), _aside(stage), covers_marker=True))
    for index, gain in enumerate((0.9, 0.6, 0.8), start=1):
        tracked = _view(stage, gain=gain, index=index)
        renderer.render(Scene(tracked, _aside(stage), covers_marker=True))
        bare = _view(stage, has_sheet=False, gain=gain)
        assert _difference(renderer.read_bgr(), bare.frame.image_bgr)[_on_sheet(tracked, 0.008)].mean() < 3


def test_cover_follows_sheen_that_moves_over_the_table(make_renderer, stage) -> None:
    renderer, sheen = make_renderer(FAST.render), 5.0
    renderer.render(Scene(_view(stage), _aside(stage), covers_marker=True))
    for index in (1, 2):
        tracked = _view(stage, sheen=sheen, index=index)
        renderer.render(Scene(tracked, _aside(stage), covers_marker=True))
    bare = _view(stage, has_sheet=False, sheen=sheen)
    assert _difference(renderer.read_bgr(), bare.frame.image_bgr)[_on_sheet(tracked, 0.008)].mean() < 3


@pytest.mark.parametrize("known_by", ["its shadow", "its shadow, and lit by hand", "its intensity"])
def test_real_shadow_goes_on_where_it_crosses_the_sheet(make_renderer, stage, known_by: str) -> None:
    """Also under a light by hand, in which it would fall elsewhere, and of a lamp whose intensity alone is known."""
    light, is_lit_by_hand = stage.light(90, 45, RATIO), known_by.endswith("by hand")
    if known_by == "its intensity":
        of_lamp = 1 / np.array(RATIO) - 1
        light = replace(light, shadow_rgb_ratio=None, inverse_distance=0.01, intensity_rgb_ratio=of_lamp)
    # A post behind the sheet whose shadow falls across its left half.
    radius, height, middle = 0.012, 0.1, (-0.02, 0.075)
    post = Proxy("lathe", np.array([(*middle, 0.0, radius, 0.0), (*middle, height, radius, 0.0)]))

    def shaded(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        return (np.abs(x - middle[0]) < radius) & (y < middle[1]) & (y > middle[1] - height)

    tracked, bare = _view(stage, shaded=shaded), _view(stage, has_sheet=False, shaded=shaded)
    illumination = Illumination((light,), real_object=post, ground_rgb=np.array((0.42, 0.28, 0.16)))
    renderer = make_renderer(FAST.render)
    aside = stage.placed(box((0.006, 0.006, 0.002)).moved(1.0, np.array((0.09, -0.06, 0.0))))
    shown = replace(illumination, lights=(stage.light(65, 45, RATIO),)) if is_lit_by_hand else illumination
    lit_in_video = illumination if is_lit_by_hand else None
    picture = stage.picture(renderer, Scene(tracked, aside, shown, covers_marker=True, lit_in_video=lit_in_video))
    places = project(
        tracked.camera, tracked.marker.T_cam_marker, [(middle[0], y, 0.0) for y in np.linspace(0.03, -0.01, 9)]
    )
    lit = project(tracked.camera, tracked.marker.T_cam_marker, [(0.02, y, 0.0) for y in np.linspace(0.03, -0.01, 9)])
    smooth = [cv2.GaussianBlur(each, (0, 0), 1.5) for each in (picture, bare.frame.image_bgr)]
    for at in (places, lit):
        columns, rows = np.round(at).astype(int).T
        ours, truth = (LINEAR_FROM_SRGB_8BIT[each[rows, columns]].mean(axis=0) for each in smooth)
        np.testing.assert_allclose(ours, truth, rtol=0.12)


def test_models_shadow_lies_on_the_cover(make_renderer, stage) -> None:
    tracked = _view(stage)
    light = stage.light(-60, 35, RATIO)
    model = stage.placed(box((0.012, 0.012, 0.06)))
    renderer = make_renderer(FAST.render)
    pictures = []
    for casts_shadow in (False, True):
        renderer.render(Scene(tracked, model, Illumination((light,)), casts_shadow=casts_shadow, covers_marker=True))
        pictures.append(LINEAR_FROM_SRGB_8BIT[renderer.read_bgr()[..., ::-1]])
    way = light.to_light_marker[:2] / light.to_light_marker[2]
    place = project(tracked.camera, tracked.marker.T_cam_marker, [(*(-0.036 * way), 0.0)])
    (column, row), *_ = np.round(place).astype(int)
    beside = slice(row - 1, row + 2), slice(column - 1, column + 2)
    np.testing.assert_allclose(
        pictures[1][beside].mean(axis=(0, 1)) / pictures[0][beside].mean(axis=(0, 1)), RATIO, rtol=0.05
    )


def test_the_marker_stays_where_no_ground_is_seen(make_renderer, stage) -> None:
    """The sheet fills the picture: nothing is known that could cover it."""
    T = stage.pose(-80, 80, 0.09, target=(0, 0, 0))
    image = np.full((360, 480, 3), 200, np.uint8)
    corners = project(stage.camera(), T, SIDE / 2 * np.array([(-1, 1, 0), (1, 1, 0), (1, -1, 0), (-1, -1, 0)], float))
    tracked = TrackedFrame(Frame(image, 0, 0.0), stage.camera(), MarkerPose(T, corners, SIDE, 0.0, None))
    assert known_cover(tracked, Illumination()) is None
    renderer = make_renderer(FAST.render)
    renderer.render(Scene(tracked, stage.placed(box((0.001, 0.001, 0.001))), covers_marker=True))
    assert (np.abs(renderer.read_bgr().astype(int) - 200).max(axis=2) > 1).mean() < 0.01


def test_another_thread_makes_the_cover_where_pictures_cannot_wait_and_a_draft_first(ctx, stage) -> None:
    cover = MarkerCover(ctx)
    tracked = _view(stage)
    cover.follow(tracked, Illumination(), waits=False)
    sizes = []
    while not cover.is_settled:
        _finish(cover)
        cover.follow(tracked, Illumination(), waits=False)
        assert len(cover.corners) == 4
        sizes.append(cover._texture.size[0])
    assert sizes == [round(2 * HALF_SIDES * DRAFT_SIDE_PX), len(known_cover(tracked, Illumination()).image_rgba)]
    cover.release()


def test_what_is_small_in_the_picture_has_no_draft(stage) -> None:
    tracked = _view(stage, distance=1.0)
    fine, draft = (known_cover(tracked, Illumination(), is_draft) for is_draft in (False, True))
    assert not draft.is_draft
    np.testing.assert_array_equal(fine.image_rgba, draft.image_rgba)


def test_a_draft_covers_the_same_sheet_with_the_same_ground(stage) -> None:
    tracked = _view(stage, noise=0.7)
    fine, draft = (known_cover(tracked, Illumination(), is_draft) for is_draft in (False, True))
    assert (fine.is_draft, draft.is_draft) == (False, True)
    np.testing.assert_allclose(draft.extent_m, fine.extent_m, atol=0.03 * SIDE)
    coarse = cv2.resize(fine.image_rgba, draft.image_rgba.shape[:2], interpolation=cv2.INTER_AREA)
    both = (coarse[..., 3] == 255) & (draft.image_rgba[..., 3] == 255)
    pictures = [np.where(both[..., None], each[..., 2::-1], 0).astype(np.uint8) for each in (coarse, draft.image_rgba)]
    assert _difference(*pictures)[both].mean() < 3


def test_another_source_is_covered_by_its_own_ground(make_renderer, stage) -> None:
    """The marker lies alike in both, and no light has been estimated in either."""
    dim = 0.15  # beyond what passes for a change of exposure
    renderer = make_renderer(FAST.render)
    for tracked in (_view(stage), _view(stage, gain=dim)):
        renderer.render(Scene(tracked, _aside(stage), Illumination(seen_in=tracked), covers_marker=True))
    bare = _view(stage, has_sheet=False, gain=dim)
    assert _difference(renderer.read_bgr(), bare.frame.image_bgr)[_on_sheet(tracked, 0.008)].mean() < 3


def test_ground_of_the_last_source_is_not_laid_into_the_next(make_renderer, stage) -> None:
    """Where pictures cannot wait for the next cover, the sheet is seen until that is there."""
    renderer = make_renderer(FAST.render)
    first, second = _view(stage), _view(stage, gain=0.15)
    renderer.render(Scene(first, _aside(stage), Illumination(seen_in=first), covers_marker=True))
    renderer.begin_anew()
    renderer.render(Scene(second, _aside(stage), Illumination(seen_in=second), covers_marker=True), waits=False)
    within = _on_sheet(second, -0.004)
    assert _difference(renderer.read_bgr(), second.frame.image_bgr)[within].max() < 3


@pytest.mark.parametrize("waits", [False, True])
def test_what_is_saved_beside_a_window_is_covered_as_the_window_is(make_renderer, stage, waits) -> None:
    """From its first picture on: a recording, whose pictures wait for nothing, and a snapshot."""
    window, tracked = make_renderer(FAST.render), _view(stage)
    scene = Scene(tracked, _aside(stage), Illumination(seen_in=tracked), covers_marker=True)
    window.render(scene)
    saved = window.beside(window.size)
    saved.render(scene, waits)
    np.testing.assert_array_equal(saved.read_bgr(), window.read_bgr())
    window.begin_anew()
    window.render(scene, waits=False)
    saved.render(scene, waits)
    is_paper = _difference(saved.read_bgr(), tracked.frame.image_bgr)[_on_sheet(tracked, -0.004)].max() < 3
    assert is_paper == (not waits)
    saved.release()


def test_a_snapshot_waits_for_the_cover_that_the_window_has_begun(ctx, stage, monkeypatch) -> None:
    made = []

    def counted(*asked) -> GroundCover | None:
        made.append(asked)
        return known_cover(*asked)

    monkeypatch.setattr(cover_maker, "ground_cover", counted)
    cover, tracked = MarkerCover(ctx), _view(stage)
    light = Illumination(seen_in=tracked)
    cover.follow(tracked, light, waits=False)
    _finish(cover)
    cover.follow(tracked, light, waits=False)
    assert not cover.is_settled
    cover.follow_beside(tracked, light, waits=True)
    assert cover.is_settled
    assert len(made) == 2  # the draft, and one without haste
    cover.release()


def test_a_recording_is_covered_also_while_the_window_draws_nothing(ctx, stage) -> None:
    cover, tracked = MarkerCover(ctx), _view(stage)
    cover.follow_beside(tracked, Illumination(), waits=False)
    assert len(cover.corners) == 0
    _finish(cover)
    cover.follow_beside(replace(tracked), Illumination(), waits=False)
    assert len(cover.corners) == 4
    cover.release()


def test_a_recorded_picture_brings_no_other_cover_than_the_window_has(ctx, stage) -> None:
    """While a light eases to another one, the frame's light is seen twice, which does not make it one that stays."""
    cover, tracked = MarkerCover(ctx), _view(stage)
    _settled(cover, tracked, Illumination())
    for index in range(1, 4):
        frame, easing = _view(stage, index=index), Illumination(seen_in=_view(stage))
        cover.follow(frame, easing, waits=False)
        cover.follow_beside(frame, easing, waits=False)
        assert cover.is_settled
    cover.release()


def test_what_is_saved_without_the_cover_leaves_it_to_the_window(make_renderer, stage) -> None:
    window, tracked = make_renderer(FAST.render), _view(stage)
    scene = Scene(tracked, _aside(stage), covers_marker=True)
    covered = stage.picture(window, scene)
    saved = window.beside(window.size)
    saved.render(replace(scene, covers_marker=False))
    saved.release()
    window.render(scene, waits=False)
    np.testing.assert_array_equal(window.read_bgr(), covered)


def _finish(cover: MarkerCover) -> None:
    """Waits until the cover that is being made is ready to be taken."""
    cover._maker._coming.result()


def _settled(cover: MarkerCover, tracked: TrackedFrame, lit: Illumination) -> list[GroundCover | None]:
    """The covers that are shown until no other is being made."""
    shown = []
    for _ in range(2):  # the first time the light may be another one
        cover.follow(tracked, lit, waits=False)
    while not cover.is_settled:
        _finish(cover)
        cover.follow(tracked, lit, waits=False)
        shown.append(cover._maker.made.cover)
    return shown


def test_a_sheet_that_was_moved_is_covered_by_the_ground_where_it_lies_a_draft_first(ctx, stage) -> None:
    cover = MarkerCover(ctx)
    lies, moved = (replace(_view(stage), T_room_marker=place) for place in (np.eye(4), np.diag([-1.0, -1.0, 1.0, 1.0])))
    _settled(cover, lies, Illumination())
    assert _settled(cover, lies, Illumination()) == []
    # The ground beside it is another one, by which no exposure can be compared.
    brighter = replace(_view(stage, gain=1.5, index=1), T_room_marker=moved.T_room_marker)
    cover.follow(brighter, Illumination((Light(np.array([0.0, 0.6, 0.8])),)), waits=False)
    assert cover._sheet.gain == pytest.approx(1, abs=0.05)
    assert _settled(cover, moved, Illumination()) == []  # the hand that has moved it may still be there
    alone = replace(moved, frame=Frame(moved.frame.image_bgr, 30, 1.0))
    covers = _settled(cover, alone, Illumination())
    assert [cover.is_draft for cover in covers] == [True, False]
    cover.release()


def test_a_hand_on_the_sheet_becomes_no_part_of_the_next_cover(ctx, stage) -> None:
    cover = MarkerCover(ctx)
    lies, moved = (replace(_view(stage), T_room_marker=place) for place in (np.eye(4), np.diag([-1.0, -1.0, 1.0, 1.0])))
    _settled(cover, lies, Illumination())
    picture = moved.frame.image_bgr.copy()
    left = np.arange(picture.shape[1]) < moved.marker.corners_px[:, 0].mean()
    picture[_on_sheet(moved) & left] = (80, 110, 190)
    cover.follow(moved, Illumination(), waits=False)
    touched = replace(moved, frame=Frame(picture, 30, 1.0))
    assert _settled(cover, touched, Illumination()) == []
    assert _settled(cover, replace(moved, frame=Frame(moved.frame.image_bgr, 31, 1.1)), Illumination())
    cover.follow(replace(moved, frame=Frame(picture, 32, 1.1)), Illumination(), waits=False)
    cover.forget()
    assert _settled(cover, touched, Illumination()), "where there is no cover, one is made in any case"
    cover.release()


def test_a_finger_at_the_sheets_edge_becomes_no_part_of_the_next_cover_and_what_stays_there_does(ctx, stage) -> None:
    cover, lies = MarkerCover(ctx), _view(stage)
    near, nearer = (Illumination((Light(np.array(towards)),)) for towards in ((0, 0.6, 0.8), (0, 0.65, 0.76)))
    _settled(cover, lies, near)
    picture = lies.frame.image_bgr.copy()
    rows, columns = np.nonzero(_on_sheet(lies))
    tip = (rows > np.quantile(rows, 0.9)) & (np.abs(columns - np.median(columns)) < 0.1 * np.ptp(columns))
    picture[rows[tip], columns[tip]] = (80, 110, 190)
    touches, stays = (replace(lies, frame=Frame(picture, 30 * s, float(s))) for s in (1, 12))
    assert _settled(cover, touches, nearer) == []
    assert _settled(cover, stays, nearer), "a shadow's rest that stays must not keep the cover of an older answer"
    cover.release()


def test_in_another_light_the_sheet_is_covered_anew_also_where_something_seems_to_lie_on_it(ctx, stage) -> None:
    """What a light that has gone out leaves is not told from a thing, and would stay for ever."""
    cover, tracked = MarkerCover(ctx), _view(stage)
    low, near, high = (
        Illumination((Light(np.array(towards)),)) for towards in ((0, 0.6, 0.8), (0, 0.65, 0.76), (0, 0, 1))
    )
    _settled(cover, tracked, low)
    picture = tracked.frame.image_bgr.copy()
    left = np.arange(picture.shape[1]) < tracked.marker.corners_px[:, 0].mean()
    picture[_on_sheet(tracked) & left] = (80, 110, 190)
    touched = replace(tracked, frame=Frame(picture, 30, 1.0))
    assert _settled(cover, touched, near) == []
    assert _settled(cover, touched, high)
    assert _settled(cover, touched, Illumination())
    cover.release()


def test_a_cover_that_was_given_up_meanwhile_is_not_taken(ctx, stage) -> None:
    cover = MarkerCover(ctx)
    tracked = _view(stage)
    cover.follow(tracked, Illumination(), waits=False)
    coming = cover._maker._coming
    cover.forget()
    coming.result()
    cover.follow(tracked, Illumination(), waits=False)
    assert len(cover.corners) == 0
    cover.release()


@pytest.mark.parametrize("half_sides", [0.62, 0.75, 1.1])
def test_sheet_is_found_whatever_its_size(half_sides: float) -> None:
    size, side_px = 330, 60.0
    x, y = np.meshgrid(*[np.abs(np.arange(size) + 0.5 - size / 2) / side_px] * 2)
    away = np.maximum(x, y)
    lit = np.full((size, size, 3), (0.4, 0.25, 0.15), np.float32)
    lit[away < half_sides] = 0.75
    lit[away < 0.5] = 0.03
    mask = sheet_of(lit, np.ones((size, size), bool), side_px).mask
    assert mask[away < half_sides].all()
    assert not mask[away > half_sides + 0.12].any()


def test_on_white_ground_only_the_square_is_covered() -> None:
    size, side_px = 330, 60.0
    x, y = np.meshgrid(*[np.abs(np.arange(size) + 0.5 - size / 2) / side_px] * 2)
    away = np.maximum(x, y)
    lit = np.full((size, size, 3), 0.75, np.float32)
    lit[away < 0.5] = 0.03
    mask = sheet_of(lit, np.ones((size, size), bool), side_px).mask
    assert mask[away < 0.5].all()
    assert not mask[away > LEAST_HALF_SIDES + 0.12].any()


def test_cover_has_the_videos_noise_from_frame_to_frame_also_in_the_models_shadow(make_renderer, stage) -> None:
    """The noise of the frame that it was made from stands still: a calm rectangle would be seen in a noisy video."""
    renderer, light = make_renderer(FAST.render), stage.light(180, 25, RATIO)
    model = stage.placed(box((0.01, 0.06, 0.08)).moved(1.0, np.array((-0.075, 0.0, 0.0))))
    frames = [_view(stage, noise=3.0, index=index) for index in range(12)]
    pictures = []
    for tracked in frames:
        renderer.render(Scene(tracked, model, Illumination((light,)), covers_marker=True))
        pictures.append(renderer.read_bgr().mean(axis=2))
    boiling = np.std(pictures, axis=0, ddof=1)
    rows, columns = np.mgrid[0:360, 0:480]
    pixels = np.column_stack([columns.ravel(), rows.ravel()]).astype(float)
    x, y, _ = raycast_to_plane(frames[0].camera, frames[0].marker.T_cam_marker, pixels).T.reshape(3, 360, 480)
    shade_end = -0.07 + 0.08 / np.tan(np.radians(25))

    def noise_at(left: float, right: float, low: float, high: float) -> float:
        here = (x > left) & (x < right) & (y > low) & (y < high)
        assert here.sum() > 200
        return float(boiling[here].mean())

    on_lit_cover, on_lit_ground = noise_at(-0.04, 0.04, -0.047, -0.036), noise_at(-0.04, 0.04, -0.1, -0.065)
    in_shade_on_cover = noise_at(-0.03, 0.04, -0.025, 0.025)
    in_shade_on_ground = noise_at(PAPER_HALF + 0.012, shade_end - 0.005, -0.025, 0.025)
    assert on_lit_cover == pytest.approx(on_lit_ground, rel=0.2)
    assert in_shade_on_cover == pytest.approx(in_shade_on_ground, rel=0.2)
    assert in_shade_on_ground < 0.8 * on_lit_ground
