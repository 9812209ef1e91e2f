"""What a single view of a marker tells of the focal length, by how much its far side is shorter than its near one."""

import math
from collections.abc import Sequence

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.camera import Camera
from ashe_live.tracking.edges.corner_errors import FITTED
from ashe_live.tracking.focal.focal import CAUTION, FocalEstimate
from ashe_live.tracking.poses.pose import Corners, Sighting, pose_of_squares

# Logarithms of the focal lengths tried, over the assumed one, and how many standard deviations from their mean then.
TRIED = np.linspace(-0.9, 0.9, 19)
AGAIN_WITHIN = 3.0


def focal_of_view(sightings: Sequence[Sighting], assumed: Camera, side_m: float) -> FocalEstimate | None:
    """The mean and standard deviation of the focal length, given the view and what was assumed before.

    The posterior of its logarithm on a grid: a normal prior by the assumed camera's own standard deviation, and the
    likelihood of the corners under the best pose for each focal length. None where no focal length explains them.

    Of a square's two poses the one counts that the assumed camera has: with another focal length curled paper passes
    for the perspective of the other one, and a wrong pair of both explains the corners better than the right one.
    """
    pose = pose_of_squares(sightings, assumed, side_m)
    if pose is None:
        return None
    R, t = pose.T_cam_marker[:3, :3], pose.T_cam_marker[:3, 3]
    seen = Corners.of(sightings)
    focal_px, sigma = float(assumed.K[0, 0]), assumed.focal_sigma_px / float(assumed.K[0, 0])

    def cost(log_ratio: float) -> float:
        ratio = math.exp(log_ratio)
        K = Camera.from_focal(assumed.size, focal_px * ratio, "assumed").K
        start = seen.solution(R, t * (1, 1, ratio), K)
        return math.inf if start is None else seen.refined(start, K).cost

    freedom = max(0, 2 * sum(one.square.sides_seen for one in sightings) - 7)

    def posterior(tried: Float) -> tuple[float, float] | None:
        """Mean and standard deviation of the logarithm on an even grid."""
        costs = np.array([cost(float(one)) for one in tried])
        least = float(costs.min())
        if not math.isfinite(least):
            return None
        understated = (FITTED.weight + least) / (FITTED.weight + freedom)
        weights = np.exp(-0.5 * ((costs - least) / understated + (tried / sigma) ** 2))
        weights /= weights.sum()
        mean = float(weights @ tried)
        # Focal lengths between two of the grid's cannot be told apart.
        step = float(tried[1] - tried[0])
        return mean, math.hypot(math.sqrt(float(weights @ (tried - mean) ** 2)), step / math.sqrt(12))

    found = posterior(TRIED)
    if found is not None:
        mean, spread = found
        again = AGAIN_WITHIN * spread
        found = posterior(np.linspace(max(mean - again, TRIED[0]), min(mean + again, TRIED[-1]), len(TRIED)))
    if found is None:
        return None
    mean, spread = found
    found_px = focal_px * math.exp(mean)
    return FocalEstimate(assumed.size, found_px, CAUTION * spread * found_px, 1)
