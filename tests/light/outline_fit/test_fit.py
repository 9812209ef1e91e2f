"""The fit on masks made by plain geometry: true directions, laws of symmetry, honest errors, and the extremes."""

import math
from collections.abc import Callable
from dataclasses import replace

import cv2
import numpy as np
import pytest

from ashe_live.bench.cases import read_cases
from ashe_live.core.arrays import Float, Mask
from ashe_live.core.camera import Camera
from ashe_live.core.caster import Caster
from ashe_live.core.transforms import angle_between, angles_from_direction, rigid
from ashe_live.light.outline_fit.fit import Masks, fit_bodies
from ashe_live.light.outline_fit.preset import BALANCED, FAST, FitPreset
from ashe_live.light.shape.body import LitBody
from ashe_live.light.shape.sight import Sight
from tests.light.synthetic_masks import (
    MaskedScene,
    Parts,
    ball,
    box,
    camera_towards,
    direction,
    ell,
    render,
    turned,
)
from tests.shared_data import shared_folder
from tests.shipped_scenes import CASES, LIT

BODIES: dict[str, Callable[[], Parts]] = {
    "box": lambda: box(0.1, 0.02, (0.06, 0.04, 0.08), 25.0),
    "cylinder": lambda: turned(0.1, 0.02, [(0.03, 0.0), (0.03, 0.1)]),
    "cone": lambda: turned(0.1, 0.02, [(0.04, 0.0), (0.0, 0.09)]),
    "cup": lambda: turned(0.1, 0.02, [(0.025, 0.0), (0.04, 0.09)]),
    "bottle": lambda: turned(0.1, 0.02, [(0.03, 0.0), (0.03, 0.08), (0.012, 0.12)]),
    "ball": lambda: ball(0.1, 0.02, 0.035),
    "ell": lambda: ell(0.1, 0.02, 160.0),
}
VIEW = camera_towards((0.08, 0.0), 0.5, 35.0)
LIGHT = direction(200.0, 40.0)


def best_of(masks: Masks, preset: FitPreset = BALANCED) -> LitBody | None:
    """The likeliest body; None where none fits."""
    (found,) = fit_bodies([masks], preset)
    return None if found is None else found.bodies[0]


def fitted(scene: MaskedScene, preset: FitPreset = BALANCED) -> LitBody:
    fit = best_of(Masks(scene.body, scene.shadows, Sight(scene.camera, scene.T_cam_marker)), preset)
    assert fit is not None
    return fit


def error_deg(fit: LitBody, truth: Float, index: int = 0) -> float:
    return math.degrees(angle_between(fit.to_lights_marker[index], truth))


@pytest.mark.parametrize("azimuth_deg", [20.0, 110.0, 200.0, 290.0])
@pytest.mark.parametrize("name", BODIES)
def test_every_family_finds_its_light(name: str, azimuth_deg: float) -> None:
    light = direction(azimuth_deg, 45.0)
    assert error_deg(fitted(render(BODIES[name](), [light], VIEW)), light) < 1.5


@pytest.mark.parametrize("name", ["box", "cylinder", "ball"])
def test_small_pictures_suffice(name: str) -> None:
    scene = render(BODIES[name](), [LIGHT], VIEW, (320, 240))
    assert error_deg(fitted(scene), LIGHT) < 2.0


@pytest.mark.parametrize("name", ["box", "cylinder", "ball"])
def test_the_fast_preset_knows_the_plain_families(name: str) -> None:
    assert error_deg(fitted(render(BODIES[name](), [LIGHT], VIEW), FAST), LIGHT) < 1.5


def test_two_shadows_share_one_body() -> None:
    lights = [direction(200.0, 45.0), direction(330.0, 35.0)]
    fit = fitted(render(BODIES["cup"](), lights, VIEW))
    assert [error_deg(fit, light, i) < 1.0 for i, light in enumerate(lights)] == [True, True]


def test_the_proxy_is_the_body() -> None:
    fit = fitted(render(BODIES["cylinder"](), [LIGHT], VIEW))
    points = fit.body.proxy.points_marker()
    assert np.allclose(points.min(axis=0), (0.07, -0.01, 0.0), atol=0.003)
    assert np.allclose(points.max(axis=0), (0.13, 0.05, 0.1), atol=0.003)


# Laws


def test_turning_the_marker_turns_the_answer() -> None:
    scene = render(BODIES["box"](), [LIGHT], VIEW)
    quarter = rigid([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]], np.zeros(3))
    first = fitted(scene)
    turned_pose = MaskedScene(scene.camera, VIEW @ quarter, scene.body, scene.shadows)
    second = fitted(turned_pose)
    assert np.allclose(quarter[:3, :3] @ second.to_lights_marker[0], first.to_lights_marker[0], atol=1e-3)


