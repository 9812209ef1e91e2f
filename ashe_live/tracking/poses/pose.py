"""The marker's pose from its four corners: both solutions of IPPE, the choice between them, and the covariance.

Collins and Bartoli, "Infinitesimal plane-based pose estimation", IJCV 2014.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from ashe_live.core.arrays import Float, cross_3d
from ashe_live.core.camera import Camera
from ashe_live.core.square import mean_side_px, side_lengths_px, square_corners
from ashe_live.core.transforms import project, rigid
from ashe_live.core.types import MarkerPose
from ashe_live.tracking.edges.corner_errors import FITTED, CornerErrors, systematic
from ashe_live.tracking.edges.lens import ideal_from_source, source_from_ideal
from ashe_live.tracking.edges.squares import FittedSquare, is_front_of_square
from ashe_live.tracking.poses.pose_choice import in_order, is_from_below, longest_focal, turn_from
from ashe_live.tracking.poses.pose_refinement import Correspondences, PoseCovariances, PoseSolution

# Noise may raise the error of the right one of two poses by NOISE_SIGMAS standard deviations of a corner, and at least
# by MIN_NOISE_PX.
NOISE_SIGMAS, MIN_NOISE_PX = 1.4, 0.1
# The largest error of a right pose: in pixels, or as a fraction of the square's side, for curled paper.
MOST_RMS_PX, MOST_RMS = 2.0, 0.04
# Rotations to the frame that IPPE is asked for (y down, z away) from the print's, turned by n quarters from x to y.
R_ASKED_TURNED = [
    np.diag((1.0, -1.0, -1.0))
    @ np.linalg.matrix_power(np.array([(0.0, -1.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)]), n)
    for n in range(4)
]
# Standard deviation of corners of unknown origin.
CORNER_SIGMA_PX = 0.5


@dataclass(frozen=True, slots=True)
class Sighting:
    """A square in the picture, and its corners in the frame whose pose is estimated."""

    points: Float  # (4, 3) metres: top-left, top-right, bottom-right, bottom-left
    square: FittedSquare


@dataclass(frozen=True, slots=True)
class Tolerance:
    """By how much the corners of a right pose may be off."""

    errors: CornerErrors = FITTED  # systematic errors of corners, in addition to noise
    most_rms: float = MOST_RMS  # largest error accepted, as a fraction of the largest square's side


OF_FLAT_PRINT = Tolerance()


@dataclass(frozen=True, slots=True, eq=False)
class Corners(Correspondences):
    """All corners of n squares that lie in one frame."""

    sightings: Sequence[Sighting]
    noise: Float  # (8 n, 8 n) as by `corners_noise`
    largest: Sighting

    @staticmethod
    def of(sightings: Sequence[Sighting], errors: CornerErrors = FITTED) -> "Corners":
        """`errors`: their systematic errors, in addition to noise."""
        points = np.concatenate([one.points for one in sightings])
        pixels = np.concatenate([one.square.corners_px for one in sightings])
        noise = corners_noise(sightings)
        information = corners_information(sightings, noise, errors)
        largest = max(sightings, key=lambda one: float(side_lengths_px(one.square.corners_px).sum()))
        return Corners(points, pixels, information, sightings, noise, largest)


def estimate_pose(
    corners_px: Float, camera: Camera, side_m: float, previous: MarkerPose | None = None, refines: bool = True
) -> MarkerPose | None:
    """The pose of a square whose corners are at `corners_px` (4, 2), source pixels; None if no pose explains them.

    A square seen nearly frontally, or from far away, has two poses that explain it about equally well. `previous` then
    decides; without it, the pose that shows the surface from above is taken, as by a camera held upright over a table.
    """
    if not is_front_of_square(corners_px):
        return None
    square = FittedSquare.guessed(ideal_from_source(camera, corners_px), CORNER_SIGMA_PX)
    return pose_of_squares([Sighting(square_corners(side_m), square)], camera, side_m, previous, refines)


def pose_of_squares(
    sightings: Sequence[Sighting],
    camera: Camera,
    side_m: float,
    previous: MarkerPose | None = None,
    refines: bool = True,
    tolerance: Tolerance = OF_FLAT_PRINT,
) -> MarkerPose | None:
    """The pose of the frame in which all `sightings` lie; see `estimate_pose`. Corners are weighted by covariance."""
    sightings = [one for one in sightings if is_front_of_square(one.square.corners_px)]
    if not sightings:
        return None
    errors = tolerance.errors
    seen = Corners.of(sightings, errors)
    chosen = _chosen_solution(seen, camera, previous, refines)
    if chosen is None:
        return None
    solution, other_rms_px = chosen
    T_cam_marker = rigid(solution.R, solution.t)
    # With a wrong focal length the right print fits badly as well, so that only known cameras are checked.
    if camera.source in ("file", "flag") and not _is_explained(seen.largest, T_cam_marker, camera, tolerance):
        return None
    own = square_corners(side_m)
    is_whole = len(sightings) == 1 and seen.largest.square.sides_seen == 4 and np.array_equal(seen.points, own)
    corners_px = seen.pixels if is_whole else project(camera, T_cam_marker, own)
    if not np.isfinite(corners_px).all():
        return None
    covariances = seen.covariances(solution, camera.K, seen.noise)
    return MarkerPose(
        T_cam_marker=T_cam_marker,
        corners_px=source_from_ideal(camera, corners_px),
        side_m=side_m,
        reprojection_rms_px=solution.rms_px,
        other_rms_px=other_rms_px,
        covariance=_whole_covariance(covariances, solution.cost, sightings, errors, camera),
        noise_covariance=covariances.noise,
    )


def _is_explained(largest: Sighting, T_cam_marker: Float, camera: Camera, tolerance: Tolerance) -> bool:
    """Whether a pose explains the largest square: squares seen nearly edge-on may be far off, and state this."""
    seen_px = largest.square.corners_px
    off_px = _rms_px(project(camera, T_cam_marker, largest.points) - seen_px)
    return off_px <= max(MOST_RMS_PX, tolerance.most_rms * mean_side_px(seen_px))


def _whole_covariance(
    covariances: PoseCovariances, cost: float, sightings: Sequence[Sighting], errors: CornerErrors, camera: Camera
) -> Float:
    """(6, 6) by the noise of edges, their systematic errors and the focal length's.

    If the pose leaves more unexplained than was stated, by its `cost`, the systematic errors were understated.
    """
    freedom = max(0, 2 * sum(one.square.sides_seen for one in sightings) - 6)
    understated = (errors.weight + cost) / (errors.weight + freedom)
    log_focal_sigma = camera.focal_sigma_px / float(camera.K[0, 0])
    return np.asarray(
        covariances.noise
        + understated * (covariances.whole - covariances.noise)
        + log_focal_sigma**2 * covariances.by_log_focal
    )


def _chosen_solution(
    seen: Corners, camera: Camera, previous: MarkerPose | None, refines: bool
) -> tuple[PoseSolution, float | None] | None:
    """The chosen solution, and the error (px) of the other one, if there is one; None if there is no solution."""
    if previous is not None:
        followed = seen.followed(previous.measured_T_cam_marker, camera.K)
        if followed is not None:
            return followed, None
    refines = refines or len(seen.sightings) > 1

    def solutions_by(K: Float) -> list[PoseSolution]:
        starts = (seen.solution(R, t, K) for R, t in _ippe(seen.largest, K))
        solutions = [one for one in starts if one is not None]
        # With a previous pose the choice is safe before refinement, which takes most of the time.
        if refines and previous is None:
            solutions = [seen.refined(one, K) for one in solutions]
        return solutions

    solutions = solutions_by(camera.K)
    if not solutions:
        return None
    prior = is_from_below if previous is None else turn_from(previous.measured_T_cam_marker)
    unexplained_px = _unexplained_px(seen.sightings, seen.information)
    chosen, *others = in_order(solutions, prior, unexplained_px, lambda: solutions_by(longest_focal(camera)))
    if refines and previous is not None:
        chosen = seen.refined(chosen, camera.K)
    return chosen, others[0].rms_px if others else None


def poses_of_square(sighting: Sighting, camera: Camera) -> list[Float]:
    """The one or two poses (4, 4) that explain a single square, the smaller error first."""
    return [rigid(R, t) for R, t in _ippe(sighting, camera.K)]


def corners_noise(sightings: Sequence[Sighting]) -> Float:
    """(8n, 8n) covariance of all corners' coordinates in turn, px^2, by the noise of their edges."""
    return _inverses([one.square.information for one in sightings])


