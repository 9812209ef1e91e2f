"""The tracking bench: its pictures show what they claim, and its measures find what was put in."""

import dataclasses
import json
from pathlib import Path
from types import SimpleNamespace

import cv2
import numpy as np
import pytest

from ashe_live.bench.track import clips as track_clips
from ashe_live.bench.track import contenders, focal
from ashe_live.bench.track.clips import follow_clips, jitter_in_motion_px, largest_turn_deg
from ashe_live.bench.track.contenders import Answer, OpencvReference, Ours, answers, found_share
from ashe_live.bench.track.frames import Flaws, PrintedMarker
from ashe_live.bench.track.measures import (
    corner_jitter_px,
    flipped_share,
    lag_ms,
    lasting_flips,
    normalised_error_squared,
    rotation_errors_deg,
)
from ashe_live.bench.track.tables import Figure
from ashe_live.bench.track.takes import FPS, SIDE_M, SMALL, SPEC, pose_at, scattered, sliding
from ashe_live.capture.recording.recorder import Recorder
from ashe_live.core.arrays import Float
from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT
from ashe_live.core.square import square_corners
from ashe_live.core.transforms import project, rigid
from ashe_live.core.types import MarkerPose, TrackedFrame
from ashe_live.errors import UserError
from ashe_live.quality import BALANCED
from ashe_live.tracking.families.markers import parse_marker
from tests.bench.fake_clock import FakeClock

BLACK = np.zeros((1, 1), np.uint8)
PLAIN = Flaws(blur_px=0, noise=0, vignetting=0)


def square_of_light(flaws: Flaws, poses: list[Float]) -> Float:
    """(h, w) linear light of an all black square on white paper."""
    image = PrintedMarker(BLACK, SIDE_M, SMALL, flaws).painted(poses, np.random.default_rng(0), np.ones((480, 640)))
    return LINEAR_FROM_SRGB_8BIT[image[:, :, 0]]


@pytest.mark.parametrize("flaws", [PLAIN, dataclasses.replace(PLAIN, blur_px=2.0)])
def test_the_light_that_ink_takes_away_is_the_squares_area_at_its_place(flaws: Flaws) -> None:
    """Seen straight on, area and centre of gravity of a square are known; neither pixels nor blur may change them."""
    side_px = 77.3
    T = pose_at(SMALL.K[0, 0] * SIDE_M / side_px, 0, 27, (0.013, -0.021))
    light = square_of_light(flaws, [T])
    taken = np.where(light < 0.99, 0.72 - light, 0).clip(0)[40:440, 40:600]
    paper = light[100, 320]
    assert taken.sum() / (0.72 - 0.03) == pytest.approx(side_px**2, rel=0.01)
    y, x = np.mgrid[40:440, 40:600]
    centre = project(SMALL, T, np.zeros((1, 3)))[0]
    assert ((x * taken).sum() / taken.sum(), (y * taken).sum() / taken.sum()) == pytest.approx(tuple(centre), abs=0.05)
    assert paper > 0.5


def test_motion_blur_is_as_long_as_the_way() -> None:
    moving = scattered("m", 80, 1, blur_px=10).poses(0)
    ends = np.array([project(SMALL, T, np.zeros((1, 3)))[0] for T in (moving[0], moving[-1])])
    assert np.linalg.norm(ends[1] - ends[0]) == pytest.approx(10, rel=1e-6)


def test_the_sliding_marker_keeps_its_speed() -> None:
    take = sliding("s", 0.3, 60)
    places = np.array([take.poses(index)[0][0, 3] for index in range(60)])
    assert np.median(np.abs(np.diff(places)) * FPS) == pytest.approx(0.3, rel=0.02)


def answer(truth: Float, said: Float | None) -> Answer:
    return Answer(truth, said, 1.0, 1.0)


