"""The estimator `proxy` on painted photos with a known light: its errors, its laws, and the extremes."""

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import cv2
import numpy as np
import pytest

from ashe_live.bench.cases import read_cases
from ashe_live.core.arrays import Float, Image
from ashe_live.core.camera import Camera
from ashe_live.core.light import Illumination, Light, LightEstimate
from ashe_live.core.transforms import angle_between, rigid
from ashe_live.core.types import MarkerPose, TrackedFrame
from ashe_live.light.estimators import proxy
from ashe_live.light.estimators.preset import ACCURATE, BALANCED, FAST
from ashe_live.light.estimators.proxy import ProxyEstimator
from ashe_live.light.explanation.judgement.judge import fitted_judge
from ashe_live.light.explanation.no_answer import NEAR_OR_FAR
from ashe_live.light.lamps.kinds import SUN
from tests.light import painted_scenes
from tests.light.painted_scenes import (
    BOX,
    CYLINDER,
    HFOV_DEG,
    SHADOW_RATIO,
    SIDE_M,
    VIEW,
    Caster,
    Painted,
    overlap,
    paint,
    tracked_frame,
)
from tests.light.synthetic_masks import IMPOSSIBLE_POSES, camera_towards
from tests.shared_data import shared_folder

CASTERS = {"box": BOX, "cylinder": CYLINDER}
SMALL = (320, 240)
# Ground, azimuth and elevation in degrees.
SUNS = [
    ("plain", 110, 35),
    ("checkered", 290, 25),
    ("striped", 200, 40),
    ("striped", 330, 65),
    ("bricks", 200, 40),
]


def estimated(tracked: TrackedFrame) -> LightEstimate:
    return ProxyEstimator().estimate(tracked)


def quickly_estimated(tracked: TrackedFrame) -> LightEstimate:
    """By the same code with smaller counts, where it is only asked whether there is an answer or a reason."""
    return ProxyEstimator(FAST).estimate(tracked)


def answered(tracked: TrackedFrame) -> Light:
    estimate = estimated(tracked)
    assert estimate.light is not None, estimate.reason
    return estimate.light


def towards(tracked: TrackedFrame) -> Float:
    return answered(tracked).to_light_marker


def apart_deg(a: Float, b: Float) -> float:
    return math.degrees(angle_between(a, b))


def check_answer_or_reason(estimate: LightEstimate) -> None:
    """Finite numbers in their ranges, or words."""
    if estimate.light is None:
        assert estimate.reason
        return
    light = estimate.light
    assert light.to_light_marker[2] > 0
    assert light.covariance_rad2 is not None
    assert light.sigma_rad is not None
    assert light.confidence is not None
    assert light.shadow_rgb_ratio is not None
    assert (np.linalg.eigvalsh(light.covariance_rad2) >= 0).all()
    assert 0 <= light.sigma_rad < math.inf
    assert fitted_judge().least_confidence <= light.confidence <= 1
    assert ((light.shadow_rgb_ratio > 0) & (light.shadow_rgb_ratio <= 1)).all()


# Truth


@pytest.mark.parametrize("rgb", [(0.03, 0.03, 0.04), (0.1, 0.25, 0.5), (0.9, 0.9, 0.9)], ids=["black", "blue", "white"])
def test_what_glossy_ground_mirrors_is_no_part_of_the_object(rgb: tuple[float, float, float]) -> None:
    """Below the foot, polished wood adds an eighth of the object's light, and lacks an eighth of the sky's."""
    scene = paint(replace(CYLINDER, rgb=rgb), azimuth_deg=110, elevation_deg=35, gloss=0.12)
    assert apart_deg(towards(scene.tracked), scene.to_light) < 2


