"""What a picture costs, by a clock that only the renderer moves."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from ashe_live.bench.render import cost
from ashe_live.bench.render.cost import WARM_UP_FRAMES, cost_of, costs_by_turns, memory_growth, orbit, round_model
from ashe_live.core.transforms import project
from ashe_live.quality import FAST
from ashe_live.render.scene import Scene
from tests.bench.fake_clock import FakeClock

SIZE = (64, 48)
SCENES = orbit(SIZE, None, (), views=3)


class Drawing:
    """In the place of the renderer, its OpenGL and the clock."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.clock = FakeClock()
        self.clock.install(monkeypatch, cost.__name__)
        monkeypatch.setattr(cost, "SceneRenderer", lambda *_: self)
        self.drawn: list[Scene] = []
        self.released = 0
        self.elapsed = 0  # of the query, ns

    def query(self, time: bool) -> "Drawing":
        assert time
        return self

    def __enter__(self) -> None: ...

    def __exit__(self, *_: object) -> None: ...

    def ms(self, scene: Scene) -> float:
        return 10.0 * (1 + SCENES.index(scene))

    def render(self, scene: Scene) -> None:
        self.drawn.append(scene)

    def finish(self) -> None:
        self.clock.work(self.ms(self.drawn[-1]))

    def release(self) -> None:
        self.released += 1


@pytest.fixture
def drawing(monkeypatch: pytest.MonkeyPatch) -> Drawing:
    return Drawing(monkeypatch)


def test_percentiles_are_those_of_the_pictures_after_the_warm_up(drawing: Drawing, monkeypatch) -> None:
    """Of 100 pictures that take 1 to 100 ms until they are drawn, and a fourth of that on the graphics card."""

    def finish() -> None:
        number = len(drawing.drawn) - WARM_UP_FRAMES
        ms = 5000 if number <= 0 else number
        drawing.clock.work(ms)
        drawing.elapsed = ms * 250_000

    monkeypatch.setattr(drawing, "finish", finish)
    found = cost_of(drawing, FAST.render, SIZE, SCENES, 100)
    assert (found.p50, found.p99) == pytest.approx((50.5, 99.01))
    assert (found.gpu_p50, found.gpu_p99) == pytest.approx((50.5 / 4, 99.01 / 4))
    assert drawing.drawn == [SCENES[number % 3] for number in range(WARM_UP_FRAMES + 100)]
    assert drawing.released == 1


def test_a_camera_goes_round_the_marker_and_looks_down_at_what_stands_there() -> None:
    scenes = orbit((640, 480), None, (), views=4)
    aim = np.array([[0.0, 0.0, 0.03], [0.0, 0.0, 0.05]])
    for number, scene in enumerate(scenes):
        tracked = scene.tracked
        assert tracked is not None
        assert (tracked.frame.index, tracked.frame.time_s) == (number, number / 60)
        (x, y), (above_x, above_y) = project(tracked.camera, tracked.pose.T_cam_marker, aim)
        assert (x, y) == pytest.approx((319.5, 239.5))
        assert above_x == pytest.approx(x)
        assert above_y < y
        R, t = tracked.pose.T_cam_marker[:3, :3], tracked.pose.T_cam_marker[:3, 3]
        place = -R.T @ t - (0.0, 0.0, 0.03)
        turn, lift = np.pi / 2 * number, np.radians(40)
        assert place == pytest.approx(
            0.4 * np.array([np.cos(turn) * np.cos(lift), np.sin(turn) * np.cos(lift), np.sin(lift)])
        )


def test_the_vase_is_lit_as_its_surface_lies() -> None:
    (mesh,) = round_model(5000).model.parts
    corners = mesh.vertices[mesh.triangles]
    face = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    face /= np.linalg.norm(face, axis=1, keepdims=True)
    lit = mesh.normals[mesh.triangles]
    np.testing.assert_allclose(np.linalg.norm(lit, axis=-1), 1, atol=1e-5)
    assert (lit @ face[:, :, None]).min() > 0.98
    assert (face[:, :2] * corners.mean(axis=1)[:, :2]).sum(axis=1).min() > 0


def test_without_a_timer_the_graphics_card_has_no_time(drawing: Drawing) -> None:
    found = cost_of(drawing, FAST.render, SIZE, SCENES[:1], 4)
    assert found == replace(found, p50=pytest.approx(10), p99=pytest.approx(10), gpu_p50=None, gpu_p99=None)


def test_scenes_take_turns_and_each_list_has_its_own_times(drawing: Drawing) -> None:
    first, second, third = SCENES
    found = costs_by_turns(drawing, FAST.render, SIZE, [[first], [second, third]], 5)
    # In an odd number of pictures, of which the first three do not count, one of the second list's is shown oftener.
    assert found == [pytest.approx((10.0, 5.0)), pytest.approx((30.0, 15.0))]
    assert drawing.drawn == [first, second, first, third] * ((WARM_UP_FRAMES + 5) // 2)
    assert drawing.released == 2


def test_memory_is_looked_at_after_a_fifth_and_at_the_end_while_the_models_change(
    drawing: Drawing, monkeypatch
) -> None:
    monkeypatch.setattr(cost, "live_gl_objects", lambda: len(drawing.drawn))
    monkeypatch.setattr(cost, "resident_mib", lambda: 10 * len(drawing.drawn))
    monkeypatch.setattr(drawing, "ms", lambda _: 0.0)
    models = [SimpleNamespace(name=name) for name in "ab"]
    found = memory_growth(drawing, FAST.render, models, lambda number: SCENES[number % 3], 50)
    assert found == {"start_gl_objects": 11, "start_mib": 110, "end_gl_objects": 50, "end_mib": 500}
    assert "".join(scene.model.name for scene in drawing.drawn) == "a" * 10 + "b" * 10 + "a" * 10 + "b" * 10 + "a" * 10
    assert drawing.released == 1
