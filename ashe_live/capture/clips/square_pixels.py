"""Pictures whose pixels are not square, as camcorders squeeze theirs."""

from fractions import Fraction

# A pixel's aspect ratio counts as 1 within the first (an encoder's rounding), and as damage beyond the second.
SAME_ASPECT, MOST_ASPECT = 0.005, 4


def with_square_pixels(size: tuple[int, int], aspect: Fraction | None) -> tuple[int, int]:
    """Width and height at which a picture of `size` is shown whose pixels are `aspect` times as wide as high.

    Camcorders squeeze theirs (HDV: 1440x1080 for 1920x1080); a squeezed picture has wrong angles.
    """
    if not aspect or abs(aspect - 1) < SAME_ASPECT or not 1 / MOST_ASPECT <= aspect <= MOST_ASPECT:
        return size
    width, height = size
    return (round(width * aspect), height) if aspect > 1 else (width, round(height / aspect))