def test_a_larger_marker_leaves_the_direction() -> None:
    scene = render(BODIES["cup"](), [LIGHT], VIEW)
    far = VIEW.copy()
    far[:3, 3] *= 40.0
    first, second = fitted(scene), fitted(MaskedScene(scene.camera, far, scene.body, scene.shadows))
    assert np.allclose(second.to_lights_marker, first.to_lights_marker, atol=1e-6)
    assert np.allclose(second.body.proxy.spheroids_marker, 40 * first.body.proxy.spheroids_marker, atol=1e-4)


def test_a_mirrored_scene_has_the_mirrored_light() -> None:
    mirror = np.array([-1.0, 1.0, 1.0])
    view = camera_towards((0.0, 0.0), 0.5, 35.0)
    parts = [part - (0.1, 0.0, 0.0) for part in BODIES["box"]()]
    straight = fitted(render(parts, [LIGHT], view)).to_lights_marker[0]
    mirrored = fitted(render([part * mirror for part in parts], [LIGHT * mirror], view)).to_lights_marker[0]
    assert math.degrees(angle_between(straight * mirror, mirrored)) < 0.5


def test_the_same_masks_give_the_same_bits() -> None:
    scene = render(BODIES["ell"](), [LIGHT], VIEW)
    first, second = fitted(scene), fitted(scene)
    assert first.to_lights_marker[0].tobytes() == second.to_lights_marker[0].tobytes()
    assert first.body.shape.tobytes() == second.body.shape.tobytes()


def test_what_is_unreliable_is_not_measured() -> None:
    scene = render(BODIES["cylinder"](), [LIGHT], VIEW)
    _, xs = np.nonzero(scene.shadows[0])
    hidden = np.zeros(scene.body.shape, dtype=np.bool_)
    hidden[:, int(np.quantile(xs, 0.8)) :] = True
    shadow = scene.shadows[0] & ~hidden
    body = scene.body & ~hidden
    known = best_of(Masks(body, [shadow], Sight(scene.camera, VIEW), hidden))
    unknown = best_of(Masks(body, [shadow], Sight(scene.camera, VIEW)))
    assert known is not None
    assert unknown is not None
    assert error_deg(known, LIGHT) < error_deg(unknown, LIGHT)


def nearest_part(mask: Mask, other: Mask, share: float) -> Mask:
    """The share of `mask` that is nearest to `other`."""
    away = cv2.distanceTransform((~other).astype(np.uint8), cv2.DIST_L2, 5)
    return np.asarray(mask & (away <= np.quantile(away[mask], share)))


@pytest.mark.parametrize("share", [0.2, 0.5])
@pytest.mark.parametrize("whose", ["the object's", "the shadow's"])
@pytest.mark.parametrize("name", ["box", "cylinder", "cup"])
def test_what_may_be_either_is_known_by_the_outline_of_the_whole(name: str, whose: str, share: float) -> None:
    """Nobody knows whose these pixels are; only that they are of one of the two."""
    scene = render(BODIES[name](), [LIGHT], VIEW)
    body, shadow = scene.body, scene.shadows[0]
    undecided = nearest_part(body, shadow, share) if whose == "the object's" else nearest_part(shadow, body, share)
    sure = body & ~undecided, shadow & ~undecided
    fit = best_of(Masks(sure[0], [sure[1]], Sight(scene.camera, VIEW), undecided=undecided))
    assert fit is not None
    assert error_deg(fit, LIGHT) < 2.0
    # Given to the wrong one, they mislead.
    wrong = (sure[0], shadow | undecided) if whose == "the object's" else (body | undecided, sure[1])
    misled = best_of(Masks(wrong[0], [wrong[1]], Sight(scene.camera, VIEW)))
    assert misled is None or error_deg(misled, LIGHT) > error_deg(fit, LIGHT)


def test_nothing_that_may_be_either_changes_nothing() -> None:
    scene = render(BODIES["box"](), [LIGHT], VIEW)
    nothing = np.zeros_like(scene.body)
    fit = best_of(Masks(scene.body, scene.shadows, Sight(scene.camera, VIEW), undecided=nothing))
    assert fit is not None
    assert fit.to_lights_marker[0].tobytes() == fitted(scene).to_lights_marker[0].tobytes()


