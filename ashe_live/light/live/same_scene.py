"""Decides whether two views show the same scene, by comparing their ground and shadows on the marker's plane.

Both views are drawn onto the plane, with ten cells to the marker's side, and brought to one exposure. Where they still
differ, there is either a thing above the plane, which shifts between the views by about its height times the
difference of their slopes, or something has changed: the light, an object, or the marker's place. Views from very
different directions cannot be compared.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Float32, Mask
from ashe_live.core.transforms import camera_centre, image_from_plane
from ashe_live.core.types import TrackedFrame
from ashe_live.light.pixels.log_colour import is_exposed, log_opponent
from ashe_live.light.pixels.view import View

CELLS_A_SIDE = 10  # on the plane, of the marker's side
HALF_SIDES = 5  # from the marker's centre to the border of what is compared, in the marker's sides
VIEW_WIDTH_PX = 160  # of the pictures that are compared: a cell is then about one or two pixels wide
# Least difference at one exposure: of log brightness, that of lit ground to a shadow which leaves three quarters; of
# log red over blue, and of red and blue over green, more than that of a shadow under a blue sky.
LEAST_DIFFERENCES = np.array([0.3, 0.6, 0.4], np.float32)
# Things up to this height, in the marker's sides, may stand there: what they shear by is not a change. Views between
# which they shear by more than the second number cannot be compared.
HIGHEST_SIDES = 3.0
MOST_SHEAR_SIDES = 0.8
MOST_NEARNESS = 0.4  # of such a thing: its height over the camera's
REGISTRATION_CELLS = 4  # misregistration by poses, the picture's scale and its blur
LEAST_AREA_SIDES = 0.2  # squared sides: the smallest change that is noticed
LEAST_COMPARED_SIDES = 2.0  # squared sides: the least common ground for a comparison


@dataclass(frozen=True, slots=True, eq=False)
class PlanePicture:
    """A view drawn onto the marker's plane."""

    colours: Float32  # (n, n, 3) log-opponent: brightness, and two of chroma
    is_seen: Mask  # (n, n) ground in the picture, neither the printed sheet nor saturated
    slope: Float  # (2,) towards the camera: metres along the plane for each metre of height
    height_sides: float  # of the camera above the plane, in the marker's sides

    @staticmethod
    def of(tracked: TrackedFrame) -> "PlanePicture":
        """The picture of a frame that must have a marker."""
        view = View.of(tracked, VIEW_WIDTH_PX)
        cells = 2 * HALF_SIDES * CELLS_A_SIDE
        image_from_cells = image_from_plane(view.camera, view.T_cam_marker) @ _plane_from_cells(view.side_m)

        def drawn(picture: Float32 | Mask) -> Float32:
            source = np.asarray(picture, np.float32)
            flags = cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP
            return np.asarray(cv2.warpPerspective(source, image_from_cells, (cells, cells), flags=flags), np.float32)

        is_usable = view.is_ground & is_exposed(view.image_bgr)
        camera = camera_centre(view.T_cam_marker)
        height_m = max(abs(float(camera[2])), 1e-9)
        is_seen, colours = drawn(is_usable) > 0.99, drawn(log_opponent(view.image_bgr))
        return PlanePicture(colours, is_seen, camera[:2] / height_m, height_m / view.side_m)


def differs(a: PlanePicture, b: PlanePicture) -> bool | None:
    """Whether the scene has changed between two views; None if they cannot be compared."""
    shear_sides = HIGHEST_SIDES * _aside(a, b)
    is_compared = a.is_seen & b.is_seen
    if shear_sides > MOST_SHEAR_SIDES or np.count_nonzero(is_compared) < LEAST_COMPARED_SIDES * CELLS_A_SIDE**2:
        return None
    difference = a.colours - b.colours
    difference -= np.median(difference[is_compared], axis=0)
    is_other = np.abs(difference) > LEAST_DIFFERENCES
    # Seen by a camera near by, high things shear more than their height says. As a changed light may show in shadows
    # that are as narrow, only colours pay for it.
    nearness = min(HIGHEST_SIDES / min(a.height_sides, b.height_sides), MOST_NEARNESS)
    by_brightness = _area_sides(is_other[..., 0] & is_compared, shear_sides)
    by_colours = _area_sides(is_other[..., 1:].any(axis=2) & is_compared, shear_sides / (1 - nearness))
    return bool(max(by_brightness, by_colours) > LEAST_AREA_SIDES)


