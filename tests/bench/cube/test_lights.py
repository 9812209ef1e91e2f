"""What the cube's bench makes of answers: errors by the nearest true light, counts, calibration, lamps."""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
import pytest

from ashe_live.bench.cube import lights as lights_module
from ashe_live.bench.cube.ambient import NORMALS
from ashe_live.bench.cube.lights import light_row
from ashe_live.bench.cube.pictures import CubePicture
from ashe_live.bench.metrics import BAD_CONFIDENCE, BAD_DEG
from ashe_live.core.arrays import Float, Image
from ashe_live.core.camera import Camera
from ashe_live.core.light import Illumination, Light, LightEstimate
from ashe_live.core.transforms import ELLIPSE_95, direction_from_angles, rigid
from ashe_live.core.types import Frame, MarkerPose, TrackedFrame
from ashe_live.quality import BALANCED, Quality

CAMERA = Camera.from_hfov((8, 6), 60)
SIGMA_RAD = math.radians(2)
SKY = np.full(3, 0.4)
SURE, UNSURE = BAD_CONFIDENCE + 0.2, BAD_CONFIDENCE - 0.2
BLIND = 255  # the level of pictures in which no marker is found


def towards(azimuth_deg: float, distance_m: float | None = None) -> Float:
    """(4,) a light 40 degrees high: a sun, or a lamp so far away."""
    to_light = direction_from_angles(math.radians(azimuth_deg), math.radians(40))
    return np.append(to_light, 0.0) if distance_m is None else np.append(distance_m * to_light, 1.0)


def aside(degrees: float) -> float:
    """By how much the azimuth of a light 40 degrees high differs from another's that is so many degrees away."""
    return math.degrees(2 * math.asin(math.sin(math.radians(degrees / 2)) / math.cos(math.radians(40))))


def answered(*points: Float, confidence: float = SURE) -> LightEstimate:
    lights = tuple(
        Light(
            point[:3],
            covariance_rad2=SIGMA_RAD**2 * np.eye(2),
            confidence=confidence,
            inverse_distance=float(point[3] / np.linalg.norm(point[:3])),
        )
        for point in points
    )
    none = None if lights else "nothing there"
    return LightEstimate("proxy", 0, Illumination(lights, ambient_rgb_ratio=SKY), none)


def picture(*lights: Float, level: int = 0, **more: object) -> CubePicture:
    up = np.linspace(-1, 1, NORMALS)[:, None]
    one = CubePicture(
        "one", shown(level), CAMERA, np.eye(4), 0.06, np.array(lights).reshape(-1, 4), True, (1 + up) / 2 * SKY, SKY
    )
    return replace(one, **more)  # type: ignore[arg-type]


def shown(level: int) -> Image:
    return np.full((6, 8, 3), level, np.uint8)


class Tracker:
    """Finds the cube in all pictures but the blind ones."""

    def __init__(self, *_: object) -> None: ...

    def track(self, frame: Frame) -> TrackedFrame:
        pose = MarkerPose(rigid(np.diag((1.0, -1, -1)), (0, 0, 0.4)), np.zeros((4, 2)), 0.06, 0.1, None)
        return TrackedFrame(frame, CAMERA, None if frame.image_bgr[0, 0, 0] == BLIND else pose)


Measure = Callable[..., dict[str, object]]


@pytest.fixture
def measured(monkeypatch: pytest.MonkeyPatch) -> Measure:
    """The row of pictures to which an estimator has these answers; `asked` gets the levels of what it was given."""
    monkeypatch.setattr(lights_module, "MarkerTracker", Tracker)

    def row(
        pictures: Sequence[CubePicture], *answers: LightEstimate, asked: list[list[int]] | None = None
    ) -> dict[str, object]:
        coming = iter(answers)

        class Answering:
            name = "proxy"

            def estimate(self, tracked: TrackedFrame, others: Sequence[TrackedFrame]) -> LightEstimate:
                if asked is not None:
                    asked.append([int(each.frame.image_bgr[0, 0, 0]) for each in (tracked, *others)])
                return next(coming)

        def make(_name: str, _preset: object) -> Answering:
            return Answering()

        monkeypatch.setattr(lights_module, "make_estimator", make)
        quality: Quality = BALANCED
        return light_row("a set", pictures, quality)

    return row