def test_a_delay_is_measured_as_one() -> None:
    take = sliding("s", 0.3, 90)
    truths = [take.poses(index)[0] for index in range(90)]
    late = [answer(truths[index], truths[index - 2]) for index in range(2, 90)]
    assert lag_ms(late) == pytest.approx(2000 / FPS, rel=0.1)
    assert lag_ms([answer(T, T) for T in truths]) == pytest.approx(0, abs=1e-9)
    missing = [answer(each.truth, each.T_cam_marker if index % 3 else None) for index, each in enumerate(late)]
    assert lag_ms(missing) == pytest.approx(2000 / FPS, rel=0.1)


def test_jitter_is_the_distance_from_the_mean() -> None:
    truth = pose_at(0.5, 0, 0)
    moved = [truth.copy() for _ in range(2)]
    moved[0][0, 3] += 0.5 / SMALL.K[0, 0] * 0.5
    moved[1][0, 3] -= 0.5 / SMALL.K[0, 0] * 0.5
    assert corner_jitter_px([answer(truth, T) for T in moved], SMALL) == pytest.approx(0.5, rel=1e-3)


def test_errors_drawn_from_the_covariance_of_the_noise_are_calibrated_whatever_the_filter_and_other_errors_are() -> (
    None
):
    rng, truth = np.random.default_rng(4), pose_at(0.5, 40, 70)
    mix = rng.normal(size=(6, 6)) * np.repeat((3e-3, 2e-4), 3)[:, None]
    noise = mix @ mix.T

    def drawn(stated: Float) -> Answer:
        turn, aside = np.split(rng.multivariate_normal(np.zeros(6), noise), 2)
        measured = rigid(cv2.Rodrigues(turn)[0] @ truth[:3, :3], truth[:3, 3] + aside)
        pose = MarkerPose(truth, np.zeros((4, 2)), SIDE_M, 0.0, None, 9 * noise, stated, measured)
        return Answer(truth, truth, 1.0, 1.0, pose)

    unstated = Answer(truth, truth, 1.0, 1.0, MarkerPose(truth, np.zeros((4, 2)), SIDE_M, 0.0, None))
    nothing = answer(truth, None)
    for scale in (1.0, 4.0):
        given = [*(drawn(noise / scale) for _ in range(2000)), unstated, nothing]
        assert normalised_error_squared(given) == pytest.approx(scale, rel=0.06)


def test_jitter_without_the_filter_is_that_of_the_poses_as_measured() -> None:
    truth = pose_at(0.5, 0, 0)
    given = []
    for aside_m in (-1e-3, 1e-3):
        measured = rigid(truth[:3, :3], truth[:3, 3] + (aside_m, 0, 0))
        pose = MarkerPose(truth, np.zeros((4, 2)), SIDE_M, 0.0, None, unfiltered_T_cam_marker=measured)
        given.append(Answer(truth, truth, 1.0, 1.0, pose))
    assert corner_jitter_px(given, SMALL) == pytest.approx(0, abs=1e-9)
    assert corner_jitter_px(given, SMALL, unfiltered=True) == pytest.approx(1e-3 * SMALL.K[0, 0] / 0.5)


def test_flips_last_or_do_not() -> None:
    truth, flipped = pose_at(0.5, 20, 0), pose_at(0.5, -20, 0)
    said = [*[truth] * 5, *[flipped] * 3, truth, *[flipped] * 4, truth]
    given = [answer(truth, T) for T in said]
    assert lasting_flips(given) == 1
    assert flipped_share(given) == pytest.approx(7 / 14)
    assert np.max(rotation_errors_deg(given)) == pytest.approx(40)
    assert [flipped_share([answer(truth, pose_at(0.5, 20 - off, 0))]) for off in (9, 11)] == [0, 1]
    assert flipped_share([answer(truth, None)]) == 0


