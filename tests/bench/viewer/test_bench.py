"""The bench of the viewer's loop: that it runs and what it writes, never how fast it was."""

import json
import math
import subprocess
from itertools import pairwise

import cv2
import numpy as np
import pytest

from ashe_live.bench.viewer import starts
from ashe_live.bench.viewer.bench import ViewerBench
from ashe_live.bench.viewer.starts import ViewerStart
from ashe_live.capture.clips.known_clip import KnownClip, read_known_clip
from ashe_live.capture.recording.recorder import Recorder
from ashe_live.core.camera import Camera
from ashe_live.core.light import Illumination, LightEstimate
from ashe_live.core.square import square_corners
from ashe_live.core.transforms import project, rigid
from ashe_live.light.estimators.preset import ProxyPreset
from ashe_live.quality import FAST
from ashe_live.tracking.families.markers import parse_marker
from tests.bench.fake_clock import FakeClock

SIZE = (320, 240)
SPEC, SIDE_M = "aruco:4x4_50:0", 0.08
FRAMES = 8


class BlindEstimator:
    """Answers at once that it sees no light."""

    name = "blind"
    takes_ms = 1.0

    def __init__(self, _preset: ProxyPreset) -> None: ...

    def estimate(self, tracked, others=()):  # noqa: ARG002
        return LightEstimate(
            self.name, tracked.frame.index, Illumination(), "blind", timing_ms={"total": self.takes_ms}
        )


@pytest.fixture(scope="module")
def clip(tmp_path_factory):
    """The marker on white, seen obliquely, for half a second: from straight above no pose is certain."""
    path = tmp_path_factory.mktemp("clip") / "flat.mp4"
    camera = Camera.from_hfov(SIZE, 60)
    tilt = np.array([[1, 0, 0], [0, 0.8, -0.6], [0, 0.6, 0.8]])
    T_cam_marker = rigid(tilt @ np.diag([1.0, -1.0, -1.0]), (0, 0, 0.3))
    side_px = 200
    print_corners = np.array([(0, 0), (side_px, 0), (side_px, side_px), (0, side_px)]) - 0.5
    corners = project(camera, T_cam_marker, square_corners(SIDE_M))
    H = cv2.getPerspectiveTransform(print_corners.astype(np.float32), corners.astype(np.float32))
    print_bgr = cv2.cvtColor(parse_marker(SPEC).bitmap(side_px), cv2.COLOR_GRAY2BGR)
    picture = cv2.warpPerspective(print_bgr, H, SIZE, flags=cv2.INTER_AREA, borderValue=(255, 255, 255))
    with Recorder(path, SIZE, 24) as recorder:
        for index in range(12):
            recorder.write(picture, index / 24)
    return KnownClip(path, camera, SPEC, SIDE_M, np.array([0.6, 0.0, 0.8]))


def test_the_record_is_whole_and_adds_up(clip, tmp_path, capsys):
    out = tmp_path / "results.json"
    record = ViewerBench(clip, FAST, BlindEstimator, FRAMES, starts=1).run(tmp_path)
    assert json.loads(out.read_text()) == record
    assert record["schema"] == 1
    assert (record["quality"], record["size"], record["frames"]) == ("fast", list(SIZE), FRAMES)
    assert record["machine"]["cpus"] >= 1
    assert record["machine"]["gl_renderer"]

    start = record["first_picture"]["headless"]
    assert start["wall_s"] > 0
    assert start["cpu_s"] > 0

    stages = record["unpaced"]["stages_ms"]
    assert stages.keys() == {"decode", "track", "render", "whole", "blit"}
    assert all(stages["whole"]["p99"] >= stages[name]["p50"] > 0 for name in ("decode", "track", "render"))
    paced = record["paced"]
    for state in ("estimating", "sharpening"):
        assert set(paced[state]["estimates_ms"]) == {BlindEstimator.takes_ms}
        ratio = paced[state]["work_ms"]["p99"] / paced["idle"]["work_ms"]["p99"]
        assert math.isclose(paced[state]["p99_ratio"], ratio)
    for times in (
        *stages.values(),
        *(paced[state][kind] for state in ("idle", "estimating", "sharpening") for kind in ("work_ms", "interval_ms")),
    ):
        assert all(low <= high for low, high in pairwise((times["p50"], times["p95"], times["p99"])))
    assert 0 < record["key_views"]["mean_ms"] <= record["key_views"]["p99"]
    assert 0 < record["key_views"]["mib"] < 40
    assert f"{record['unpaced']['fps']:.0f} fps" in capsys.readouterr().out


def test_a_start_that_hangs_has_no_time_and_costs_no_other_figure(clip, monkeypatch):
    monkeypatch.setattr(starts, "LONGEST_START_S", 0.0)
    assert starts.time_start(clip, "fast", 1, "--headless") is None


def test_a_start_is_the_shortest_of_several_by_the_clock_and_by_the_processor(clip, monkeypatch):
    clock, taken_s = FakeClock(), iter((3.0, 2.0, 4.0))
    clock.install(monkeypatch, "ashe_live.bench.viewer.starts")
    monkeypatch.setattr(starts, "_childrens_cpu_s", clock.cpu_s)
    status = 0

    def run(command, **_):
        assert command[-1] == "--headless"
        clock.work(1e3 * next(taken_s))
        return subprocess.CompletedProcess(command, status)

    monkeypatch.setattr(starts.subprocess, "run", run)
    assert starts.time_start(clip, "fast", 3, "--headless") == ViewerStart(pytest.approx(2.0), pytest.approx(1.0))
    status, taken_s = 2, iter((1.0,))
    assert starts.time_start(clip, "fast", 1, "--headless") is None, "what failed was no start"


def test_the_truth_beside_a_clip_is_read_in_the_programs_terms(tmp_path):
    truth = {
        "size": [640, 480],
        "K": [[500, 0, 319.5], [0, 500, 239.5], [0, 0, 1]],
        "dist": [0, 0, 0, 0, 0],
        "marker": {"dictionary": "DICT_APRILTAG_36h11", "id": 16, "side_m": 0.05},
        "lights": [{"dir_to_light": [0.0, 0.6, 0.8]}],
    }
    (tmp_path / "orbit.json").write_text(json.dumps(truth))
    clip = read_known_clip(tmp_path / "orbit.json")
    assert clip.path == tmp_path / "orbit.mp4"
    assert parse_marker(clip.marker_spec).marker_id == 16
    assert (clip.camera.size, clip.marker_side_m) == ((640, 480), 0.05)
    assert clip.to_light_marker.tolist() == [0.0, 0.6, 0.8]
