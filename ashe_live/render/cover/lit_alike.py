"""Whether what was made in one light serves in another."""

import math

from ashe_live.core.arrays import same_objects
from ashe_live.core.light import Illumination

OTHER_LIGHT_COS = math.cos(math.radians(10.0))  # answers about one light are mostly nearer to each other


def is_same_scene(one: Illumination, other: Illumination) -> bool:
    """Whether one cover serves both: the same light on the same things, seen in the same frame, hence of one source."""
    if one.seen_in is not other.seen_in or one.real_object is not other.real_object:
        return False
    return same_objects(one.lights, other.lights)


def is_other_light(one: Illumination, other: Illumination) -> bool:
    """Whether there are more or fewer lights, or one is elsewhere, by the same frame of the marker."""
    if len(one.lights) != len(other.lights):
        return True
    pairs = zip(one.lights, other.lights, strict=True)
    return any(a.to_light_marker @ b.to_light_marker < OTHER_LIGHT_COS for a, b in pairs)