def test_jitter_in_motion_sees_noise_and_no_motion() -> None:
    rng = np.random.default_rng(0)
    smooth = [pose_at(0.5, 30, 0.5 * index, (0.002 * index, 0.0)) for index in range(60)]
    shaken = [rigid(T[:3, :3], T[:3, 3] + 1e-4 * np.append(rng.normal(size=2), 0)) for T in smooth]
    assert jitter_in_motion_px(smooth, SMALL, SIDE_M) < 0.02
    assert 0.1 < jitter_in_motion_px(shaken, SMALL, SIDE_M) < 0.4
    assert jitter_in_motion_px([T if index % 3 else None for index, T in enumerate(shaken)], SMALL, SIDE_M) == 0


def test_what_turns_while_it_is_not_seen_has_not_turned_from_one_frame_to_the_next() -> None:
    tilts = [30, 31, None, 50, 52, None, None, 20]
    square = np.zeros((4, 2))
    markers = [None if tilt is None else MarkerPose(pose_at(0.5, tilt, 0), square, SIDE_M, 0.0, None) for tilt in tilts]
    assert largest_turn_deg(markers) == pytest.approx(2.0)


def test_both_contenders_see_the_same_frames() -> None:
    take = scattered("s", 90, 3)
    given = answers(take, {"OpenCV": OpencvReference(SMALL), "ours": Ours(SMALL, BALANCED.tracking, cold=True)})
    assert found_share(given["OpenCV"]) == found_share(given["ours"]) == 1
    assert [one.truth.tolist() for one in given["OpenCV"]] == [one.truth.tolist() for one in given["ours"]]
    assert max(rotation_errors_deg(given["ours"])) < 0.2


def test_what_a_contender_takes_is_timed_by_itself(monkeypatch) -> None:
    clock, take = FakeClock(), scattered("s", 90, 2)
    clock.install(monkeypatch, contenders.__name__)

    class Slow:
        def __init__(self, ms: float, found: Float | MarkerPose | None) -> None:
            self._ms, self._found = ms, found

        def look(self, _frame: object) -> Float | MarkerPose | None:
            clock.work(self._ms)
            return self._found

    pose = MarkerPose(pose_at(0.5, 0, 0), np.zeros((4, 2)), SIDE_M, 0.0, None)
    given = answers(take, {"matrix": Slow(10, pose_at(0.4, 0, 0)), "pose": Slow(30, pose), "none": Slow(50, None)})
    assert {name: [(one.ms, one.cpu_ms) for one in every] for name, every in given.items()} == {
        name: [pytest.approx((ms, ms / 2))] * 2 for name, ms in (("matrix", 10), ("pose", 30), ("none", 50))
    }
    assert [one.pose for every in given.values() for one in every] == [None, None, pose, pose, None, None]
    assert found_share([*given["pose"], *given["matrix"], *given["none"]]) == pytest.approx(4 / 6)


def test_a_cold_tracker_and_opencvs_refinement_are_what_they_are_called() -> None:
    take = sliding("s", 0.3, 4)
    given = answers(
        take,
        {
            "cold": Ours(SMALL, BALANCED.tracking, cold=True),
            "warm": Ours(SMALL, BALANCED.tracking),
            "refined": OpencvReference(SMALL),
            "unrefined": OpencvReference(SMALL, subpixel=False),
        },
    )
    for (frame, _), cold, warm in zip(take.film(), given["cold"], given["warm"], strict=True):
        anew = Ours(SMALL, BALANCED.tracking).look(frame)
        assert anew is not None
        np.testing.assert_array_equal(cold.T_cam_marker, anew.T_cam_marker)
        assert frame.index == 0 or (warm.T_cam_marker != anew.T_cam_marker).any()
    refined, unrefined = (np.median(rotation_errors_deg(given[name])) for name in ("refined", "unrefined"))
    assert refined < unrefined