@pytest.mark.parametrize("near", [(0.0, 0.0), (3.0, -3.0), (-40.0, 40.0)])
def test_a_wrong_start_beside_the_guess_does_no_harm(near: tuple[float, float]) -> None:
    scene = render(BODIES["cylinder"](), [LIGHT], VIEW)
    start = np.array([[*near, 1.0, 0.0]])
    fit = best_of(Masks(scene.body, scene.shadows, Sight(scene.camera, VIEW), start=start))
    assert fit is not None
    assert error_deg(fit, LIGHT) < 1.5


@pytest.mark.parametrize("azimuth_deg", [20.0, 110.0, 200.0])
@pytest.mark.parametrize("name", ["box", "cylinder", "cup", "bottle"])
def test_a_lamps_direction_is_found_where_its_nearness_is_known(name: str, azimuth_deg: float) -> None:
    """The lamp stands less than four times as high as the bodies: for a sun its shadow is that of another body."""
    lamp_m = 0.4 * direction(azimuth_deg, 55.0)
    scene = render(BODIES[name](), [np.append(lamp_m, 1.0)], VIEW)
    masks = Masks(scene.body, scene.shadows, Sight(scene.camera, VIEW))
    as_sun, as_lamp = best_of(masks), best_of(replace(masks, nearness=1 / lamp_m[2]))
    assert as_sun is not None
    assert as_lamp is not None
    foot = np.array([*as_lamp.body.frame.origin_marker, 0.0])
    assert error_deg(as_lamp, lamp_m - foot) < 1.5
    assert error_deg(as_sun, lamp_m - foot) > 4.0


# Extremes


@pytest.mark.parametrize("elevation_deg", [80.0, 88.0, 89.9])
@pytest.mark.parametrize("name", ["box", "cylinder", "ball", "ell"])
def test_high_lights_are_found_as_long_as_there_is_a_shadow(name: str, elevation_deg: float) -> None:
    light = direction(160.0, elevation_deg)
    scene = render(BODIES[name](), [light], VIEW)
    fit = best_of(Masks(scene.body, scene.shadows, Sight(scene.camera, VIEW)))
    if scene.shadows[0].sum() < 10:
        assert fit is None
        return
    assert fit is not None
    assert error_deg(fit, light) < 1.0


def azimuth_error_deg(fit: LitBody, truth: Float) -> float:
    (azimuth, _), (true_azimuth, _) = (angles_from_direction(each) for each in (fit.to_lights_marker[0], truth))
    return abs(math.degrees(math.remainder(azimuth - true_azimuth, 2 * math.pi)))


@pytest.mark.parametrize("elevation_deg", [4.0, 8.0])
@pytest.mark.parametrize("name", ["box", "cylinder", "ball", "ell"])
def test_of_a_shadow_that_leaves_the_picture_the_azimuth_is_known(name: str, elevation_deg: float) -> None:
    light = direction(160.0, elevation_deg)
    assert azimuth_error_deg(fitted(render(BODIES[name](), [light], VIEW)), light) < 1.0


@pytest.mark.parametrize("pitch_deg", [3.0, 8.0, 75.0, 90.0])
def test_from_the_ground_and_from_above(pitch_deg: float) -> None:
    view = camera_towards((0.08, 0.0), 0.6, pitch_deg)
    fit = fitted(render(BODIES["box"](), [direction(40.0, 35.0)], view))
    assert error_deg(fit, direction(40.0, 35.0)) < 6.0


@pytest.mark.parametrize("target", [(0.27, 0.0), (-0.12, 0.0), (0.08, 0.2), (0.08, -0.2)])
def test_what_the_frame_cuts_does_not_mislead(target: tuple[float, float]) -> None:
    scene = render(BODIES["cylinder"](), [LIGHT], camera_towards(target, 0.5, 35.0))
    assert azimuth_error_deg(fitted(scene), LIGHT) < 1.0


def test_twenty_pixels_are_enough_for_a_rough_answer() -> None:
    scene = render(BODIES["cylinder"](), [LIGHT], camera_towards((0.08, 0.0), 3.5, 35.0))
    assert scene.body.sum() < 600
    assert error_deg(fitted(scene), LIGHT) < 10.0


def random_mask(rng: np.random.Generator, shape: tuple[int, int]) -> Mask:
    kind = rng.integers(6)
    if kind < 3:
        return rng.random(shape) >= (1.0, 0.0, 0.9)[kind]
    mask = np.zeros(shape)
    for _ in range(int(rng.integers(1, 4))):
        centre = tuple(int(v) for v in rng.integers(-5, 60, 2))
        cv2.circle(mask, centre, int(rng.integers(0, 25)), 1.0, -1)
    return mask > 0


