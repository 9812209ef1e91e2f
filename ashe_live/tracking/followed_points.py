"""Points of a picture, followed into a later one, and the motions that where they are now agrees with."""

from dataclasses import dataclass

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Float32, Image, Mask

WINDOW, LEVELS = (13, 13), 3
MOST_ERROR = 12.0  # grey levels, mean absolute difference of a point's surroundings before and now
FEWEST_POINTS = 8  # that must agree, and their least share of all
LEAST_SHARE = 0.3
# Or as many as these, and their least shares of all and of those that are found: a hand may have hidden the others.
MANY_POINTS, SHARE_OF_ALL, SHARE_OF_FOUND = 16, 0.2, 0.45


@dataclass(frozen=True, slots=True, eq=False)
class FollowedPoints:
    """The n points in a later frame."""

    there_px: Float  # (n, 2)
    is_there: Mask  # (n,) which of them were found
    near_path: Mask  # (n,) where the camera's motion by the marker's two poses puts them, at one height or another
    stays: Mask  # (n,) in the same place of the picture, as behind a marker that moves before a camera that does not
    is_clear: Mask  # (n,) for which the two are different places

    def count(self, which: Mask) -> int:
        """How many of the points found are among `which` (n,)."""
        return int((which & self.is_there).sum())

    @property
    def least(self) -> float:
        """How many have to agree on a motion."""
        count = len(self.is_there)
        of_found = max(MANY_POINTS, SHARE_OF_ALL * count, SHARE_OF_FOUND * int(self.is_there.sum()))
        return min(max(FEWEST_POINTS, LEAST_SHARE * count), of_found)


def followed(before: Image, now: Image, points: Float32, starts: tuple[Float32, Float32]) -> tuple[Float, Mask]:
    """(n, 2) where points (n, 1, 2) are now, looked for from each of `starts`, and (n,) which of them are found."""
    criteria = (cv2.TERM_CRITERIA_EPS | cv2.TERM_CRITERIA_COUNT, 15, 0.03)
    found = [
        cv2.calcOpticalFlowPyrLK(
            before, now, points, start.copy(), winSize=WINDOW, maxLevel=LEVELS, criteria=criteria,
            flags=cv2.OPTFLOW_USE_INITIAL_FLOW,
        )
        for start in starts
    ]  # fmt: skip
    errors = np.stack([np.where(is_there > 0, error, np.inf)[:, 0] for _, is_there, error in found])
    likelier = errors.argmin(axis=0)
    at = np.arange(len(points))
    there = np.stack([there[:, 0] for there, _, _ in found])[likelier, at]
    return np.asarray(there, np.float64), np.asarray(errors[likelier, at] < MOST_ERROR)


def beside(points: Float, start: Float, end: Float) -> Float:
    """(n,) distances of points (n, 2) from the segments between `start` and `end`, (n, 2) each; infinity for NaN."""
    along, offset = end - start, points - start
    square = np.maximum(np.square(along).sum(axis=1), 1e-12)
    share = np.clip((offset * along).sum(axis=1) / square, 0.0, 1.0)
    distance = np.linalg.norm(offset - share[:, None] * along, axis=1)
    return np.where(np.isfinite(distance), distance, np.inf)
