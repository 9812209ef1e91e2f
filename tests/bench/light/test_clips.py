"""Clips under a light that does not move."""

import json
import math
from dataclasses import replace

import cv2
import numpy as np
import pytest

from ashe_live.bench.light.clips import estimate_clip, frames_of, read_clips
from ashe_live.capture.clips.known_clip import KnownClip
from ashe_live.capture.recording.recorder import Recorder
from ashe_live.core.camera import Camera
from ashe_live.core.light import Illumination, Light, LightEstimate
from ashe_live.core.transforms import direction_from_angles, rigid
from ashe_live.core.types import Frame, MarkerPose, TrackedFrame
from ashe_live.errors import UserError

SIZE = (64, 48)
CAMERA = Camera.from_hfov(SIZE, 60)
POSE = MarkerPose(rigid(np.diag((1.0, -1.0, -1.0)), (0, 0, 1)), np.zeros((4, 2)), 0.1, 0.0, None)


class Wavering:
    """Sees the light 2 degrees too high, then as much too low, then not at all, and so on."""

    name = "wavering"

    def estimate(self, tracked, others=()):  # noqa: ARG002
        if (turn := tracked.frame.index % 3) == 2:
            return LightEstimate(self.name, tracked.frame.index, Illumination(), "tired")
        light = direction_from_angles(0.4, 0.6 + math.radians((2, -2)[turn]))
        return LightEstimate(self.name, tracked.frame.index, Illumination((Light(light),)))


def frames(count, without_marker=()):
    picture = np.zeros((SIZE[1], SIZE[0], 3), np.uint8)
    return [
        TrackedFrame(Frame(picture, i, 0.1 * i), CAMERA, None if i in without_marker else POSE) for i in range(count)
    ]


@pytest.fixture
def clip(tmp_path):
    return KnownClip(tmp_path / "c.mp4", CAMERA, "aruco:4x4_50:0", 0.1, None)


def test_without_a_truth_the_spread_counts(clip):
    result = estimate_clip(Wavering(), "fast", clip, frames(7, without_marker=(3,)))
    assert (result.frames, result.without_marker, result.abstained) == (7, 1, 2)
    assert result.about == "mean"
    assert result.rms_deg == pytest.approx(2, abs=0.1)


def test_with_a_truth_the_bias_counts_too(clip):
    known = replace(clip, to_light_marker=direction_from_angles(0.4, 0.6 + math.radians(2)))
    result = estimate_clip(Wavering(), "fast", known, frames(2))
    assert result.about == "truth"
    assert result.rms_deg == pytest.approx(math.sqrt(8))
    assert result.max_deg == pytest.approx(4)


def test_one_answer_has_no_spread(clip):
    assert estimate_clip(Wavering(), "fast", clip, frames(1)).rms_deg is None


def test_clips_are_those_listed_and_those_described(tmp_path):
    listed = {"a.mp4": {"size": SIZE, "f_px": 60}, "b.mp4": {"size": SIZE, "f_px": 60, "to_light_marker": [0, 0, 2]}}
    marker = {"pattern_file": "p.patt", "side_units": 1.0}
    (tmp_path / "ground_truth.json").write_text(json.dumps({"marker": marker, "clips": listed}))
    described = {
        "size": SIZE,
        "K": CAMERA.K.tolist(),
        "dist": [0, 0, 0, 0, 0],
        "marker": {"dictionary": "DICT_4X4_50", "id": 3, "side_m": 0.05},
        "lights": [{"dir_to_light": [0, 0.6, 0.8]}],
    }
    (tmp_path / "c.json").write_text(json.dumps(described))
    (tmp_path / "c.mp4").touch()
    (tmp_path / "undescribed.mp4").touch()
    a, b, c = read_clips(tmp_path)
    assert a.to_light_marker is None
    assert a.marker_spec == f"pattern:{tmp_path / 'p.patt'}"
    assert b.to_light_marker.tolist() == [0, 0, 1]
    assert (c.path, c.marker_spec, c.marker_side_m) == (tmp_path / "c.mp4", "aruco:4x4_50:3", 0.05)
    (tmp_path / "c.json").write_text("{}")
    with pytest.raises(UserError, match="clip"):
        read_clips(tmp_path)


def test_every_tenth_frame_is_tracked(clip):
    with Recorder(clip.path, SIZE, 10) as recorder:
        for index in range(25):
            grey = np.full((SIZE[1], SIZE[0]), 10 * index, np.uint8)
            recorder.write(cv2.cvtColor(grey, cv2.COLOR_GRAY2BGR), index / 10)
    assert [tracked.frame.index for tracked in frames_of(clip)] == [0, 10, 20]
    assert [tracked.frame.index for tracked in frames_of(clip, limit=2)] == [0, 10]