def corners_information(sightings: Sequence[Sighting], noise: Float, errors: CornerErrors = FITTED) -> Float:
    """(8n, 8n) inverse covariance of all corners' coordinates in turn, 1 / px^2, including the systematic `errors`.

    `noise`: (8n, 8n) as from `corners_noise`.
    """
    blocks = (slice(8 * number, 8 * number + 8) for number in range(len(sightings)))
    squares = zip(blocks, sightings, strict=True)
    return _inverses([noise[block, block] + systematic(one.square, errors) for block, one in squares])


def _inverses(matrices: Sequence[Float]) -> Float:
    """(8n, 8n) with the inverses of n matrices (8, 8) along its diagonal: one call inverts all in the time of one."""
    whole = np.zeros((8 * len(matrices), 8 * len(matrices)))
    for number, inverse in enumerate(np.linalg.inv(np.array(matrices))):
        whole[8 * number : 8 * number + 8, 8 * number : 8 * number + 8] = inverse
    return whole


def _ippe(sighting: Sighting, K: Float) -> list[tuple[Float, Float]]:
    """At most two rotations (3, 3) and translations (3,) of the sighting's frame, not necessarily in front."""
    # OpenCV's IPPE returns nonsense for a half turn, as of a print seen upside down or exactly from above. So it is
    # asked for a frame that lies near the camera's: from the corner that is upper left in the picture, y down, z away.
    corners_px = sighting.square.corners_px
    quarters = int(np.argmin(corners_px.sum(axis=1)))
    lower_left_first = np.roll(corners_px, -quarters, axis=0)[::-1].copy()
    centre = sighting.points.mean(axis=0)
    x, y = sighting.points[1] - sighting.points[0], sighting.points[0] - sighting.points[3]
    side_m = float(np.linalg.norm(x))
    R_square_whole = np.array([x, y, cross_3d(x, y) / side_m]) / side_m
    R_asked_whole = R_ASKED_TURNED[quarters] @ R_square_whole
    _, rvecs, tvecs, _ = cv2.solvePnPGeneric(
        square_corners(side_m), lower_left_first, K, None, flags=cv2.SOLVEPNP_IPPE_SQUARE
    )
    rotations = [cv2.Rodrigues(rvec)[0] @ R_asked_whole for rvec in rvecs]
    return [(R, tvec.reshape(3) - R @ centre) for R, tvec in zip(rotations, tvecs, strict=True)]


def _rms_px(offsets_px: Float) -> float:
    """RMS length of offsets (n, 2)."""
    return math.sqrt(float((offsets_px**2).sum()) / len(offsets_px))


def _unexplained_px(sightings: Sequence[Sighting], information: Float) -> float:
    """How much noise or curled paper may add to the right solution's error, pixels."""
    noise_px = max(MIN_NOISE_PX, NOISE_SIGMAS * math.sqrt(len(information) / float(np.trace(information))))
    curls_px = (one.square.curl * mean_side_px(one.square.corners_px) for one in sightings)
    return max(noise_px, *curls_px)