def _area_sides(is_changed: Mask, shear_sides: float) -> float:
    """Squared sides of what has changed (n, n) beyond what a thing shears by."""
    width = REGISTRATION_CELLS + round(shear_sides * CELLS_A_SIDE)
    kernel = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (width, width))
    left = cv2.morphologyEx(is_changed.astype(np.uint8), cv2.MORPH_OPEN, kernel)
    return np.count_nonzero(left) / CELLS_A_SIDE**2


def outdated(now: PlanePicture, before: Sequence[PlanePicture]) -> list[int]:
    """Indices of the views `before` that show another scene than `now`: all of them, if most of those compared do.

    So a hand that passes through a single view makes only that view outdated. If that is the only one that can be
    compared, the other views tell whether a hand was in it. All are outdated as well if the two from the nearest
    directions are, as seen from farther aside a change may pass for a thing above the plane.
    """
    results = [differs(now, each) for each in before]
    gone = [at for at, is_other in enumerate(results) if is_other]
    compared = [at for at, is_other in enumerate(results) if is_other is not None]
    nearest = sorted(compared, key=lambda at: _aside(now, before[at]))[:2]
    has_changed = 2 * len(gone) > len(compared) or (len(nearest) == 2 and all(results[at] for at in nearest))
    if has_changed and len(compared) == 1:
        has_changed = not _is_alone(before[compared[0]], [each for at, each in enumerate(before) if at != compared[0]])
    return list(range(len(before))) if has_changed else gone


def _is_alone(view: PlanePicture, others: Sequence[PlanePicture]) -> bool:
    """Whether the view differs from most of those others that it can be compared with."""
    results = [is_other for is_other in (differs(view, each) for each in others) if is_other is not None]
    return 2 * sum(results) > len(results)


def outdated_with_far(now: PlanePicture, before: Sequence[PlanePicture]) -> list[int]:
    """As `outdated`, also of views from too far aside to be compared with `now`.

    From the nearest to the farthest, each of these is compared with those of which it is known by then whether they
    show the scene of `now`. It shows that scene if the nearest of them says so; that it does not takes the two nearest,
    as something may be before one of them.
    """
    gone = outdated(now, before)
    shows_it = {at: at not in gone for at, each in enumerate(before) if at in gone or differs(now, each) is not None}
    for at in sorted(range(len(before)), key=lambda at: _aside(now, before[at])):
        if at not in shows_it:
            aside = {other: _aside(before[other], before[at]) for other in shows_it}
            results = [
                (differs(before[other], before[at]), shows_it[other]) for other in sorted(aside, key=aside.__getitem__)
            ]
            nearest = [is_other != shows for is_other, shows in results if is_other is not None][:2]
            if nearest[:1] == [True] or nearest == [False, False]:
                shows_it[at] = nearest[0]
    return [at for at in range(len(before)) if not shows_it.get(at, True)]


def first_of_most(views: Sequence[TrackedFrame]) -> TrackedFrame:
    """The first of the views, with markers, that shows the scene which most of them show.

    A hand may still be in the first one. Where no view shows the scene of half of those that it can be compared with,
    it is the first one all the same.
    """
    if len(views) < 3:
        return views[0]
    pictures = [PlanePicture.of(view) for view in views]
    for at, view in enumerate(views):
        others = pictures[:at] + pictures[at + 1 :]
        if len(outdated(pictures[at], others)) < len(others):
            return view
    return views[0]


def of_one_scene(frozen: TrackedFrame, others: Sequence[TrackedFrame]) -> list[TrackedFrame]:
    """The others without those that show another scene than the frozen frame; all must have markers."""
    if not others:
        return []
    gone = outdated_with_far(PlanePicture.of(frozen), [PlanePicture.of(other) for other in others])
    return [other for place, other in enumerate(others) if place not in gone]


def _aside(a: PlanePicture, b: PlanePicture) -> float:
    """By how much a thing shears between two views, over its height."""
    return float(np.hypot(*(a.slope - b.slope)))


def _plane_from_cells(side_m: float) -> Float:
    """(3, 3) homography from cells, whose centres are integers, to the plane in metres."""
    cell_m = side_m / CELLS_A_SIDE
    first_m = -HALF_SIDES * side_m + cell_m / 2
    return np.array([[cell_m, 0, first_m], [0, cell_m, first_m], [0, 0, 1]])
