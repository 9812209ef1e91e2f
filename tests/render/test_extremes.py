"""Odd lights, sizes, places and machines: a right picture each time."""

import os
import subprocess
import sys
from dataclasses import replace

import moderngl
import numpy as np
import pytest

from ashe_live.core.light import Illumination
from ashe_live.models.primitives import box
from ashe_live.quality import BALANCED, QUALITIES
from ashe_live.render.scene import Scene
from tests.render.in_turns import in_turns

GREEN = (0.0, 1.0, 0.0, 1.0)
RATIO = (0.3, 0.3, 0.3)


def _is_green(picture: np.ndarray) -> np.ndarray:
    blue, green, red = np.moveaxis(picture.astype(int), 2, 0)
    return (green > red + 10) & (green > blue + 10)


@pytest.mark.parametrize(
    ("quality", "elevation_deg", "azimuth_deg"), in_turns([(0.5, -90.0), (0.5, 90.0), (90.0, -90.0), (90.0, 90.0)])
)
def test_low_and_upright_lights_before_and_behind_the_camera(
    make_renderer, stage, quality: str, elevation_deg: float, azimuth_deg: float
) -> None:
    renderer = make_renderer(QUALITIES[quality].render)
    tracked = stage.tracked(200, stage.pose(-90, 40, 0.4))
    model = stage.placed(box((0.03, 0.03, 0.05), GREEN))
    scene = Scene(tracked, model, Illumination((stage.light(azimuth_deg, elevation_deg, RATIO),)), shows_light=True)
    assert _is_green(stage.picture(renderer, scene)).sum() > 500
    # The arrow may lie over what is looked at.
    picture = stage.picture(renderer, replace(scene, shows_light=False))
    side = 1 if azimuth_deg < 0 else -1  # the shadow falls away from the light
    assert (stage.rgb_at(picture, tracked, (0, 0.1 * side, 0))[1] < 140) == (elevation_deg < 1)
    assert stage.rgb_at(picture, tracked, (0.08, 0, 0))[1] == 200


@pytest.mark.parametrize("side_m", [0.005, 2.0])
@pytest.mark.parametrize("size_m", [0.001, 10.0])
def test_smallest_and_largest_models_on_smallest_and_largest_markers(
    make_renderer, stage, side_m: float, size_m: float
) -> None:
    """A camera as far as the model needs; the marker's size is not the model's."""
    renderer = make_renderer(BALANCED.render)
    tracked = stage.tracked(200, stage.pose(-90, 40, 4 * size_m, target=(0, 0, size_m / 2)))
    tracked = replace(tracked, marker=replace(tracked.marker, side_m=side_m))
    model = stage.placed(box((size_m, size_m, size_m), GREEN))
    picture = stage.picture(renderer, Scene(tracked, model, Illumination((stage.light(180, 35, RATIO),))))
    assert 0.03 < _is_green(picture).mean() < 0.5
    assert stage.rgb_at(picture, tracked, (1.2 * size_m, 0, 0))[1] < 140
    assert stage.rgb_at(picture, tracked, (-1.2 * size_m, 0, 0))[1] > 190


@pytest.mark.parametrize(
    ("quality", "distance_m", "elevation_deg"), in_turns([(0.01, 40), (0.0001, 10), (50.0, 40), (0.3, -30)])
)
def test_camera_within_beneath_near_and_far(
    make_renderer, stage, quality: str, distance_m: float, elevation_deg: float
) -> None:
    tracked = stage.tracked(200, stage.pose(-90, elevation_deg, distance_m, target=(0, 0, 0.02)))
    picture = stage.picture(
        make_renderer(QUALITIES[quality].render),
        Scene(tracked, stage.placed(box((0.03, 0.03, 0.05), GREEN)), Illumination((stage.light(180, 35, RATIO),))),
    ).astype(int)
    assert not _is_green(picture).all()
    if distance_m > 0.1:  # else it is dark within the model, and rightly so
        assert picture.max(axis=2).min() > 40
    if elevation_deg < 0:
        assert (_is_green(picture) | (picture == 200).all(axis=2)).mean() > 0.995


@pytest.mark.parametrize(("quality", "size"), in_turns((size,) for size in ((1, 1), (3, 200), (700, 2))))
def test_tiniest_windows(make_renderer, stage, quality: str, size: tuple[int, int]) -> None:
    renderer = make_renderer(QUALITIES[quality].render)
    scene = Scene(
        stage.tracked(200, stage.pose(-90, 40)),
        stage.placed(box((0.1, 0.1, 0.1), GREEN)),
        Illumination((stage.light(180, 35),)),
    )
    before = stage.picture(renderer, scene)
    renderer.resize(size)
    assert stage.picture(renderer, scene).shape == (size[1], size[0], 3)
    renderer.resize((0, 0))
    renderer.render(scene)
    renderer.resize((480, 360))
    np.testing.assert_array_equal(stage.picture(renderer, scene), before)


def test_context_without_multisampling(ctx: moderngl.Context, make_renderer, stage, monkeypatch) -> None:
    monkeypatch.setattr(type(ctx), "max_samples", property(lambda _self: 0))
    scene = Scene(stage.tracked(200, stage.pose(-90, 40)), stage.placed(box((0.05, 0.05, 0.05), GREEN)))
    assert _is_green(stage.picture(make_renderer(BALANCED.render), scene)).sum() > 1000


def test_opengl_3_3_is_enough() -> None:
    """A driver that has no more than it: every preset draws what the newest one draws."""
    code = """
import numpy as np
from ashe_live.quality import QUALITIES
from ashe_live.render.gl.offscreen import offscreen_context
from ashe_live.bench.render.cost import lights_around, orbit, round_model
from ashe_live.render.renderer import SceneRenderer
ctx = offscreen_context()
scene = orbit((160, 120), round_model(200), lights_around(2))[1]
for quality in QUALITIES.values():
    renderer = SceneRenderer(ctx, quality.render, (160, 120))
    renderer.render(scene)
    print(ctx.version_code, int(renderer.read_bgr().astype(int).sum()), ctx.error)
"""
    found = []
    for limits in ({"MESA_GL_VERSION_OVERRIDE": "3.3", "MESA_GLSL_VERSION_OVERRIDE": "330"}, {}):
        ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env={**os.environ, **limits})
        assert ran.returncode == 0, ran.stderr
        found.append([line.split() for line in ran.stdout.splitlines()])
    assert [row[0] for row in found[0]] == ["330"] * 3
    assert [row[1:] for row in found[0]] == [row[1:] for row in found[1]]
    assert all(row[2] == "GL_NO_ERROR" for row in found[0])
