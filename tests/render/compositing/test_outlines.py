"""Outlines of layers with one sample a pixel, against the areas that lines cut off their pixels."""

import math
from collections.abc import Iterator

import numpy as np
import pytest

from ashe_live.core.arrays import Float
from ashe_live.render.compositing.outlines import OutlineSmoothing
from ashe_live.render.gl.programs import Programs
from ashe_live.render.passes.surface import Surface

SIDE = 64
WHOLE = (0, 0, SIDE, SIDE)
FINE = 16  # samples a pixel and axis that tell its true area
GREEN = np.array((0.1, 0.6, 0.2))
SHADED = 0.3  # of the video's light that is gone beside the model


@pytest.fixture
def smoothed(ctx) -> Iterator:
    """A function: layers (h, w, 4) of added and removed light as they are after smoothing."""
    surface, programs = Surface(ctx, (SIDE, SIDE), 0), Programs(ctx)
    outlines = OutlineSmoothing(ctx, programs)

    def smooth(added: Float, removed: Float) -> list[Float]:
        for layer, values in zip(surface.layers, (added, removed), strict=True):
            layer.write(np.ascontiguousarray(values, np.float16).tobytes())
        outlines.smooth(surface, WHOLE, WHOLE)
        return [np.frombuffer(each.read(), np.float16).reshape(SIDE, SIDE, 4).astype(float) for each in surface.layers]

    yield smooth
    ctx.detect_framebuffer(0).use()  # what is bound must not be released
    for held in (outlines, surface, programs):
        held.release()
    assert ctx.error == "GL_NO_ERROR"


def _below_line(slope: float, samples: int) -> Float:
    """(SIDE samples, SIDE samples) whether places lie below a line, in the middle of those with the same steps."""
    steps = (np.arange(SIDE * samples) + 0.5) / samples
    x, y = np.meshgrid(steps, steps)
    return y - SIDE / 2 - 0.45 < slope * (x - SIDE / 2)


@pytest.mark.parametrize("slope", [0.0, 0.07, 0.13, 0.3, 0.62, 1.0, -0.2, -0.9])
@pytest.mark.parametrize("upright", [False, True])
def test_pixels_on_a_line_are_covered_as_far_as_the_line_says(smoothed, slope: float, upright: bool) -> None:
    inside = _below_line(slope, 1)
    true = _below_line(slope, FINE).reshape(SIDE, FINE, SIDE, FINE).mean(axis=(1, 3))
    if upright:
        inside, true = inside.T, true.T
    added = np.where(inside[..., None], np.append(GREEN, 1.0), 0.0)
    removed = np.where(inside[..., None], 1.0, np.append(np.full(3, SHADED), 0.0))
    light, gone = smoothed(added, removed)
    well_within = slice(14, SIDE - 14)  # the longest steps that count end there
    on_line = ((true > 0) & (true < 1))[well_within, well_within]
    before = (inside - true)[well_within, well_within][on_line]
    after = (gone[..., 3] - true)[well_within, well_within][on_line]
    if slope:
        assert math.sqrt(np.square(after).mean()) < max(0.6 * math.sqrt(np.square(before).mean()), 0.05)
    # Both layers are made of the same shares of what is on either side.
    np.testing.assert_allclose(light[..., :3], gone[..., 3:] * GREEN, atol=2e-3)
    np.testing.assert_allclose(gone[..., 0], SHADED + (1 - SHADED) * gone[..., 3], atol=2e-3)


def test_what_changes_steadily_is_left_as_it_is(smoothed) -> None:
    x, y = np.meshgrid(np.arange(SIDE), np.arange(SIDE))
    added = np.ones((SIDE, SIDE, 4))
    added[..., :3] = (0.3 + 0.004 * x + 0.003 * y)[..., None]
    removed = np.ones((SIDE, SIDE, 4))
    for found, given in zip(smoothed(added, removed), (added, removed), strict=True):
        np.testing.assert_array_equal(found, given.astype(np.float16))


@pytest.mark.parametrize("is_painted", [True, False])
def test_only_steps_between_surfaces_are_smoothed(smoothed, is_painted: bool) -> None:
    """A dark half beside a bright one, of one surface or of two, as `removed`'s alpha has it."""
    inside = _below_line(0.3, 1)
    added = np.where(inside[..., None], (0.6, 0.6, 0.6, 1.0), (0.1, 0.1, 0.1, 1.0))
    removed = np.ones((SIDE, SIDE, 4))
    removed[..., 3] = 0.7 if is_painted else np.where(inside, 0.7, -0.2)
    light, _ = smoothed(added, removed)
    changed = np.abs(light - added.astype(np.float16)).max(axis=2) > 0.01
    assert changed.any() != is_painted


@pytest.mark.parametrize("slope", [0.13, 0.3, -0.9])
def test_where_the_real_object_ends_a_shadow_pixels_are_shaded_as_far_as_they_show_the_ground(smoothed, slope) -> None:
    """As ground.frag numbers the ground, and the real object has nothing in either layer."""
    ground = _below_line(slope, 1)
    true = _below_line(slope, FINE).reshape(SIDE, FINE, SIDE, FINE).mean(axis=(1, 3))
    removed = np.where(ground[..., None], np.append(np.full(3, SHADED), -0.02), 0.0)
    _, gone = smoothed(np.zeros((SIDE, SIDE, 4)), removed)
    well_within = slice(14, SIDE - 14)
    on_line = ((true > 0) & (true < 1))[well_within, well_within]
    before, after = ((each - true)[well_within, well_within][on_line] for each in (ground, gone[..., 0] / SHADED))
    assert math.sqrt(np.square(after).mean()) < max(0.6 * math.sqrt(np.square(before).mean()), 0.05)


def test_the_border_of_a_shadow_on_the_ground_is_no_outline(smoothed) -> None:
    shaded = _below_line(0.3, 1)
    removed = np.where(shaded[..., None], np.append(np.full(3, SHADED), -0.02), (0.01, 0.01, 0.01, -0.02))
    _, gone = smoothed(np.zeros((SIDE, SIDE, 4)), removed)
    np.testing.assert_allclose(gone, removed, atol=1e-3)


def test_a_leafs_rim_before_shaded_ground_is_smooth_already(smoothed) -> None:
    rim = _below_line(0.3, 1)
    removed = np.where(rim[..., None], np.append(np.full(3, 0.3), 0.29), (0.01, 0.01, 0.01, -0.02))
    added = np.where(rim[..., None], np.append(0.02 * GREEN, 0.3), 0.0)
    _, gone = smoothed(added, removed)
    np.testing.assert_allclose(gone, removed, atol=1e-3)