def test_no_masks_and_no_pose_break_it() -> None:
    """Whatever comes in, a finite direction above the ground comes out, or none."""
    rng = np.random.default_rng(5)
    camera = Camera.from_hfov((60, 45), 60.0)
    answered = 0
    for _ in range(300):
        view = camera_towards((0.0, 0.0), float(rng.uniform(0.05, 2)), float(rng.uniform(-5, 90)), rng.uniform(0, 360))
        masks = [random_mask(rng, (45, 60)) for _ in range(3)]
        undecided = random_mask(rng, (45, 60)) if rng.integers(2) else None
        fit = best_of(Masks(masks[0], masks[1:2], Sight(camera, view), masks[2], undecided=undecided), FAST)
        if fit is None:
            continue
        answered += 1
        assert np.isfinite(fit.to_lights_marker).all()
        assert fit.to_lights_marker[0][2] >= 0
        assert np.isfinite(fit.body.proxy.points_marker()).all()
    assert answered > 10


def test_without_an_object_a_shadow_or_a_view_from_above_nothing_fits() -> None:
    scene = render(BODIES["box"](), [LIGHT], VIEW)
    nothing = np.zeros_like(scene.body)
    below = camera_towards((0.0, 0.0), 0.5, -20.0)
    cases = (nothing, scene.shadows[0], VIEW), (scene.body, nothing, VIEW), (scene.body, scene.shadows[0], below)
    for body, shadow, view in cases:
        assert best_of(Masks(body, [shadow], Sight(scene.camera, view))) is None


# Rendered scenes, with their true masks


def test_the_papers_scenes_are_solved() -> None:
    errors = []
    for case in read_cases(shared_folder("paper_scenes")):
        masks = [cv2.imread(str(case.mask_paths[name]), cv2.IMREAD_GRAYSCALE) > 127 for name in ("object", "shadow")]
        fit = best_of(Masks(masks[0], masks[1:], Sight(case.camera, case.marker.T_cam_marker)))
        assert fit is not None
        assert case.to_lights_marker is not None
        errors.append(error_deg(fit, case.to_lights_marker[0]))
    assert np.mean(errors) < 0.5
    assert max(errors) < 1.0


@pytest.mark.parametrize("name", [name for name in LIT if CASES[name].category in ("clean", "texture", "low")])
def test_shipped_scenes_are_solved(name: str) -> None:
    case = CASES[name]
    body, shadow = case.mask("object"), case.mask("shadow")
    assert body is not None
    assert shadow is not None
    assert case.to_lights_marker is not None
    fit = best_of(Masks(body, [shadow], Sight(case.camera, case.marker.T_cam_marker)))
    assert fit is not None
    assert error_deg(fit, case.to_lights_marker[0]) < 2


KNOWN = {
    "box": Caster.box(0.06, 0.04, 0.08),
    "cylinder": Caster.cylinder(0.03, 0.1),
    "ball": Caster.sphere(0.035),
    "cone": Caster.hull(turned(0.0, 0.0, [(0.04, 0.0), (0.0, 0.09)])[0]),
    "ell": Caster.hull(np.concatenate(ell(0.0, 0.0, 0.0))),
}


@pytest.mark.parametrize("azimuth_deg", [20.0, 110.0, 200.0, 290.0])
@pytest.mark.parametrize("name", KNOWN)
def test_a_known_body_is_found_where_it_stands_and_so_is_its_light(name: str, azimuth_deg: float) -> None:
    light = direction(azimuth_deg, 45.0)
    fit = fitted(render(BODIES[name](), [light], VIEW), replace(BALANCED, caster=KNOWN[name]))
    assert error_deg(fit, light) < 1.0
    points = fit.body.proxy.points_marker(60)
    truth = np.concatenate(BODIES[name]())
    np.testing.assert_allclose(points.min(axis=0), truth.min(axis=0), atol=0.0015)
    np.testing.assert_allclose(points.max(axis=0), truth.max(axis=0), atol=0.0015)


def test_the_sizes_of_a_known_body_are_not_fitted() -> None:
    preset = replace(FAST, caster=Caster.cylinder(0.033, 0.11))
    fit = fitted(render(BODIES["cylinder"](), [LIGHT], VIEW), preset)
    assert fit.body.proxy.spheroids_marker[1, 2] == pytest.approx(0.11)
    np.testing.assert_allclose(fit.body.proxy.spheroids_marker[:, 3], 0.033)
