"""`bench render`: its parts, small; its figures are the machine's and not held here."""

import numpy as np
import pytest

from ashe_live.bench.render.bench import RenderBench
from ashe_live.bench.render.cost import (
    cost_of,
    lamps_around,
    lights_around,
    memory_growth,
    orbit,
    round_model,
    sweeps,
)
from ashe_live.capture.clips.known_clip import shipped_clip
from ashe_live.errors import UserError
from ashe_live.models.mesh import Model
from ashe_live.models.placement import placed_on_marker
from ashe_live.models.primitives import box
from ashe_live.quality import BALANCED, FAST
from ashe_live.render.gl.offscreen import offscreen_context

SIZE = (160, 120)


@pytest.mark.parametrize("triangles", [1_000, 10_000, 100_000])
def test_vase_has_as_many_triangles_as_it_is_asked_for(triangles: int) -> None:
    assert round_model(triangles).model.triangle_count == pytest.approx(triangles, rel=0.05)


def test_costs_are_ordered_and_the_pictures_show_the_model() -> None:
    ctx = offscreen_context()
    scenes = orbit(SIZE, round_model(1_000), lights_around(2), views=3)
    cost = cost_of(ctx, FAST.render, SIZE, scenes, frames=6)
    assert 0 < cost.p50 <= cost.p99
    assert cost.gpu_p50 is None or 0 < cost.gpu_p50 <= cost.p99
    assert {name: len(settings) for name, settings in sweeps(BALANCED.render).items()} == {
        "triangles": 4,
        "lights": 5,
        "depth map": 4,
        "samples": 4,
    }


def test_a_lamp_and_a_sun_that_are_compared_differ_in_their_distance_alone() -> None:
    (sun,), (lamp,) = lights_around(1), lamps_around(1)
    assert (sun.kind, lamp.kind) == ("directional", "lamp")
    np.testing.assert_array_equal(sun.to_light_marker, lamp.to_light_marker)
    np.testing.assert_array_equal(sun.shadow_rgb_ratio, lamp.shadow_rgb_ratio)


def test_nothing_stays_behind_over_many_pictures_and_model_switches() -> None:
    models = [placed_on_marker(Model(f"{n}", (box((1, 1, n)),)), 0.08) for n in (1, 2, 3)]
    views = orbit(SIZE, None, lights_around(1), views=4)
    ctx = offscreen_context()
    found = memory_growth(ctx, FAST.render, models, lambda number: views[number % len(views)], frames=300)
    assert found["end_gl_objects"] <= found["start_gl_objects"]
    assert found["end_mib"] - found["start_mib"] < 4


@pytest.mark.parametrize("name", ["results.json", "error.svg", "error.png", "cost.png"])
def test_nothing_that_it_writes_is_overwritten_unasked(tmp_path, name: str) -> None:
    kept = tmp_path / name
    kept.write_bytes(b"mine")
    with pytest.raises(UserError, match=name):
        RenderBench(shipped_clip(), 2).run(tmp_path)
    assert kept.read_bytes() == b"mine"
