"""A shadow's edge across a print: its light is told from the print, and another print's ink is no shadow."""

from collections.abc import Callable
from functools import cache

import numpy as np
import pytest

from ashe_live.bench.track.frames import CLEAN_CAMERA, Flaws, PrintedMarker, ground
from ashe_live.bench.track.measures import turn_deg
from ashe_live.bench.track.takes import SIDE_M, SMALL, pose_at
from ashe_live.core.arrays import Image
from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT, srgb_from_linear
from ashe_live.core.square import mean_side_px, square_corners
from ashe_live.core.transforms import project
from ashe_live.quality import BALANCED
from ashe_live.tracking.edges.edge_profiles import Light, LightPatch, linear_light
from ashe_live.tracking.edges.quads import dark_quads, ink_quads
from ashe_live.tracking.families.markers import Marker, parse_marker
from ashe_live.tracking.tracker import MarkerTracker
from tests.tracking.conftest import SPECS, frame, is_among, photographed

MARKER = parse_marker("aruco:4x4_50:0")
POSE = pose_at(0.55, 25, 20)
CORNERS = project(SMALL, POSE, square_corners(SIDE_M))


def shot(marker: Marker, flaws: Flaws, seed: int) -> Image:
    """(h, w) grey picture."""
    image = PrintedMarker(marker.bitmap(240), SIDE_M, SMALL, flaws, 3).painted(
        [POSE], np.random.default_rng(seed), ground(SMALL)
    )
    return np.ascontiguousarray(image[:, :, 0])


@cache  # those in even light are compared with several shadows
@cache  # those in even light are compared with several shadows
def samples_of(marker: Marker, flaws: Flaws, seed: int) -> Light:
    alignment = MARKER.alignment
    view = LightPatch(linear_light(shot(marker, flaws, seed)), SMALL, np.zeros(2))
    return alignment.sampled(alignment.blurred(view, CORNERS), CORNERS)


@pytest.mark.parametrize("ratio", [0.5, 0.3, 0.2, 0.12])
def test_what_is_left_without_the_shadow_is_the_print(ratio: float) -> None:
    alignment = MARKER.alignment
    for seed in range(12):
        even, shaded = (samples_of(MARKER, Flaws(shadow_ratio=each), seed) for each in (1.0, ratio))
        shade = alignment.shade.on(shaded)
        assert shade is not None
        told = np.median(shade.light[shade.light < 0.5 * (1 + ratio)])
        assert told == pytest.approx(ratio, rel=0.2)
        away = ~shade.edge
        # By a camera that rounds, ink in deep shade is known to some of its own light.
        assert np.abs(shade.removed_from(shaded) - even)[away].mean() < 0.04 * np.ptp(even)
        assert alignment.is_print(shade.removed_from(shaded))


@pytest.mark.parametrize("gamma", [1 / 1.3, 1.3])
def test_a_tone_curve_is_measured_beside_the_shadows_edge_as_in_even_light(gamma: float) -> None:
    """At that edge the samples are the print's own, whose edges no tone curve has moved."""
    alignment, side_px = MARKER.alignment, mean_side_px(CORNERS)
    told: list[tuple[float | None, float | None]] = []
    for seed in range(16):
        even, shaded = (samples_of(MARKER, Flaws(gamma=gamma, shadow_ratio=each), seed) for each in (1.0, 0.3))
        shade = alignment.shade.on(shaded)
        assert shade is not None
        without = shade.removed_from(shaded)
        told.append((alignment.bleed_px(even, side_px), alignment.bleed_px(without, side_px, shade)))
    in_even_light, beside_edge = np.array(told, np.float64).mean(axis=0)
    assert abs(in_even_light) > 0.1
    assert beside_edge == pytest.approx(in_even_light, rel=0.1)


@pytest.mark.parametrize("flaws", [CLEAN_CAMERA, Flaws(blur_px=5), Flaws(gain=0.1), Flaws(vignetting=0.9)])
def test_even_light_has_no_shadow(flaws: Flaws) -> None:
    assert all(MARKER.alignment.shade.on(samples_of(MARKER, flaws, seed)) is None for seed in range(4))


@pytest.mark.parametrize("ratio", [0.3, 0.15])
def test_ink_where_the_print_is_white_is_no_shadow(ratio: float) -> None:
    """Other markers of the dictionary that a shadow crosses, those among them that are most easily mistaken."""
    alignment = MARKER.alignment
    for number in (28, 49, *range(1, 28, 5)):
        other = parse_marker(f"aruco:4x4_50:{number}")
        for turns in range(4):
            samples = np.rot90(samples_of(other, Flaws(shadow_ratio=ratio), number), turns)
            for shade in (alignment.shade.on(samples), alignment.shade.penumbra_on(samples)):
                assert not alignment.is_print(samples if shade is None else shade.removed_from(samples))


