"""The printed sheet: how far the paper reaches beyond the marker's black square, measured in the picture.

People print and cut markers with margins of any width. What of the sheet is taken for ground stands out from it as an
object would, and joins the objects that stand beside it.
"""

from dataclasses import dataclass

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Float32, Image, Mask
from ashe_live.core.camera import Camera
from ashe_live.core.transforms import image_from_plane
from ashe_live.light.pixels.log_colour import log_opponent

# Distances from the marker's centre, in its sides: where the margin is surely paper, and how far its end is looked for.
# What is larger is a page, on which things stand.
PAPER_FROM, PAPER_TO, LARGEST_SHEET = 0.555, 0.605, 1.1
USUAL = 0.725  # where no end is seen, as on a white table
STEP = 0.02  # between samples
ALONG = np.linspace(-0.45, 0.45, 16)  # lines of samples across a side
LEAST_CHANGE = 0.2  # log-opponent distance from the margin's colour beyond which the paper has ended
LASTING = 4  # samples in a row for which it has, or else it is a speck; the last of them is past the blurred edge
HALF_WAY = 0.5  # of the change of colour, where the paper's blurred edge counts as its end
ADDED = 0.04  # sides: a card's thickness, and paper that curls


@dataclass(frozen=True, slots=True, eq=False)
class MarkerPicture:
    """A picture without distortion, its camera, and where in front of that the marker is."""

    image_bgr: Image  # (h, w, 3)
    camera: Camera  # of that size
    T_cam_marker: Float  # (4, 4)
    side_m: float  # of the marker

    def colours_at(self, places: Float) -> tuple[Float32, Mask, Mask]:
        """Log-opponent colours (..., n, 3) at places (..., n, 2) on the marker's plane, in its sides from its centre.

        And of each (..., n) whether it lies before the camera, and whether in the picture.
        """
        plane = np.insert(self.side_m * places, 2, 1.0, axis=-1)
        x, y, depth = np.moveaxis(plane @ image_from_plane(self.camera, self.T_cam_marker).T, -1, 0)
        is_ahead = depth > 1e-9 * self.side_m
        x, y = (np.where(is_ahead, each / np.where(is_ahead, depth, 1), -1.0).astype(np.float32) for each in (x, y))
        width, height = self.camera.size
        is_seen = is_ahead & (x >= 0) & (x <= width - 1) & (y >= 0) & (y <= height - 1)
        lines = -1, x.shape[-1]  # as one picture, which `remap` takes
        samples = cv2.remap(self.image_bgr, x.reshape(lines), y.reshape(lines), cv2.INTER_LINEAR)
        return log_opponent(np.asarray(samples, dtype=np.uint8), 0).reshape(*x.shape, 3), is_ahead, is_seen


@dataclass(frozen=True, slots=True)
class Sheet:
    """How far the printed sheet reaches from the marker's centre, in the marker's sides."""

    right: float = USUAL
    above: float = USUAL
    left: float = USUAL
    below: float = USUAL

    @property
    def ends(self) -> Float:
        """(4,) right, above, left and below."""
        return np.array([self.right, self.above, self.left, self.below])

    def corners(self, side_m: float) -> Float:
        """(4, 3) m, marker frame: the sheet's corners in order around it."""
        x0, x1, y0, y1 = -self.left, self.right, -self.below, self.above
        return side_m * np.array([(x0, y1, 0), (x1, y1, 0), (x1, y0, 0), (x0, y0, 0)])


USUAL_SHEET = Sheet()


def measured_sheet(picture: MarkerPicture) -> Sheet:
    """The sheet around the marker.

    From the black square outwards, the paper ends where most lines of samples leave the colour that they begin with.
    A side whose end is not seen is taken to be like the others.
    """
    outwards = np.arange(PAPER_FROM, LARGEST_SHEET, STEP)
    colours, is_ahead, is_seen = picture.colours_at(lines_outwards(outwards, ALONG, ALONG))
    if not is_ahead.all():
        return USUAL_SHEET
    paper = np.median(colours[:, :, outwards <= PAPER_TO], axis=2, keepdims=True)
    change = np.median(np.linalg.norm(colours - paper, axis=3), axis=1)
    ends = [_end(outwards, each) if seen.all() else None for each, seen in zip(change, is_seen, strict=True)]
    known = [end + ADDED for end in ends if end is not None]
    others = float(np.median(known)) if known else USUAL
    return Sheet(*(others if end is None else end + ADDED for end in ends))


def lines_outwards(outwards: Float, x: Float, y: Float) -> Float:
    """(4, lines, n, 2) places so far (n,) right, above, left and below of the centre, on lines at x and y (lines,)."""
    out, y = np.meshgrid(outwards, y)
    x = np.meshgrid(outwards, x)[1]
    return np.stack([(out, y), (x, out), (-out, y), (x, -out)]).transpose(0, 2, 3, 1)


def _end(outwards: Float, change: Float) -> float | None:
    """Where the change of colour (n,) begins to last; None where it does not."""
    is_other = change > LEAST_CHANGE
    lasts = np.logical_and.reduce([is_other[i : len(is_other) - LASTING + 1 + i] for i in range(LASTING)])
    if not lasts.any():
        return None
    begin = int(lasts.argmax())
    beyond = change[begin + LASTING - 1]
    return float(outwards[begin + int((change[begin:] > HALF_WAY * beyond).argmax())])
