"""A real object of known shape and size, as a person gives it: by its sizes, or by the file of its model."""

import os
from pathlib import Path

import numpy as np

from ashe_live.core.arrays import Float, directions_on_spiral
from ashe_live.core.caster import SIZES, Caster, parsed_caster
from ashe_live.models.loading import SUFFIXES, load_model_file
from ashe_live.models.placement import PlacedModel
from ashe_live.models.reading import read_isolated

# A hull of fewer points may fall short of the model by MOST_MISSED of its extent in any of these directions: a third of
# the error of sizes measured with a ruler.
DIRECTIONS, MOST_MISSED = 400, 0.005


def read_caster(spec: str) -> Caster:
    """The body that `spec` gives: its kind and sizes (`parsed_caster`), or the path of a model's file.

    Of a model it is the convex hull, standing as it is loaded, with the file's unit for a metre; its hollows and gaps
    are filled. Raises UserError when there is no such body, or it is too small or too large to cast a shadow.
    """
    is_file = Path(spec).suffix.lower() in SUFFIXES
    # A file of another kind is read too, so that it is said what is wrong with it.
    if not is_file and (spec.partition(":")[0] in SIZES or not os.path.exists(spec)):  # noqa: PTH110 - of any name
        return parsed_caster(spec)
    return Caster.hull(read_isolated(_few_points, (spec,), spec))


def _few_points(path: str) -> Float:
    """(n, 3) as few points of a model as reach nearly as far as it does, those that are missed most first."""
    model = load_model_file(Path(path))
    points = PlacedModel(model, model.bounds).outline
    reaches = directions_on_spiral(DIRECTIONS) @ points.T
    farthest, whole = reaches.argmax(axis=1), reaches.max(axis=1)
    chosen, reached = [], np.full(DIRECTIONS, -np.inf)
    while (whole - reached).max() > MOST_MISSED * np.ptp(points, axis=0).max():
        chosen.append(int(farthest[(whole - reached).argmax()]))
        reached = np.maximum(reached, reaches[:, chosen[-1]])
    return np.asarray(points[chosen])