@pytest.mark.parametrize(("name", "most_deg", "median_deg"), [("box", 1.5, 0.7), ("cylinder", 0.5, 0.35)])
def test_the_light_is_found_on_any_ground(name: str, most_deg: float, median_deg: float) -> None:
    """Boxes err by more, as a box's turn is one more unknown.

    That the light is a sun's is told: by chance one ground in twenty looks as if a lamp lit it, which then has a say.
    """
    errors_deg = []
    of_sun = ProxyEstimator(replace(BALANCED, light=SUN))
    for ground, azimuth_deg, elevation_deg in SUNS:
        scene = paint(CASTERS[name], ground=ground, azimuth_deg=azimuth_deg, elevation_deg=elevation_deg)
        estimate = of_sun.estimate(scene.tracked)
        check_answer_or_reason(estimate)
        assert estimate.light is not None, estimate.reason
        errors_deg.append(apart_deg(estimate.light.to_light_marker, scene.to_light))
        np.testing.assert_allclose(estimate.light.shadow_rgb_ratio, SHADOW_RATIO, rtol=0.2)
    assert max(errors_deg) < most_deg
    assert np.median(errors_deg) < median_deg


def test_what_it_shows_is_what_was_painted() -> None:
    scene = paint(CYLINDER, ground="checkered")
    estimate = estimated(scene.tracked)
    assert estimate.estimator == "proxy"
    assert estimate.frame_index == scene.tracked.frame.index
    assert estimate.object_mask is not None
    assert estimate.shadow_mask is not None
    size = estimate.object_mask.shape[::-1]
    body, shadow = (
        cv2.resize(mask.astype(np.float32), size, interpolation=cv2.INTER_AREA) > 0.5
        for mask in (scene.body, scene.shadow)
    )
    assert overlap(estimate.object_mask, body) > 0.8
    assert overlap(estimate.shadow_mask, shadow) > 0.7
    stages = dict(estimate.timing_ms)
    total = stages.pop("total")
    assert set(stages) == {"segment", "associate", "fit", "judge"}
    assert sum(stages.values()) <= total + 1e-6


def test_looking_twice_in_the_same_way_gives_the_same() -> None:
    tracked = paint(CYLINDER, ground="checkered").tracked
    once, _ = ProxyEstimator(FAST).traced(tracked)
    twice, trace = ProxyEstimator(replace(FAST, second_look=FAST)).traced(tracked)
    assert once.light is not None
    assert twice.light is not None
    np.testing.assert_array_equal(twice.light.to_light_marker, once.light.to_light_marker)
    assert sum(trace.probabilities) <= 1


def test_a_second_look_finds_nothing_where_nothing_is() -> None:
    bare = paint().tracked
    once, twice = (ProxyEstimator(preset).estimate(bare) for preset in (BALANCED, ACCURATE))
    assert once.light is twice.light is None
    assert twice.reason == once.reason


def test_soft_edges_cost_little() -> None:
    scene = paint(CYLINDER, penumbra_px=2)
    assert apart_deg(towards(scene.tracked), scene.to_light) < 3


def test_a_second_object_does_not_mislead() -> None:
    scene = paint(CYLINDER, Caster(at=(-0.1, 0.1)))
    assert apart_deg(towards(scene.tracked), scene.to_light) < 2


def grey(scene: Painted) -> TrackedFrame:
    levels = cv2.cvtColor(np.asarray(scene.tracked.frame.image_bgr), cv2.COLOR_BGR2GRAY)
    return tracked_frame(np.repeat(levels[..., None], 3, axis=2), scene.tracked.camera)


def test_an_object_may_touch_the_sheet() -> None:
    scene = paint(Caster(at=(0.08, 0.0)))
    assert apart_deg(towards(scene.tracked), scene.to_light) < 3


@pytest.mark.parametrize("at", [(0.14, 0.06), (0.03, -0.14)], ids=["beside the page", "on it"])
def test_the_whole_page_may_lie_on_the_table(at: tuple[float, float]) -> None:
    """An A4 page with a marker of 80 mm, as `ashe-live marker` prints it."""
    page_m = (0.105, 0.126, 0.105, 0.171)  # right, above, left and below of the marker's centre
    caster, camera = replace(CYLINDER, at=at), camera_towards((0.0, -0.02), 0.62, 55.0)
    scene = paint(caster, azimuth_deg=30, T_cam_marker=camera, page_m=page_m)
    assert apart_deg(towards(scene.tracked), scene.to_light) < 2


