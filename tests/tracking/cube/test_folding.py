"""A cube folded by hand: what its faces show of each other is learned, and what they share stays uncertain."""

import math
from dataclasses import replace

import cv2
import numpy as np
import pytest

from ashe_live.core.arrays import Float
from ashe_live.core.transforms import pixels_by_points, project, transform_points
from ashe_live.core.types import MarkerPose
from ashe_live.quality import BALANCED
from ashe_live.tracking.cube import folding as folding_module
from ashe_live.tracking.cube.faces import CORNERS, FACES, TAG_SHARE
from ashe_live.tracking.cube.folding import EVERY, FIRST_FRAMES, OF_FOLDED_CUBE, SHIFT_SIGMA, TURN_SIGMA, Folding
from ashe_live.tracking.edges.squares import FittedSquare
from ashe_live.tracking.families.layout import cube_layout
from ashe_live.tracking.poses.pose import Sighting, pose_of_squares
from ashe_live.tracking.tracker import MarkerTracker
from tests.painted_cubes import CAMERA, EDGE_M, CubeScene, Folds, frame_of, looking, sun


def seen(T: Float, folds: Folds, folding: Folding, numbers: list[int]) -> dict[int, Sighting]:
    """Exact corners of some faces, and where the cube's shape as it is known has them."""
    return {
        number: Sighting(
            folding.corners(number),
            FittedSquare.guessed(
                project(CAMERA, T, EDGE_M * folds.placed(number, FACES[number].corners(TAG_SHARE))), 0.05
            ),
        )
        for number in numbers
    }


def test_a_perfect_cube_stays_one() -> None:
    folding = Folding(EDGE_M)
    T = looking(0.35, 50, 40)
    assert folding.add(seen(T, Folds(), folding, [0, 1, 2]), T, CAMERA)
    for number, face in enumerate(FACES):
        assert folding.corners(number) == pytest.approx(EDGE_M * face.corners(TAG_SHARE), abs=1e-6)
    # Faces that agree make one surer of the cube than careful folding alone.
    assert np.trace(folding.pose_covariance) < 0.2 * np.trace(Folding(EDGE_M).pose_covariance)


def test_after_the_first_frames_one_in_eight_is_learned_from_until_there_are_enough(monkeypatch) -> None:
    """Frames that look alike have the same errors."""
    monkeypatch.setattr(folding_module, "MOST_FRAMES", FIRST_FRAMES + 2)
    folding, T = Folding(EDGE_M), looking(0.35, 50, 40)
    squares = seen(T, Folds(), folding, [0, 1, 2])
    learned = np.flatnonzero([folding.add(squares, T, CAMERA) for _ in range(FIRST_FRAMES + 4 * EVERY)])
    assert list(learned[:FIRST_FRAMES]) == list(range(FIRST_FRAMES))
    assert len(learned) == FIRST_FRAMES + 2
    assert np.diff(learned[FIRST_FRAMES:]) == EVERY
    assert learned[FIRST_FRAMES] < FIRST_FRAMES + EVERY
    # Whichever faces are seen later, the pose is as uncertain as their folds leave it.
    of_three = folding.pose_covariance
    assert not folding.add(seen(T, Folds(), folding, [3]), T, CAMERA)
    assert np.trace(folding.pose_covariance) > 1.5 * np.trace(of_three)


def test_the_body_is_the_hull_of_the_faces_as_they_lie_on_the_table() -> None:
    assert np.unique(Folding(EDGE_M).body.points_marker().round(9), axis=0) == pytest.approx(
        np.unique((EDGE_M * CORNERS).round(9), axis=0)
    )
    folds, folding = Folds.drawn(np.random.default_rng(4), EDGE_M), Folding(EDGE_M)
    folding._folds = np.concatenate([folds.turns, EDGE_M * folds.shifts], axis=1)
    folding._shape()
    lying = np.concatenate([EDGE_M * folds.placed(number, face.corners()) for number, face in enumerate(FACES)])
    assert lying[:, 2].min() < 0, "by its folds alone it would reach into the table"
    assert folding.body.points_marker() == pytest.approx(np.maximum(lying, (-np.inf, -np.inf, 0.0)))
    pose = MarkerPose(looking(0.35, 50, 40), np.zeros((4, 2)), EDGE_M, 0.1, None)
    for covariance in (None, 1e-6 * np.eye(6)):
        assert folding.stated(replace(pose, covariance=covariance)).body is folding.body


