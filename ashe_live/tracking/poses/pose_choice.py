"""Which of the two poses that explain a square is meant."""

import math
from collections.abc import Callable
from operator import attrgetter

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.camera import Camera
from ashe_live.tracking.poses.pose_refinement import PoseSolution

# The smaller error alone decides only if the other is larger by this ratio, and by more than noise and curled paper
# explain. On a real clip, paper that curls by 2 % of its side gives the wrong pose an eighth of the right one's error.
DECISIVE_RATIO = 2.0
FOCAL_SIGMAS = 2.0  # of the logarithm of the focal length: how much longer than stated it may be

Unlikeliness = Callable[[PoseSolution], float]  # the less, the likelier is a pose before corners are looked at
ERROR_PX = attrgetter("rms_px")


def in_order(
    solutions: list[PoseSolution],
    unlikeliness: Unlikeliness,
    unexplained_px: float,
    by_longest_focal: Callable[[], list[PoseSolution]],
) -> list[PoseSolution]:
    """One or two solutions, the one that is meant first: the likelier, unless the other's error is decisively smaller.

    `unexplained_px`: what noise and curled paper may add to the right one's error. `by_longest_focal`: the solutions
    for the longest focal length that is possible, for which that must hold as well. Perspective grows as the focal
    length shrinks, and paper that curls against it looks like the perspective of the other pose.
    """
    by_error = sorted(solutions, key=ERROR_PX)
    if _rules_out_the_likelier(solutions, unlikeliness, unexplained_px) and _rules_out_the_likelier(
        by_longest_focal(), unlikeliness, unexplained_px
    ):
        return by_error
    return sorted(by_error, key=unlikeliness)


def _rules_out_the_likelier(solutions: list[PoseSolution], unlikeliness: Unlikeliness, unexplained_px: float) -> bool:
    """Whether the errors speak decisively for the solution that was not expected."""
    if len(solutions) < 2:
        return False
    smaller, larger = sorted(solutions, key=ERROR_PX)
    if larger.rms_px <= max(DECISIVE_RATIO * smaller.rms_px, math.hypot(smaller.rms_px, unexplained_px)):
        return False
    return unlikeliness(smaller) > unlikeliness(larger)


def longest_focal(camera: Camera) -> Float:
    """(3, 3) the intrinsics with the longest focal length that is possible, FOCAL_SIGMAS of its logarithm longer."""
    longer = math.exp(FOCAL_SIGMAS * camera.focal_sigma_px / float(camera.K[0, 0]))
    return np.asarray(camera.K * np.array([(longer, 1.0, 1.0), (1.0, longer, 1.0), (1.0, 1.0, 1.0)]))


def is_from_below(solution: PoseSolution) -> bool:
    """Whether the surface's normal points down in the picture, which it does not where a table is seen from above."""
    return bool(solution.R[1, 2] > 0)


def turn_from(T_previous: Float) -> Unlikeliness:
    """A measure that grows with the angle between a solution's rotation and the previous one."""
    return lambda solution: float(np.linalg.norm(solution.R - T_previous[:3, :3]))