def test_a_grey_picture_can_be_enough() -> None:
    scene = paint(CYLINDER)
    assert apart_deg(towards(grey(scene)), scene.to_light) < 4


def test_the_lens_is_taken_into_account() -> None:
    """A wider picture of the same scene, bent as a lens with k1 = -0.3 does."""
    focal_px = 620.0
    scene = paint(CYLINDER, ground="checkered", size=(960, 720), focal_px=focal_px)
    camera = Camera((640, 480), Camera.from_focal((640, 480), focal_px).K, np.array([-0.3, 0, 0, 0, 0]), "file")
    pixels = np.stack(np.meshgrid(np.arange(640.0), np.arange(480.0)), axis=2).reshape(-1, 1, 2)
    straight = cv2.undistortPoints(pixels, camera.K, camera.dist, P=scene.tracked.camera.K)
    bent = cv2.remap(
        np.asarray(scene.tracked.frame.image_bgr),
        straight.reshape(480, 640, 2).astype(np.float32),
        None,
        cv2.INTER_AREA,
    )
    assert apart_deg(towards(tracked_frame(bent, camera)), scene.to_light) < 3


def test_black_bars_beside_the_picture_are_none_of_it() -> None:
    """As of a clip in a frame of other proportions, compressed: taken for ground, they put the light 5° off."""
    scene = paint(BOX)
    picture = np.asarray(scene.tracked.frame.image_bgr)
    height, width = picture.shape[:2]
    bar_px = 60
    framed = cv2.copyMakeBorder(picture, bar_px, bar_px, 0, 0, cv2.BORDER_CONSTANT)
    K = scene.tracked.camera.K.copy()
    K[1, 2] += bar_px
    camera = Camera((width, height + 2 * bar_px), K, np.zeros(5), "file")
    compressed = cv2.imdecode(cv2.imencode(".jpg", framed, [cv2.IMWRITE_JPEG_QUALITY, 85])[1], cv2.IMREAD_COLOR)
    assert compressed is not None
    assert apart_deg(towards(tracked_frame(np.asarray(compressed, np.uint8), camera)), scene.to_light) < 2


def test_a_picture_of_33_megapixels_is_one_of_its_working_size() -> None:
    scene = paint(CYLINDER, size=(640, 360))
    large = np.asarray(cv2.resize(np.asarray(scene.tracked.frame.image_bgr), (7680, 4320)), np.uint8)
    assert apart_deg(towards(tracked_frame(large, scene.tracked.camera.resized((7680, 4320)))), scene.to_light) < 1.5


# Laws


def turned(tracked: TrackedFrame, angle_rad: float) -> tuple[TrackedFrame, Float]:
    """The same frame, were the marker turned about its normal; and the rotation into the frame before."""
    c, s = math.cos(angle_rad), math.sin(angle_rad)
    R = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    pose = tracked.marker
    assert pose is not None
    T_cam_marker = pose.T_cam_marker @ rigid(R, np.zeros(3))
    again = MarkerPose(T_cam_marker, pose.corners_px, pose.side_m, 0.1, None)
    return TrackedFrame(tracked.frame, tracked.camera, again), R


@pytest.fixture(scope="module")
def plain() -> tuple[TrackedFrame, Light]:
    """A frame, and its answer."""
    tracked = paint(CYLINDER, size=SMALL, azimuth_deg=110.0, elevation_deg=35.0).tracked
    return tracked, answered(tracked)


