"""A real object of known shape and size, as a person gives it: by its sizes, or by the file of its model."""

from pathlib import Path

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.caster import Caster, parsed_caster
from ashe_live.models.loading import SUFFIXES, load_model_file
from ashe_live.models.placement import PlacedModel, all_around
from ashe_live.models.reading import read_apart

# Points of a hull, the extreme ones in so many directions: of a sphere they miss half a percent of its radius.
MOST_POINTS = 400


def read_caster(spec: str) -> Caster:
    """The body that `spec` gives: its kind and sizes (`parsed_caster`), or the path of a model's file.

    Of a model it is the convex hull, standing as it is loaded, with the file's unit for a metre; its hollows and gaps
    are filled. Raises UserError when there is no such body, or it is too small or too large to cast a shadow.
    """
    if Path(spec).suffix.lower() not in SUFFIXES:
        return parsed_caster(spec)
    return Caster.hull(read_apart(_extreme_points, (spec,), spec))


def _extreme_points(path: str) -> Float:
    """(n, 3) at most MOST_POINTS points of a model, whose convex hull is nearly its own."""
    model = load_model_file(Path(path))
    points = PlacedModel(model, model.bounds).outline
    extents = np.maximum(np.ptp(points, axis=0), 1e-6 * np.ptp(points))
    farthest = (points @ (all_around(MOST_POINTS) / extents).T).argmax(axis=0)
    return np.asarray(points[np.unique(farthest)])
