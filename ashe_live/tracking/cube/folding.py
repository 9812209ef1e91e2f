"""Learns how a paper cube's faces deviate from those of a perfect cube, from frames in which several faces are seen.

The deviation ("fold") of a face has six small components, three of a rotation and three of a translation, with a prior
of the accuracy of careful folding. Each frame is one step of an information filter: its pose is eliminated (by the
Schur complement), and its information about the folds is added. A deviation that all faces share cannot be
distinguished from a change of the pose, and so makes the pose uncertain (docs/maths, "Folds").
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import cv2
import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.camera import Camera
from ashe_live.core.proxy import PoseShapeErrors, Proxy
from ashe_live.core.transforms import pixels_by_points, pixels_by_pose
from ashe_live.core.types import MarkerPose
from ashe_live.tracking.cube.faces import FACES, TAG_SHARE
from ashe_live.tracking.poses.pose import Sighting, Tolerance, corners_information, corners_noise

# Standard deviations of careful folding: of a face's turn about each axis, and of its shift over the edge length, which
# is 0.7 mm for 6 cm.
TURN_SIGMA, SHIFT_SIGMA = math.radians(0.9), 0.011
# Largest RMS residual of a face's corners in a pose of all faces while their folds are unknown, over the side of its
# tag: three standard deviations of its shift across the view and of its turn, on top of the residual of a flat print.
OF_FOLDED_CUBE = Tolerance(most_rms=0.08)
# Frames that look alike have the same errors of the corners. So each frame after the first has this weight, and after
# so many nothing more is learned.
LATER_WEIGHT, MOST_FRAMES = 0.2, 60
# Each of so many first frames is learned from, then one in EVERY.
FIRST_FRAMES, EVERY = 4, 8
EACH = 6  # components of a fold
# Some cubes are folded better than others: the standard deviations above are scaled by one of these, all equally likely
# beforehand. Principal axes with less information than LEAST_INFORMATION, in units of the prior, say nothing about it.
SCALES: Float = np.array([0.05, 0.1, 0.2, 0.35, 0.5, 0.7, 1.0, 1.4])
LEAST_INFORMATION = 0.05


class Folding:
    """The shape of one cube, kept as long as it is tracked; its `body` is the hull of all faces, on the table."""

    def __init__(self, edge_m: float) -> None:
        self._edge_m = edge_m
        prior = np.tile([TURN_SIGMA] * 3 + [SHIFT_SIGMA * edge_m] * 3, len(FACES)) ** -2.0
        self._prior: Float = prior
        self._information = np.zeros((len(prior), len(prior)))
        self._vector = np.zeros(len(prior))
        self._covariance: Float = np.diag(1 / prior)  # of the folds, by all that was seen
        self._frames = self._seen_in = 0
        self._numbers: tuple[int, ...] = ()  # of the faces whose pose `pose_covariance` is of
        # (6, 6) of the turn about and the shift of the cube's middle, rad and m, cube's axes, that folds may have. What
        # all faces share is the pose itself, as no picture tells them apart.
        self.pose_covariance: Float = np.diag(1 / prior[:EACH])
        self._pose_shape_errors: PoseShapeErrors | None = None
        self._folds = np.zeros((len(FACES), EACH))
        self._shape()

    def _shape(self) -> None:
        """What follows from the folds alone, which most frames do not change."""
        self._tags = [self._placed(number, TAG_SHARE) for number in range(len(FACES))]
        points = np.concatenate([self._placed(number, 1.0) for number in range(len(FACES))])
        points[:, 2] = np.maximum(points[:, 2], 0.0)
        self.body = Proxy("box", np.column_stack([points, np.zeros((len(points), 2))]))

    def corners(self, number: int) -> Float:
        """(4, 3) metres: the corners of the tag on face `number`, as it lies."""
        return self._tags[number]

    @property
    def wants_all(self) -> bool:
        """Whether the folds of all faces that are in view are yet to be learned."""
        return self._frames < FIRST_FRAMES

    def stated(self, pose: MarkerPose) -> MarkerPose:
        """`pose` with the cube's body, and as uncertain as the folds make it."""
        if pose.covariance is None:
            return replace(pose, body=self.body, pose_shape_errors=self._pose_shape_errors)
        by_middle = self._pose_by_middle(pose.T_cam_marker)
        by_folds = by_middle @ self.pose_covariance @ by_middle.T
        covariance = pose.covariance + 0.5 * (by_folds + by_folds.T)
        return replace(pose, body=self.body, pose_shape_errors=self._pose_shape_errors, covariance=covariance)

    def add(self, squares: Mapping[int, Sighting], T_cam_cube: Float, camera: Camera) -> bool:
        """Learns from a frame's faces by number, seen from `T_cam_cube`; returns whether the shape has changed."""
        self._seen_in += 1
        numbers = tuple(squares)
        is_due = self.wants_all or self._seen_in % EVERY == 0
        is_learned = len(squares) > 1 and self._frames < MOST_FRAMES and is_due
        if not is_learned and numbers == self._numbers:
            return False
        equations = self._normal_equations(squares, T_cam_cube, camera)
        if equations is None:
            return False
        normal, pull = equations
        # The pose is eliminated by its Schur complement: what is left is about the folds alone.
        of_folds = np.column_stack([normal[:EACH, EACH:], pull[:EACH]])
        pose_by = np.linalg.solve(normal[:EACH, :EACH] + 1e-12 * np.eye(EACH), of_folds)
        pose_by_folds = np.linalg.solve(self._pose_by_middle(T_cam_cube), pose_by[:, :-1])
        if not np.isfinite(pose_by).all():
            return False
        if is_learned:
            weight = LATER_WEIGHT if self._frames else 1.0
            self._information += weight * (normal[EACH:, EACH:] - normal[EACH:, :EACH] @ pose_by[:, :-1])
            self._vector += weight * (pull[EACH:] - normal[EACH:, :EACH] @ pose_by[:, -1])
            self._frames += 1
            self._covariance = self._posterior_covariance()
            self._folds = np.asarray(self._covariance @ self._vector).reshape(-1, EACH)
            self._shape()
        self._numbers = numbers
        self.pose_covariance = pose_by_folds @ self._covariance @ pose_by_folds.T
        self._pose_shape_errors = self._errors_of(np.asarray(pose_by_folds, dtype=np.float64))
        return is_learned

    def _normal_equations(
        self, squares: Mapping[int, Sighting], T_cam_cube: Float, camera: Camera
    ) -> tuple[Float, Float] | None:
        """(36, 36) and (36,) of the pose and then of all folds, by the faces of a frame; None for what is no view.

        The pose is an offset from `T_cam_cube`, the folds are from a perfect cube.
        """
        sightings = list(squares.values())
        information = corners_information(sightings, corners_noise(sightings))
        R, t = T_cam_cube[:3, :3], T_cam_cube[:3, 3]
        points = np.concatenate([self.corners(number) for number in squares])
        turned = points @ R.T
        in_camera = turned + t
        if not in_camera[:, 2].min() > 0:
            return None
        predicted = (in_camera / in_camera[:, 2:]) @ camera.K[:2].T
        off = (np.concatenate([one.square.corners_px for one in sightings]) - predicted).ravel()
        by_pose = pixels_by_pose(turned, in_camera, camera.K).reshape(-1, EACH)
        by_folds = self._pixels_by_folds(tuple(squares), points, pixels_by_points(in_camera, camera.K) @ R)
        off = off + by_folds @ self._folds.ravel()
        whole = np.concatenate([by_pose, by_folds], axis=1)
        weighted = whole.T @ information
        return weighted @ whole, weighted @ off

    def _errors_of(self, pose_by_folds: Float) -> PoseShapeErrors:
        """How the body and its frame may be off together, where the pose gives way to folds by `pose_by_folds` (6, 30).

        A face that is turned turns the frame the other way, as its picture is what it is.
        """
        causes = np.linalg.cholesky(self._covariance)
        at_origin = np.eye(EACH)
        at_origin[3:, :3] = _crosses(np.array([(0, 0, 0.5 * self._edge_m)]))[0]
        points = self.body.spheroids_marker[:, :3]
        moved = np.zeros((len(points), 3, self._folds.size))
        for number in range(len(FACES)):
            rows = slice(4 * number, 4 * number + 4)
            by_fold = self._by_fold(number, points[rows])
            by_fold[points[rows, 2] <= 0, 2] = 0.0  # it stands on the table, however deep its corner would be
            moved[rows, :, EACH * number : EACH * number + EACH] = by_fold
        return PoseShapeErrors(-at_origin @ pose_by_folds @ causes, moved @ causes)

    def _pixels_by_folds(self, numbers: Sequence[int], points: Float, by_points: Float) -> Float:
        """(8 n, 30) derivatives of the pixels of n faces' corners (4 n, 3) by all folds; by_points: by the corners."""
        by_folds = np.zeros((2 * len(points), self._folds.size))
        for row, number in enumerate(numbers):
            rows = slice(4 * row, 4 * row + 4)
            block = (by_points[rows] @ self._by_fold(number, points[rows])).reshape(8, EACH)
            by_folds[8 * row : 8 * row + 8, EACH * number : EACH * number + EACH] = block
        return by_folds

    def _by_fold(self, number: int, points: Float) -> Float:
        """(n, 3, 6) derivatives of points (n, 3) of face `number`, as it lies, by its own fold."""
        arms = points - self._edge_m * FACES[number].centre - self._folds[number, 3:]
        return np.concatenate([-_crosses(arms), np.tile(np.eye(3), (len(points), 1, 1))], axis=2)

    def _posterior_covariance(self) -> Float:
        """(30, 30) of the folds by all that was seen, over all scales that these may have.

        In units of the prior, along each principal axis of the information, what was measured is normal with the
        variance of the folds and of the measurement together, so that the faces' disagreement tells the scale; what all
        faces share has no information, and no say. Few disagree, so that the scale stays uncertain: to take its
        likeliest value would make the pose's standard deviations a tenth too small.
        """
        sigmas = self._prior**-0.5
        values, axes = np.linalg.eigh(sigmas[:, None] * self._information * sigmas)
        informed = values > LEAST_INFORMATION
        noise = 1 / values[informed]
        squares = (axes[:, informed].T @ (sigmas * self._vector) * noise) ** 2
        variance = SCALES[:, None] ** 2 + noise
        log_likelihood = -0.5 * (np.log(variance) + squares / variance).sum(axis=1)
        posterior = np.exp(log_likelihood - log_likelihood.max())
        by_scale = 1 / (np.maximum(values, 0.0) + 1 / SCALES[:, None] ** 2)
        spread = sigmas[:, None] * axes
        return np.asarray((spread * (posterior @ by_scale / posterior.sum())) @ spread.T)

    def _pose_by_middle(self, T_cam_cube: Float) -> Float:
        """(6, 6) a pose's turn about the frame's origin and its shift, camera's axes, by those of the cube's middle."""
        R = T_cam_cube[:3, :3]
        by_middle = np.zeros((EACH, EACH))
        by_middle[:3, :3] = by_middle[3:, 3:] = R
        by_middle[3:, :3] = _crosses((R @ (0, 0, 0.5 * self._edge_m))[None])[0] @ R
        return by_middle

    def _placed(self, number: int, side: float) -> Float:
        """(4, 3) metres: the corners of a square of `side` edges in the middle of face `number`, as it lies."""
        face, fold = FACES[number], self._folds[number]
        centre = self._edge_m * face.centre
        arms = self._edge_m * face.corners(side) - centre
        return np.asarray(arms @ cv2.Rodrigues(fold[:3])[0].T + centre + fold[3:])


def _crosses(vectors: Float) -> Float:
    """(n, 3, 3) matrices of the cross products with vectors (n, 3)."""
    x, y, z = vectors.T
    zero = np.zeros_like(x)
    return np.stack([zero, -z, y, z, zero, -x, -y, x, zero], axis=1).reshape(-1, 3, 3)
