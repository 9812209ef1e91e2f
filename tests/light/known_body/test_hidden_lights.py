"""Lights whose shadow the cube hides from the camera: told by its sides, less surely; and what no side tells."""

import math
from dataclasses import replace

import numpy as np
import pytest

from ashe_live.bench.cube.scenes import SETS
from ashe_live.core.arrays import Float
from ashe_live.core.light import LightEstimate
from ashe_live.core.transforms import angle_between, direction_from_angles
from ashe_live.core.types import TrackedFrame
from ashe_live.light.estimators.estimator import make_estimator
from ashe_live.light.known_body import candidates, lights
from ashe_live.light.known_body.marginal_likelihood import MarginalLikelihood
from ashe_live.light.known_body.seen import Seen
from ashe_live.light.pixels.view import View
from ashe_live.light.shape.light_points import at_infinity
from ashe_live.quality import BALANCED
from ashe_live.tracking.families.layout import cube_layout
from ashe_live.tracking.tracker import MarkerTracker
from tests.painted_cubes import CAMERA, EDGE_M, CubeScene, PaintedLight, frame_of, looking, sun

FROM_DEG, TILT_DEG = 210, 55  # the camera's azimuth, and how far from straight above it looks


def estimate(*lights: PaintedLight, tilt_deg: float = TILT_DEG, **scene: object) -> LightEstimate:
    view = looking(0.4, tilt_deg, FROM_DEG)
    frame = frame_of(CubeScene(CAMERA, view, lights, **scene))  # type: ignore[arg-type]
    return make_estimator("proxy").estimate(
        MarkerTracker(cube_layout(), CAMERA, EDGE_M, BALANCED.tracking).track(frame)
    )


@pytest.mark.parametrize("elevation_deg", [40, 45])
def test_a_sun_behind_the_camera_is_found_by_the_sides(elevation_deg: float) -> None:
    light = sun(FROM_DEG + 2, elevation_deg)
    answer = estimate(light)
    assert len(answer.lights) == 1
    found = answer.lights[0]
    error = angle_between(found.to_light_marker, light.point[:3])
    assert error < math.radians(10)
    assert found.sigma_rad is not None
    assert found.sigma_rad > math.radians(4)  # nothing tells it better
    assert error < 2 * found.sigma_rad
    assert found.confidence is not None
    assert 0.4 < found.confidence < 0.95


def test_it_beside_one_whose_shadow_is_seen() -> None:
    seen, hidden = sun(FROM_DEG + 100, 35, on_table=0.3), sun(FROM_DEG, 42, on_table=0.5)
    answer = estimate(seen, hidden)
    assert len(answer.lights) == 2
    errors = np.degrees(
        [[angle_between(f.to_light_marker, t.point[:3]) for f in answer.lights] for t in (seen, hidden)]
    )
    assert errors[0].min() < 0.5
    assert errors[1].min() < 12


@pytest.mark.parametrize("slope", [(0.0, 0.0), (0.3, 0.0), (-0.2, -0.2)])
def test_a_leaning_sky_is_no_sun(slope: tuple[float, float]) -> None:
    answer = estimate(sky_slope=np.array([*slope, 0.0]), sky_rgb=np.full(3, 0.5))
    assert not [light for light in answer.lights if light.confidence is None or light.confidence > 0.5]


def test_a_second_light_too_weak_to_be_found_in_any_one_direction_is_found_in_all_together() -> None:
    seen, hidden = sun(FROM_DEG + 75, 38, on_table=0.3), sun(FROM_DEG + 10, 58, on_table=0.6)
    answer = estimate(seen, hidden)
    assert len(answer.lights) == 2
    # The one whose shadow is seen comes first, though it is the weaker one.
    first, second = answer.lights
    assert angle_between(first.to_light_marker, seen.point[:3]) < math.radians(0.5)
    error = angle_between(second.to_light_marker, hidden.point[:3])
    assert second.sigma_rad is not None
    assert error < 2 * second.sigma_rad
    assert second.confidence is not None
    assert second.confidence < 0.9  # it says that nothing tells its direction well


