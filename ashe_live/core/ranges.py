"""Which numbers make sense: the same limits for the command line, settings, camera files and the Python API."""

import math
import numbers
from dataclasses import dataclass
from decimal import Decimal


@dataclass(frozen=True, slots=True)
class Range:
    """From `low` to `high`, both included."""

    low: float
    high: float
    unit: str = ""

    def __contains__(self, value: float) -> bool:
        return self.low <= value <= self.high  # not of NaN; of whole numbers too large for a float as of any

    def __str__(self) -> str:
        return f"from {_plain(self.low)} to {_plain(self.high)}{self.unit and ' '}{self.unit}"

    def checked(self, value: float, name: str) -> float:
        """Returns `value`, as a float unless it is an int: with a float16 or a fraction, sums would be of their kind.

        Raises TypeError or ValueError, naming it, when it is not a number or lies outside.
        """
        if isinstance(value, bool) or not isinstance(value, numbers.Real):
            raise TypeError(f"{name} must be a number {self}, and is a {type(value).__name__}")
        try:
            number = value if isinstance(value, int) else float(value)
        except OverflowError:
            number = math.inf
        if number not in self:
            raise ValueError(f"{name} must be a number {self}, and is {_shown(value)}")
        return number


MARKER_SIDE = Range(1e-6, 1e6, "m")  # as far as the arithmetic is safe
PRINTED_SIDE = Range(1e-4, 10.0, "m")  # of a marker that somebody has: sizes given in millimetres are above it
CASTER_SIZE = Range(1e-3, 10.0, "m")  # of an object beside a marker; sizes given in millimetres are above it
PRINTED_MM = Range(0.1, 10_000, "mm")  # pages have narrower limits, which printing states
FOCAL = Range(1e-3, 1e7, "px")  # of a picture of one pixel to a telescope's
FOCAL_ERROR = Range(0.0, 1e7, "px")  # a focal length's standard deviation
PIXEL = Range(-1e7, 1e7, "px")  # a place in a picture or far outside it
DISTORTION = Range(-1e6, 1e6)
SIDE = Range(1, 16384, "px")  # of a picture: the most that graphics cards draw
FIELD_OF_VIEW = Range(0.1, 179.0, "degrees")  # for a picture with any such SIDE the focal length is within FOCAL
DRAWN = Range(1, 4096**2, "px")  # in a picture that is drawn, for each of which up to 75 bytes are kept
COUNT = Range(1, 1e9)
SHARE = Range(0.0, 1.0)
ANGLE = Range(0.0, 6.2832, "rad")
ANGULAR_SIZE = Range(0.0, math.pi, "rad")  # of a light: nothing is seen larger than half of all directions
VARIANCE = Range(0.0, 1e24)  # as far as the arithmetic is safe; lengths are below 1e6 m
INVERSE_DISTANCE = Range(0.0, 1e3, "1/m")  # of a lamp: no nearer than a millimetre
LAMP_RADIUS = Range(0.0, 1e3, "m")
INDEX = Range(0, 1e9)
VIEWS = Range(1, 12)  # of one scene that an estimate takes, and that are kept of a video for it
SCALE = Range(1e-6, 1e6)  # of a model, relative to the size that it is given by its marker
TURN = Range(-1e6, 1e6, "rad")
SHIFT = Range(-1e6, 1e6, "m")
TIME = Range(-1e10, 1e10, "s")  # since a clip or a motion began; also since 1970, as clocks tell it
CAMERA_NUMBER = Range(0, 65535)


def _plain(number: float) -> str:
    """All its digits, as a rounded limit may lie beyond it, without an exponent, in which nobody would write them."""
    return f"{Decimal(repr(number)):f}".removesuffix(".0")


def _shown(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 40 else f"{text[:32]}..."
