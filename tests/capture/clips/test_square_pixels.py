"""A squeezed picture is shown as wide or as high as it was before it was squeezed, and loses no pixel by it."""

from fractions import Fraction

import pytest

from ashe_live.capture.clips.square_pixels import with_square_pixels


@pytest.mark.parametrize(
    ("size", "aspect", "shown"),
    [
        ((1440, 1080), Fraction(4, 3), (1920, 1080)),  # HDV
        ((720, 576), Fraction(16, 15), (768, 576)),  # PAL
        ((720, 480), Fraction(8, 9), (720, 540)),  # NTSC
        ((300, 200), Fraction(2), (600, 200)),
        ((300, 200), Fraction(4), (1200, 200)),
        ((300, 200), Fraction(1, 3), (300, 600)),
        ((300, 200), Fraction(1, 4), (300, 800)),
        ((1000, 1000), Fraction(1006, 1000), (1006, 1000)),
    ],
)
def test_what_was_squeezed_is_stretched(size: tuple[int, int], aspect: Fraction, shown: tuple[int, int]) -> None:
    assert with_square_pixels(size, aspect) == shown


@pytest.mark.parametrize(
    "aspect",
    [
        None,
        Fraction(0),
        Fraction(1),
        Fraction(1004, 1000),
        Fraction(996, 1000),
        Fraction(9, 2),
        Fraction(2, 9),
        -Fraction(4, 3),
    ],
)
def test_square_pixels_and_damage_leave_a_picture_as_it_is(aspect: Fraction | None) -> None:
    """A rounding of an encoder's, and pixels of a shape that no camera has."""
    assert with_square_pixels((1440, 1080), aspect) == (1440, 1080)