def test_one_that_may_be_anywhere_is_stated_after_one_that_is_known() -> None:
    """Though it is the stronger one, and some of its shadow's edges are seen beside the cube's foot."""
    scene = list(next(one for one in SETS if one.name == "two suns").scenes(24, 90210))[23]
    tracked = MarkerTracker(cube_layout(), CAMERA, EDGE_M, BALANCED.tracking).track(frame_of(scene))
    first, second = make_estimator("proxy").estimate(tracked).lights
    assert min(angle_between(first.to_light_marker, each.point[:3]) for each in scene.lights) < math.radians(2)
    assert first.sigma_rad is not None
    assert second.sigma_rad is not None
    assert second.sigma_rad > 4 * first.sigma_rad


def test_a_second_shadow_is_found_though_stains_lead_the_map_away_from_it(monkeypatch: pytest.MonkeyPatch) -> None:
    lights = sun(FROM_DEG + 110, 35, on_table=0.4), sun(FROM_DEG - 100, 40, on_table=0.15)
    nearby, calls = candidates._nearby, []

    def led_away(seen: Seen, template: Float, beside: MarginalLikelihood) -> candidates._Start:
        start = nearby(seen, template, beside)
        calls.append(template)
        # Towards the camera, where the cube hides the shadow.
        behind = at_infinity(direction_from_angles(math.radians(FROM_DEG), math.radians(60))[None])[0]
        return start if len(beside.darkenings) == 0 else replace(start, light=behind)

    monkeypatch.setattr(candidates, "_nearby", led_away)
    answer = estimate(*lights)
    assert calls
    errors = [[angle_between(f.to_light_marker, t.point[:3]) for f in answer.lights] for t in lights]
    assert np.max(np.min(errors, axis=1)) < math.radians(1)


@pytest.mark.parametrize("slope", [(0.0, 0.0), (0.3, 0.0), (0.0, -0.3), (-0.2, -0.2)])
def test_a_leaning_sky_beside_a_sun_is_no_second_light(slope: tuple[float, float]) -> None:
    answer = estimate(sun(FROM_DEG + 100, 40, on_table=0.5), sky_slope=np.array([*slope, 0.0]))
    assert len(answer.lights) == 1


@pytest.mark.parametrize(
    ("behind_camera", "in_view", "is_stated"), [(8.0, 2.0, True), (8.0, 12.0, False), (4.5, -9.0, False)]
)
def test_a_hidden_light_is_as_likely_as_a_second_one_and_likelier_than_another_thing(
    behind_camera: float, in_view: float, is_stated: bool
) -> None:
    """A stain looks a little like a hidden light's absence, too; and three of four suns shine alone."""
    view = looking(0.4, TILT_DEG, FROM_DEG)
    known, behind = sun(FROM_DEG + 100, 35, on_table=0.3), sun(FROM_DEG, 42, on_table=0.4)
    frame = frame_of(CubeScene(CAMERA, view, [known, behind]))
    marker = MarkerTracker(cube_layout(), CAMERA, EDGE_M, BALANCED.tracking).track(frame).marker
    assert marker is not None
    assert marker.body is not None
    seen = Seen.of(View.of(TrackedFrame(frame, CAMERA, marker), 640), marker.body)
    assert seen is not None
    to_lights = seen.templates.lights[:, :3]
    to_behind, to_aside = behind.point[:3], direction_from_angles(math.radians(FROM_DEG + 180), math.radians(42))
    score = np.full(len(to_lights), -9.0)
    score[to_lights @ to_behind > 0.98], score[to_lights @ to_aside > 0.98] = behind_camera, in_view
    hidden = lights._hidden(seen, score, to_lights @ to_behind < 0.9, seen.beside(known.point[None]))
    assert (hidden is not None) == is_stated