def test_one_face_alone_has_no_information_on_the_folds() -> None:
    folding = Folding(EDGE_M)
    T = looking(0.35, 50, 40)
    assert not folding.add(seen(T, Folds.drawn(np.random.default_rng(1), EDGE_M), folding, [0]), T, CAMERA)


def test_two_faces_are_learned_but_for_what_they_share() -> None:
    turned = np.zeros((5, 3))
    turned[2] = 0.0, 0.0, 0.02  # the right face about the vertical
    folds, folding, T = Folds(turns=turned), Folding(EDGE_M), looking(0.35, 50, 0)
    for _ in range(3):
        folding.add(seen(T, folds, folding, [0, 2]), T, CAMERA)

    def across(number: int) -> Float:
        corners = folding.corners(number)
        return np.asarray((corners[1] - corners[0]) / np.linalg.norm(corners[1] - corners[0]))

    # The angle between both is what it is; whether one turned or the other, nothing says.
    between = math.acos(float(across(0) @ across(2)))
    assert between == pytest.approx(math.pi / 2 + 0.02, abs=2e-3)


def sightings_of(folding: Folding, squares: dict[int, FittedSquare]) -> dict[int, Sighting]:
    return {number: Sighting(folding.corners(number), square) for number, square in squares.items()}


def pose_of(folding: Folding, squares: dict[int, FittedSquare]) -> MarkerPose:
    sightings = list(sightings_of(folding, squares).values())
    pose = pose_of_squares(sightings, CAMERA, EDGE_M, tolerance=OF_FOLDED_CUBE)
    assert pose is not None
    return pose


def frame_error(rng: np.random.Generator, folds: Folds, frames: int) -> float:
    """Squared error of the last frame's pose over its stated covariance, of a cube that is followed so long."""
    folding, corner_px = Folding(EDGE_M), 0.05
    for _ in range(frames):
        T = looking(0.35, rng.uniform(30, 65), rng.uniform(0, 360))
        eye = -T[:3, :3].T @ T[:3, 3]
        shown = [number for number, face in enumerate(FACES) if (eye - EDGE_M * face.centre) @ face.outwards > 0.1]
        squares = {}
        for number in shown:
            exact = project(CAMERA, T, EDGE_M * folds.placed(number, FACES[number].corners(TAG_SHARE)))
            squares[number] = FittedSquare.guessed(exact + rng.normal(0, corner_px, (4, 2)), corner_px)
        pose = pose_of(folding, squares)
        folding.add(sightings_of(folding, squares), pose.T_cam_marker, CAMERA)
        pose = pose_of(folding, squares)
    stated = folding.stated(pose)
    turn = cv2.Rodrigues(T[:3, :3] @ stated.T_cam_marker[:3, :3].T)[0].ravel()
    error = np.append(turn, T[:3, 3] - stated.T_cam_marker[:3, 3])
    return float(error @ np.linalg.solve(stated.covariance, error))