@pytest.mark.parametrize("quarters", [1, 2])
def test_turning_the_marker_by_quarters_turns_the_light(plain: tuple[TrackedFrame, Light], quarters: int) -> None:
    tracked, before = plain
    again, R = turned(tracked, quarters * math.pi / 2)
    after = answered(again)
    np.testing.assert_allclose(R @ after.to_light_marker, before.to_light_marker, atol=1e-6)
    # The covariance stands on the direction's own tangents, which turn along.
    np.testing.assert_allclose(after.covariance_rad2, before.covariance_rad2, rtol=1e-4, atol=1e-12)
    # It depends on what other families would answer, some of which are searched from six or eight sides.
    assert after.confidence == pytest.approx(before.confidence, abs=1e-4)


@pytest.mark.parametrize("angle_rad", [0.7, 3.9])
def test_turning_the_marker_turns_the_light(plain: tuple[TrackedFrame, Light], angle_rad: float) -> None:
    """By any angle; only the sheet's corners hide other ground."""
    tracked, before = plain
    again, R = turned(tracked, angle_rad)
    assert apart_deg(R @ towards(again), before.to_light_marker) < 0.3


@pytest.mark.parametrize("scale", [1e-3, 1e3])
def test_the_markers_size_does_not_matter(plain: tuple[TrackedFrame, Light], scale: float) -> None:
    tracked, before = plain
    T_cam_marker = np.array(VIEW)
    T_cam_marker[:3, 3] *= scale
    scaled = tracked_frame(np.asarray(tracked.frame.image_bgr), tracked.camera, T_cam_marker, scale * SIDE_M)
    np.testing.assert_allclose(towards(scaled), before.to_light_marker, atol=1e-6)


@pytest.mark.parametrize("ground", ["plain", "checkered"])
def test_exposure_does_not_matter(ground: str) -> None:
    lights = [
        towards(paint(CYLINDER, ground=ground, size=SMALL, exposure=exposure, noise_levels=1.0).tracked)
        for exposure in (0.25, 1.0)
    ]
    assert apart_deg(*lights) < 1


@pytest.mark.parametrize("caster", [BOX, CYLINDER], ids=lambda caster: caster.shape)
def test_a_mirrored_world_has_a_mirrored_light(caster: Caster) -> None:
    tracked = paint(caster, azimuth_deg=110.0, elevation_deg=35.0).tracked
    mirror = np.diag([-1.0, 1, 1, 1])
    image = np.ascontiguousarray(np.asarray(tracked.frame.image_bgr)[:, ::-1])
    mirrored = tracked_frame(image, tracked.camera, mirror @ VIEW @ mirror)
    assert apart_deg(towards(mirrored) * [-1, 1, 1], towards(tracked)) < 1


@pytest.fixture
def any_thread_count() -> Iterator[Callable[[int], None]]:
    before = cv2.getNumThreads()
    yield cv2.setNumThreads
    cv2.setNumThreads(before)


def test_the_same_frame_gives_the_same_bits(any_thread_count: Callable[[int], None]) -> None:
    tracked = paint(BOX, ground="striped", size=SMALL).tracked
    estimates = []
    for threads in (1, 2):
        any_thread_count(threads)
        cv2.setRNGSeed(threads)
        estimates.append(estimated(tracked))
    first, again = estimates
    assert first.light is not None
    assert again.light is not None
    np.testing.assert_array_equal(again.light.to_light_marker, first.light.to_light_marker)
    np.testing.assert_array_equal(again.light.covariance_rad2, first.light.covariance_rad2)
    np.testing.assert_array_equal(again.shadow_mask, first.shadow_mask)
    np.testing.assert_array_equal(again.object_mask, first.object_mask)


def test_the_frame_is_left_as_it_was() -> None:
    tracked = paint(BOX, size=SMALL).tracked
    before = np.array(tracked.frame.image_bgr)
    estimated(tracked)
    np.testing.assert_array_equal(tracked.frame.image_bgr, before)


# Extremes


def noise(*shape: int) -> Image:
    return np.random.default_rng(4).integers(0, 256, (*shape, 3), dtype=np.uint8)


def level(value: int, *shape: int) -> Image:
    return np.full((*shape, 3), value, np.uint8)