def test_errors_are_those_to_the_nearest_true_light_and_of_the_true_light_found_worst(measured: Measure) -> None:
    near, far = towards(100), towards(200)
    row = measured([picture(far, near)], answered(towards(100 + aside(3)), towards(200 + aside(5))))
    assert row["median_deg"] == pytest.approx(3)
    assert row["worse_median_deg"] == pytest.approx(5)
    assert (row["count_right"], row["sure_and_wrong"], row["answered"]) == (1.0, 0, 1.0)
    # A light that is not found is as far off as the nearest that is answered.
    alone = measured([picture(far, near)], answered(near))
    assert alone["median_deg"] == pytest.approx(0, abs=1e-6)
    assert alone["worse_median_deg"] == pytest.approx(math.degrees(math.acos(near[:3] @ far[:3])))
    assert alone["count_right"] == 0.0


@pytest.mark.parametrize(
    ("degrees", "confidence", "wrong"), [(BAD_DEG + 1, SURE, 1), (BAD_DEG - 1, SURE, 0), (BAD_DEG + 1, UNSURE, 0)]
)
def test_an_answer_is_wrong_that_is_sure_of_a_light_where_none_is(
    measured: Measure, degrees: float, confidence: float, wrong: int
) -> None:
    """It must be far from all true lights; of an answer's lights one such suffices, and under a cloudy sky any."""
    true = towards(100)
    off = towards(100 + aside(degrees))
    assert measured([picture(true)], answered(off, confidence=confidence))["sure_and_wrong"] == wrong
    assert measured([picture(true, off)], answered(off, confidence=confidence))["sure_and_wrong"] == 0
    assert measured([picture(true)], answered(true, off, confidence=confidence))["sure_and_wrong"] == wrong
    cloudy = measured([picture()], answered(true, confidence=confidence))
    assert cloudy["sure_and_wrong"] == (confidence > BAD_CONFIDENCE)
    assert (cloudy["median_deg"], cloudy["count_right"]) == (None, 0.0)


def test_only_pictures_that_show_a_shadow_count_where_shadows_are_seen(measured: Measure) -> None:
    true = towards(100)
    pictures = [picture(true), picture(true, shows_shadows=False)]
    row = measured(pictures, answered(towards(100 + aside(2))), answered(towards(100 + aside(9))))
    assert row["percentile_95_of_others_deg"] == pytest.approx(2)
    assert row["largest_deg"] == pytest.approx(9)
    assert row["shadow_hidden"] == 0.5


def test_an_ellipse_of_95_percent_has_the_truth_or_not(measured: Measure) -> None:
    true, edge = towards(100), math.degrees(math.sqrt(ELLIPSE_95) * SIGMA_RAD)
    pictures = [picture(true)] * 2
    row = measured(pictures, answered(towards(100 + aside(0.9 * edge))), answered(towards(100 + aside(1.1 * edge))))
    assert row["in_95_percent_ellipse"] == 0.5


def test_a_lamp_s_distance_counts_where_there_is_a_lamp(measured: Measure) -> None:
    pictures = [picture(towards(100, 0.4)), picture(towards(100)), picture(towards(100, 0.4))]
    row = measured(pictures, answered(towards(100, 0.5)), answered(towards(100, 0.9)), answered(towards(100)))
    assert row["stated_as_lamps"] == pytest.approx(2 / 3)
    assert row["distance_relative_error"] == pytest.approx(0.2)  # 0.4 m of 0.5 m


def test_frames_before_a_picture_are_views_where_they_are_given_together(measured: Measure) -> None:
    """Of those the ones in which the cube is seen; alone they only lead the tracker to it."""
    true, asked = towards(100), list[list[int]]()
    before = [shown(level) for level in (10, BLIND, 30)]
    pictures = [picture(true, level=40, before=before, together=together) for together in (True, False)]
    measured(pictures, answered(true), answered(true), asked=asked)
    assert asked == [[40, 10, 30], [40]]


def test_a_picture_without_an_answer_or_a_cube_is_one_without_an_answer(measured: Measure) -> None:
    true = towards(100)
    row = measured([picture(true), picture(true), picture(true, level=BLIND)], answered(true), answered())
    assert (row["pictures"], row["answered"], row["median_deg"]) == (
        3,
        pytest.approx(1 / 3),
        pytest.approx(0, abs=1e-6),
    )
    nothing = measured([])
    assert (nothing["pictures"], nothing["answered"], nothing["shadow_hidden"]) == (0, 0, None)
    assert (nothing["stated_as_lamps"], nothing["largest_deg"]) == (None, None)
