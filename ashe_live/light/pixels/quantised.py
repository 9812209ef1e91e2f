"""A picture's colours quantised to the size of the noise, so that costs are computed once per cell, not per pixel."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float32
from ashe_live.light.pixels.mixtures import COLOUR_NOISE


@dataclass(frozen=True, slots=True, eq=False)
class Quantised:
    """The cells of colour space, as large as the noise, in which a picture's colours lie."""

    colours: Float32  # (k, 3) log-opponent, the mean of each cell's
    cell: NDArray[np.intp]  # (h, w) index of each pixel's cell

    @staticmethod
    def of(colours: Float32) -> "Quantised":
        """Quantises the colours of a picture (h, w, 3)."""
        flat = colours.reshape(-1, 3)
        places = np.floor(flat / COLOUR_NOISE.astype(np.float32)).astype(np.int32)
        places -= places.min(axis=0)
        _, spans_y, spans_z = (int(most) + 1 for most in places.max(axis=0))
        number = (places[:, 0] * spans_y + places[:, 1]) * spans_z + places[:, 2]
        _, cell, counts = np.unique(number, return_inverse=True, return_counts=True)
        sums = np.stack([np.bincount(cell, channel) for channel in flat.T], axis=1)
        return Quantised((sums / counts[:, None]).astype(np.float32), cell.reshape(colours.shape[:2]))

    def as_picture(self, values: Float32) -> Float32:
        """(h, w) the values (k,) of the cells, spread over their pixels."""
        return values.take(self.cell)