@pytest.mark.parametrize("frames", [1, 4])
@pytest.mark.parametrize("careful", [0.4, 1.0])
def test_frames_of_crooked_cubes_lie_in_their_ellipsoids(frames: int, careful: float) -> None:
    """However crooked cubes are: how much is told by how their own faces disagree."""
    rng = np.random.default_rng(round(10 * careful) + frames)
    squares = [
        frame_error(rng, Folds.drawn(rng, EDGE_M, careful * 1e-3, careful * 1.5), frames) for _ in range(120 // frames)
    ]
    # Of six degrees of freedom.
    assert math.sqrt(np.mean(squares) / 6) == pytest.approx(1.0, abs=0.2)
    assert 0.86 <= np.mean(np.array(squares) < 12.59) <= 1.0


def test_the_most_crooked_of_cubes_are_found() -> None:
    """Every fold as large as it may be: before they are learned, faces lie millimetres off."""
    for number in range(12):
        rng = np.random.default_rng(number)
        signs = rng.choice((-1.0, 1.0), (2, 5, 3))
        folds = Folds(np.radians(1.5) * signs[0], 1e-3 / EDGE_M * signs[1])
        T = looking(0.3, rng.uniform(35, 60), rng.uniform(0, 360))
        tracker = MarkerTracker(cube_layout(), CAMERA, EDGE_M, BALANCED.tracking)
        pose = tracker.track(frame_of(CubeScene(CAMERA, T, [sun(200, 40)], folds=folds))).marker
        assert pose is not None
        assert math.acos(min(1.0, 0.5 * (np.trace(T[:3, :3] @ pose.T_cam_marker[:3, :3].T) - 1))) < np.radians(4)


def test_a_face_that_is_seen_alone_leaves_the_cubes_place_to_its_own_fold() -> None:
    folding, T = Folding(EDGE_M), looking(0.35, 50, 40)
    # Before any is seen, it is as uncertain as one face about its own middle.
    assert folding.pose_covariance == pytest.approx(np.diag([TURN_SIGMA**2] * 3 + [(SHIFT_SIGMA * EDGE_M) ** 2] * 3))
    folding.add(seen(T, Folds(), folding, [0]), T, CAMERA)
    of_one = folding.pose_covariance
    # A turn of the top about its middle moves the cube's middle, half an edge below it.
    assert of_one[3, 3] == pytest.approx((SHIFT_SIGMA**2 + (0.5 * TURN_SIGMA) ** 2) * EDGE_M**2, rel=0.05)
    assert of_one[5, 5] == pytest.approx((SHIFT_SIGMA * EDGE_M) ** 2, rel=0.05)
    assert of_one[0, 0] == pytest.approx(TURN_SIGMA**2, rel=0.05)


def test_the_frame_of_a_crooked_cube_errs_at_most_half_again_as_much_as_it_says() -> None:
    rng = np.random.default_rng(5)
    squares = []
    for _ in range(6):
        T = looking(0.35, rng.uniform(35, 65), rng.uniform(0, 360))
        tracker = MarkerTracker(cube_layout(), CAMERA, EDGE_M, BALANCED.tracking)
        pose = tracker.track(frame_of(CubeScene(CAMERA, T, [sun(200, 40)], folds=Folds.drawn(rng, EDGE_M)))).marker
        assert pose is not None
        assert pose.covariance is not None
        away = T[:3, :3] @ pose.T_cam_marker[:3, :3].T
        turn = 0.5 * np.array((away[2, 1] - away[1, 2], away[0, 2] - away[2, 0], away[1, 0] - away[0, 1]))
        squares.append(float(turn @ np.linalg.solve(pose.covariance[:3, :3], turn)))
    # Squared errors over their covariance have the mean 3, as they are of three angles.
    assert np.mean(squares) / 3 < 1.5**2


def test_frame_and_faces_are_off_together_as_the_picture_lets_them() -> None:
    """What moves a face in view turns the frame the other way, so that its print stays where it was seen."""
    folding, T, numbers = Folding(EDGE_M), looking(0.35, 50, 40), [0, 1, 2]
    squares = seen(T, Folds.drawn(np.random.default_rng(2), EDGE_M), folding, numbers)
    folding.add(squares, T, CAMERA)
    errors = folding.stated(pose_of(folding, {number: one.square for number, one in squares.items()})).pose_shape_errors
    assert errors is not None
    shown = np.concatenate([np.arange(4 * number, 4 * number + 4) for number in numbers])
    points = folding.body.points_marker()[shown]
    by_face = errors.points[shown].transpose(0, 2, 1)  # (points, causes, 3)
    by_frame = np.cross(errors.pose[:3].T, points[:, None]) + errors.pose[3:].T
    together = by_face + by_frame
    assert np.sqrt((by_frame**2).sum(axis=(1, 2))).max() > 3e-4
    # On the upper rim, as what stands on the table moves with the frame alone.
    above = points[:, 2] > EDGE_M / 2
    assert np.sqrt((together[above] ** 2).sum()) < 0.5 * np.sqrt((by_frame[above] ** 2).sum())
    # And the frame is as uncertain as folds make the pose, which is by the camera's axes.
    pose = pose_of(folding, {number: one.square for number, one in squares.items()})
    axes = np.kron(np.eye(2), pose.T_cam_marker[:3, :3])
    by_folds = folding.stated(pose).covariance - pose.covariance
    assert axes @ errors.pose @ errors.pose.T @ axes.T == pytest.approx(by_folds, rel=1e-6, abs=1e-12)


def test_the_bodys_corners_are_off_as_the_folds_that_move_them() -> None:
    """By the differences of its corners, but for the order of turns; of these, those below stay on the table."""
    folding, T = Folding(EDGE_M), looking(0.35, 50, 40)
    squares = seen(T, Folds.drawn(np.random.default_rng(2), EDGE_M), folding, list(range(len(FACES))))
    assert folding.add(squares, T, CAMERA)
    errors, points = folding.stated(MarkerPose(T, np.zeros((4, 2)), EDGE_M, 0.1, None)).pose_shape_errors, {}
    assert errors is not None
    causes, folds = np.linalg.cholesky(folding._covariance), folding._folds
    for cause in range(causes.shape[1]):
        for step in (-1e-4, 1e-4):
            folding._folds = folds + step * causes[:, cause].reshape(folds.shape)
            folding._shape()
            points[step] = folding.body.points_marker()
        moved = (points[1e-4] - points[-1e-4]) / 2e-4
        assert errors.points[:, :, cause] == pytest.approx(moved, abs=0.05 * np.abs(errors.points).max())
    on_table = points[1e-4][:, 2] == 0
    assert on_table.any()
    assert not errors.points[on_table, 2].any()


@pytest.mark.parametrize("component", range(6))
def test_corners_move_with_the_fold_of_a_face_that_is_folded_already(component: int) -> None:
    """By the differences of what is seen, for each component of the right face's fold."""
    folds, number, T = Folds.drawn(np.random.default_rng(4), EDGE_M), 2, looking(0.35, 50, 40)
    step, folding = 1e-6 * np.eye(6)[component], Folding(EDGE_M)
    folding._folds = np.concatenate([folds.turns, EDGE_M * folds.shifts], axis=1)

    def corners(step: Float) -> Float:
        turn = cv2.Rodrigues(step[:3])[0] @ cv2.Rodrigues(folds.turns[number])[0]
        face = FACES[number].corners(TAG_SHARE) - FACES[number].centre
        return np.asarray(EDGE_M * (face @ turn.T + FACES[number].centre + folds.shifts[number]) + step[3:])

    in_camera = transform_points(T, corners(np.zeros(6)))
    by_points = pixels_by_points(in_camera, CAMERA.K) @ T[:3, :3]
    found = folding._pixels_by_folds([number], corners(np.zeros(6)), by_points)[:, 6 * number + component]
    moved = (project(CAMERA, T, corners(step)) - project(CAMERA, T, corners(-step))).ravel() / (2 * step.sum())
    assert found == pytest.approx(moved, abs=1e-6 * np.abs(moved).max())