def test_a_clips_figures_are_those_of_its_frames(tmp_path: Path, monkeypatch) -> None:
    """Of eight frames of a sliding marker, and two of nothing."""
    take = sliding("s", 0.3, 8)
    with Recorder(tmp_path / "a.mp4", SMALL.size, 30) as recorder:
        for frame, _ in take.film():
            recorder.write(frame.image_bgr, frame.index / 30)
        for index in (8, 9):
            recorder.write(np.full((480, 640, 3), 90, np.uint8), index / 30)
    marker = {"pattern_file": "p.patt", "side_units": SIDE_M}
    truth = {"marker": marker, "clips": {"a.mp4": {"f_px": float(SMALL.K[0, 0])}}}
    (tmp_path / "ground_truth.json").write_text(json.dumps(truth))
    named: list[str] = []
    monkeypatch.setattr(track_clips, "parse_marker", lambda spec: named.append(spec) or parse_marker(SPEC))
    (found,) = follow_clips(tmp_path, BALANCED.tracking)
    assert named == [f"pattern:{tmp_path / 'p.patt'}"]
    assert (found.name, found.frames) == ("a.mp4", 10)
    assert found.found_share == pytest.approx(0.8, abs=0.11)  # a frame or two may be bridged
    assert round(10 * found.found_share) == 8 + found.bridged
    assert 0 < found.largest_turn_deg < 1
    assert 0 < found.jitter_in_motion_px < 0.2
    assert 0 < found.unfiltered_jitter_in_motion_px < 0.2
    assert found.median_ms > 0


def test_a_focal_lengths_error_is_in_percent_and_in_its_own_sigmas(monkeypatch) -> None:
    class Estimator:
        def __init__(self, size: tuple[int, int]) -> None:
            assert size == SMALL.size
            self.added: list[TrackedFrame] = []

        def add(self, tracked: TrackedFrame) -> None:
            self.added.append(tracked)

        @property
        def estimate(self) -> SimpleNamespace | None:
            assert [tracked.frame.index for tracked in self.added] == [0, 1, 2]
            assert all(tracked.marker is not None for tracked in self.added)
            return said

    monkeypatch.setattr(focal, "FocalEstimator", Estimator)
    said: SimpleNamespace | None = SimpleNamespace(focal_px=0.98 * SMALL.K[0, 0], sigma_px=0.01 * SMALL.K[0, 0])
    percent, sigmas = focal.focal_figures(BALANCED.tracking, 3)
    assert (percent.ours, sigmas.ours) == pytest.approx((2.0, 2.0))
    assert (percent.unit, percent.is_met, sigmas.is_met) == ("%", True, True)
    said = None
    assert [(figure.ours, figure.is_met) for figure in focal.focal_figures(BALANCED.tracking, 3)] == [(None, False)] * 2


def test_a_figure_is_met_within_its_bounds() -> None:
    assert Figure("a", "", None, 1.0, None).is_met is None
    assert Figure("a", "", None, 1.0, 1.0).is_met
    assert not Figure("a", "", None, 1.1, 1.0).is_met
    assert Figure("a", "", 95.0, 95.0, None, least=95.0).is_met
    assert not Figure("a", "", None, None, 1.0).is_met


def test_a_folder_without_clips_is_refused(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="there is no file"):
        follow_clips(tmp_path, BALANCED.tracking)
    (tmp_path / "ground_truth.json").write_text(json.dumps({"photos": {}}))
    with pytest.raises(UserError, match="no list of clips"):
        follow_clips(tmp_path, BALANCED.tracking)


def test_corners_of_the_painted_square_lie_where_they_are_projected() -> None:
    T = pose_at(0.6, 35, 20)
    light = square_of_light(PLAIN, [T])
    corners = project(SMALL, T, square_corners(SIDE_M))
    mask = np.zeros(light.shape, np.uint8)
    cv2.fillConvexPoly(mask, np.round(corners).astype(np.int32), 1)
    inside = cv2.erode(mask, np.ones((5, 5))) > 0
    around = (cv2.dilate(mask, np.ones((11, 11))) > 0) & ~(cv2.dilate(mask, np.ones((5, 5))) > 0)
    assert light[inside].max() < 0.05
    assert light[around].min() > 0.6
