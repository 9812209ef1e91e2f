"""A marker that lies flat beside the one that is followed."""

from dataclasses import dataclass

from ashe_live.core.arrays import Float, frozen_floats, set_frozen
from ashe_live.core.ranges import MARKER_SIDE


@dataclass(frozen=True, slots=True, eq=False)
class PlaneMarker:
    """Where another marker lies on the plane z = 0 of the one that is followed, and how large it is there."""

    spec: str
    centre_m: Float  # (2,) x, y; metres, frame of the marker that is followed
    turn_rad: float  # from that marker's x to its own, counter-clockwise seen from above
    side_m: float  # black square's side, by the size of the marker that is followed

    def __post_init__(self) -> None:
        set_frozen(self, centre_m=frozen_floats(self.centre_m, (2,), "centre_m"))
        MARKER_SIDE.checked(self.side_m, "side_m")