NOTHING_TO_SEE = {
    **{f"level {value}": level(value, 480, 640) for value in (0, 1, 128, 254, 255)},
    **{f"level {h}x{w}": level(90, h, w) for h, w in ((1, 1), (2, 2), (1, 640), (640, 1), (64, 64))},
    **{f"noise {h}x{w}": noise(h, w) for h, w in ((1, 1), (2, 2), (3, 500), (64, 64), (480, 640))},
}


@pytest.mark.parametrize("shadow_ratios", [0.015, 0.03, 0.6])
def test_shadows_may_be_nearly_black_or_pale(shadow_ratios: float, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(painted_scenes, "SHADOW_RATIO", shadow_ratios * np.array([0.9, 1.0, 1.1]))
    scene = paint(BOX)
    assert apart_deg(towards(scene.tracked), scene.to_light) < 1.0


@pytest.mark.parametrize(
    ("name", "azimuth_deg", "elevation_deg"),
    [
        ("box", 60, 4.0),
        ("cylinder", 60, 12.0),
        ("box", 110, 5.0),
        ("cylinder", 120, 8.0),
        ("box", 200, 16.0),
    ],
)
def test_where_a_shadow_leaves_the_picture_the_lights_height_is_unsure(
    name: str, azimuth_deg: float, elevation_deg: float
) -> None:
    scene = paint(CASTERS[name], azimuth_deg=azimuth_deg, elevation_deg=elevation_deg)
    assert scene.shadow[[0, -1]].any() or scene.shadow[:, [0, -1]].any()
    light = answered(scene.tracked)
    assert light.sigma_rad is not None
    assert light.sigma_rad > math.radians(5)
    assert apart_deg(light.to_light_marker, scene.to_light) < 2.5 * math.degrees(light.sigma_rad)


def test_a_direction_that_a_lamps_distance_leaves_open_is_none(monkeypatch: pytest.MonkeyPatch) -> None:
    stated = proxy.illumination_of

    def doubtful(*how: Any) -> tuple[Illumination, Any]:
        found, explanation = stated(*how)
        return replace(found, lights=(replace(found.lights[0], confidence=0.1),)), explanation

    monkeypatch.setattr(proxy, "illumination_of", doubtful)
    estimate = estimated(paint(BOX).tracked)
    assert estimate.light is None
    assert estimate.reason == NEAR_OR_FAR
    assert estimate.shadow_mask is not None


@pytest.mark.parametrize("image", NOTHING_TO_SEE.values(), ids=NOTHING_TO_SEE)
def test_pictures_of_nothing_give_a_reason(image: Image) -> None:
    camera = Camera.from_hfov((image.shape[1], image.shape[0]), HFOV_DEG)
    estimate = estimated(tracked_frame(image, camera))
    assert estimate.light is None
    assert estimate.reason


@pytest.mark.parametrize("ground", ["plain", "checkered", "striped", "bricks"])
def test_empty_ground_gives_a_reason(ground: str) -> None:
    estimate = estimated(paint(ground=ground, size=SMALL).tracked)
    assert estimate.light is None
    assert estimate.reason


@pytest.mark.parametrize("elevation_deg", [80.0, 89.9, 90.0])
def test_a_light_overhead_is_found_overhead_or_not_at_all(elevation_deg: float) -> None:
    scene = paint(CYLINDER, size=SMALL, elevation_deg=elevation_deg)
    estimate = estimated(scene.tracked)
    check_answer_or_reason(estimate)
    assert estimate.light is None or apart_deg(estimate.light.to_light_marker, scene.to_light) < 15


def seen_from(pitch_deg: float, distance_m: float = 0.6) -> dict[str, Any]:
    return {"T_cam_marker": camera_towards((0.08, 0.0), distance_m, pitch_deg)}


EXTREMES: dict[str, tuple[Caster, dict[str, Any]]] = {
    **{
        f"light at 5 degrees from {azimuth}": (BOX, {"elevation_deg": 5, "azimuth_deg": azimuth})
        for azimuth in (20, 200)
    },
    "light at 0.5 degrees": (BOX, {"elevation_deg": 0.5}),
    **{f"camera {pitch} degrees above the ground": (BOX, seen_from(pitch)) for pitch in (0.5, 4, 90)},
    "marker of 12 px": (BOX, {**seen_from(45, 4.0), "size": (640, 480)}),
    "object on the marker": (Caster(at=(0.0, 0.0)), {}),
    "shadow on the marker": (BOX, {"azimuth_deg": 0, "elevation_deg": 35}),
    "object cut by the frame": (Caster(at=(0.33, 0.0)), {}),
    "object in front of the camera": (Caster(at=(0.08, -0.3), height_m=0.25), {}),
    "overexposed": (BOX, {"exposure": 8}),
    "underexposed": (BOX, {"exposure": 0.01}),
    "noise": (BOX, {"noise_levels": 60}),
    "small": (BOX, {"size": (64, 48)}),
    "narrow": (BOX, {"size": (40, 480), "focal_px": 500}),
}


@pytest.mark.parametrize(("caster", "how"), EXTREMES.values(), ids=EXTREMES)
def test_extremes_end_in_an_answer_or_a_reason(caster: Caster, how: dict[str, Any]) -> None:
    check_answer_or_reason(quickly_estimated(paint(caster, **{"size": SMALL, **how}).tracked))


@pytest.mark.parametrize("caster", [*CASTERS.values(), Caster(rgb=(0.7, 0.7, 0.7))], ids=lambda caster: str(caster.rgb))
def test_grey_pictures_end_in_an_answer_or_a_reason(caster: Caster) -> None:
    check_answer_or_reason(quickly_estimated(grey(paint(caster, size=SMALL))))


@pytest.mark.parametrize("hfov_deg", [0.01, 179.99])
def test_any_field_of_view_ends_in_an_answer_or_a_reason(hfov_deg: float) -> None:
    image = np.asarray(paint(BOX, size=SMALL).tracked.frame.image_bgr)
    # `from_hfov` takes those of cameras alone, and a focal length may be any.
    camera = Camera.from_focal(SMALL, SMALL[0] / 2 / math.tan(math.radians(hfov_deg) / 2), "assumed")
    check_answer_or_reason(quickly_estimated(tracked_frame(image, camera)))


@pytest.mark.parametrize("T_cam_marker", IMPOSSIBLE_POSES.values(), ids=IMPOSSIBLE_POSES)
def test_poses_that_cannot_be_end_in_an_answer_or_a_reason(T_cam_marker: Float) -> None:
    tracked = paint(BOX, size=SMALL).tracked
    frame = tracked_frame(np.asarray(tracked.frame.image_bgr), tracked.camera, T_cam_marker)
    check_answer_or_reason(quickly_estimated(frame))


def test_without_a_marker_it_is_not_asked() -> None:
    tracked = paint(BOX, size=SMALL).tracked
    with pytest.raises(ValueError, match="marker"):
        estimated(TrackedFrame(tracked.frame, tracked.camera, None))


# Pictures that are not ours


def known_errors_deg(folder: str) -> dict[str, float | None]:
    """By picture with a known light: the error, or None without an answer."""
    errors: dict[str, float | None] = {}
    for case in read_cases(shared_folder(folder)):
        if case.to_lights_marker is not None and len(case.to_lights_marker):
            light = estimated(case.tracked()).light
            errors[case.id] = None if light is None else apart_deg(light.to_light_marker, case.to_lights_marker[0])
    return errors


def test_photos_in_sunlight() -> None:
    errors = known_errors_deg("real")
    assert errors
    assert all(error is None or error < 8 for error in errors.values()), errors


def test_the_papers_scenes() -> None:
    errors = [error for error in known_errors_deg("paper_scenes").values() if error is not None]
    assert len(errors) >= 7
    assert np.mean(errors) < 3
