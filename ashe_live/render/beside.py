"""Where models first stand if the marker is printed on a body: beside it, in the picture, and clear of its shadow."""

import itertools
from dataclasses import dataclass

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.light import Light
from ashe_live.core.transforms import project
from ashe_live.core.types import TrackedFrame
from ashe_live.models.placement import Placement, seat_beside

# Distance between the middles of body and model: half of each, and a gap between them that lets light through.
AWAY_SIDES = 1.7
# Number of directions that are compared, and weights of a place nearer to the camera, to the side, out of the shadow,
# and in the picture, without which the others are worth nothing.
DIRECTIONS = 16
NEARER, ASIDE, OUT_OF_SHADOW, IN_PICTURE = 0.25, 0.5, 1.0, 3.0
TO_THE_RIGHT = 1e-3  # weight that only decides between places that are otherwise as good
# Cosine of a light's elevation below which the body's shadow counts the less the shorter it is.
STEEP_COSINE = 0.2


@dataclass(frozen=True, slots=True)
class FirstPlaces:
    """Where models stand that nobody has moved: in one row, through the marker's middle or beside a body."""

    middle_m: tuple[float, float] = (0.0, 0.0)  # marker frame
    along: tuple[float, float] = (1.0, 0.0)  # from one to the next, where the larger of the two is 1 or -1
    side_m: float = 0.0  # the marker's; without it the row is that of the seats

    def of(self, seat: int) -> Placement:
        """Relative to the seat, as a stand's placement is."""
        seat_x, _ = seat_beside(seat, self.side_m).shift_m
        (x, y), (along_x, along_y) = self.middle_m, self.along
        return Placement(shift_m=(x + seat_x * (along_x - 1), y + seat_x * along_y))

    def on_marker(self, seat: int, side_m: float) -> Placement:
        """The same relative to the middle of a marker of that side."""
        (x, y), (seat_x, seat_y) = self.of(seat).shift_m, seat_beside(seat, side_m).shift_m
        return Placement(shift_m=(x + seat_x, y + seat_y))


def first_places(tracked: TrackedFrame, light: Light | None, in_its_place: bool = False) -> FirstPlaces:
    """Over the marker; if that is on a body, beside the body as the picture shows it, and out of its shadow in `light`.

    in_its_place: the body is covered, and the models take its place.
    """
    if in_its_place or tracked.marker is None or tracked.marker.body is None:
        return FirstPlaces()
    right, away = picture_axes(tracked)
    angles = 2 * np.pi * np.arange(DIRECTIONS) / DIRECTIONS
    around: Float = np.cos(angles)[:, None] * right + np.sin(angles)[:, None] * away
    worth = ASIDE * np.abs(around @ right) - NEARER * (around @ away) + TO_THE_RIGHT * (around @ right)
    if light is not None:
        shadow = -light.to_light_marker[:2]
        cosine = float(np.linalg.norm(shadow))
        worth = worth - OUT_OF_SHADOW * np.maximum(around @ shadow, 0) / max(cosine, STEEP_COSINE)
    places = AWAY_SIDES * tracked.marker.side_m * around
    best = int((worth + IN_PICTURE * _share_in_picture(tracked, places, tracked.marker.side_m)).argmax())
    (x, y), outwards = places[best], around[best]
    # A row across the way to the body passes it by at the distance of the first model.
    across = np.array((-outwards[1], outwards[0])) / np.abs(outwards).max()
    across_x, across_y = across if across @ (right - away) >= 0 else -across
    return FirstPlaces((float(x), float(y)), (float(across_x), float(across_y)), tracked.marker.side_m)


def _share_in_picture(tracked: TrackedFrame, places_m: Float, side_m: float) -> Float:
    """(n,) how much of a model as large as the marker is seen at each of the places (n, 2)."""
    box = side_m * np.array(list(itertools.product((-0.5, 0.5), (-0.5, 0.5), (0.0, 1.0))))
    corners = (np.pad(places_m, ((0, 0), (0, 1)))[:, None] + box).reshape(-1, 3)
    pixels = project(tracked.camera, tracked.pose.T_cam_marker, corners)
    is_seen = ((pixels >= 0) & (pixels < tracked.frame.size)).all(axis=1)
    return np.asarray(is_seen.reshape(-1, len(box)).mean(axis=1))


def picture_axes(tracked: TrackedFrame) -> tuple[Float, Float]:
    """(2,) unit vectors on the plane, marker frame: to the right in the picture, and away from the camera."""
    right = np.array((1.0, 0.0))
    if tracked.marker is not None:
        seen = tracked.marker.T_cam_marker[0, :2]
        length = float(np.linalg.norm(seen))
        right = seen / length if length > 1e-6 else right
    return right, np.array((-right[1], right[0]))