def in_penumbra(marker: Marker, width: float, ratio: float, seed: int) -> Image:
    """(h, w) grey: the light falls to `ratio` within `width` sides, as under a lamp that is a uniform strip."""
    rng = np.random.default_rng(seed)
    n, margin = 240, 80
    paper = np.pad(marker.bitmap(n), margin, constant_values=255)
    y, x = (np.indices(paper.shape) - (len(paper) - 1) / 2) / n
    angle = rng.uniform(0, 2 * np.pi)
    share = np.clip(0.5 + (np.cos(angle) * x + np.sin(angle) * y - rng.uniform(-0.3, 0.3)) / width, 0, 1)
    light = 0.72 * (LINEAR_FROM_SRGB_8BIT[paper] + 0.04) * (ratio + (1 - ratio) * share)
    encoded = (255 * srgb_from_linear(light)).round().astype(np.uint8)
    middle_px = (len(paper) - 1) / 2
    return np.ascontiguousarray(photographed(encoded, SIDE_M / n, (middle_px, middle_px), SMALL, POSE)[:, :, 0])


@pytest.mark.parametrize("width", [0.5, 0.8, 1.4])
def test_a_wide_penumbra_hides_no_marker(width: float) -> None:
    for seed in range(12):
        grey = in_penumbra(MARKER, width, 0.08, seed)
        tracker = MarkerTracker(MARKER, SMALL, SIDE_M, BALANCED.tracking)
        found = tracker.track(frame(np.repeat(grey[:, :, None], 3, axis=2), 0)).marker
        assert found is not None
        assert turn_deg(found.measured_T_cam_marker, POSE) < 0.5


@pytest.mark.parametrize("width", [0.1, 0.5, 1.2])
def test_what_is_left_without_a_penumbra_is_the_print(width: float) -> None:
    alignment = MARKER.alignment
    for seed in range(6):
        view = LightPatch(linear_light(in_penumbra(MARKER, width, 0.1, seed)), SMALL, np.zeros(2))
        shade = alignment.shade.penumbra_on(alignment.sampled(alignment.blurred(view, CORNERS), CORNERS))
        assert shade is not None
        without = shade.removed_from(alignment.sampled(alignment.blurred(view, CORNERS), CORNERS))
        assert alignment.is_print(without)


@pytest.mark.parametrize("width", [0.5, 1.2])
def test_a_penumbra_makes_no_other_print_of_a_marker(width: float) -> None:
    alignment = MARKER.alignment
    for number in (28, 49, *range(1, 28, 3)):
        view = LightPatch(
            linear_light(in_penumbra(parse_marker(f"aruco:4x4_50:{number}"), width, 0.1, number)), SMALL, np.zeros(2)
        )
        seen = alignment.sampled(alignment.blurred(view, CORNERS), CORNERS)
        for turns in range(4):
            samples = np.ascontiguousarray(np.rot90(seen, turns))
            shade = alignment.shade.penumbra_on(samples)
            assert shade is None or not alignment.is_print(shade.removed_from(samples))


@pytest.mark.parametrize("spec", SPECS)
def test_a_marker_is_found_wherever_a_shadows_edge_crosses_it(spec: str, marker_of: Callable[[str], Marker]) -> None:
    marker = marker_of(spec)
    for seed in range(10):
        flaws = Flaws(shadow_ratio=0.2 if seed % 2 else 0.3)
        grey = shot(marker, flaws, seed)
        tracker = MarkerTracker(marker, SMALL, SIDE_M, BALANCED.tracking)
        found = tracker.track(frame(np.repeat(grey[:, :, None], 3, axis=2), 0)).marker
        assert found is not None
        assert turn_deg(found.measured_T_cam_marker, POSE) < 0.5


def test_paper_in_a_deep_shadow_is_no_ink() -> None:
    """Its edge makes one dark area of shaded paper and ink by the mean around each pixel, and not by the brightest."""
    pictures = [shot(MARKER, Flaws(shadow_ratio=0.12), seed) for seed in range(20)]
    assert all(is_among(ink_quads(grey), CORNERS) for grey in pictures)
    assert not all(is_among(dark_quads(grey), CORNERS) for grey in pictures)
