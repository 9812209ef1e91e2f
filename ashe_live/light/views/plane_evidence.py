"""A view with the others' evidence on which of its pixels lie on the plane, and without it."""

from collections.abc import Sequence
from dataclasses import replace

from ashe_live.light.explanation.scene_view import SceneView
from ashe_live.light.ground.lit_ground import with_on_plane
from ashe_live.light.pixels.log_colour import log_opponent
from ashe_live.light.views.plane import log_likelihood_ratio, on_plane

# Number of views that the plane is compared with, for the first view and for another: more add hardly any evidence.
COMPARED_WITH_FIRST, COMPARED_WITH_ANOTHER = 4, 1


def with_plane(views: Sequence[SceneView]) -> list[SceneView]:
    """The views with the others' evidence on which of their pixels lie on the plane."""
    found, colours = [], [log_opponent(view.coarse.image_bgr) for view in views]
    for number, view in enumerate(views):
        others = [i for i in range(len(views)) if i != number]
        others = others[: COMPARED_WITH_ANOTHER if number else COMPARED_WITH_FIRST]
        seen = [on_plane(view.coarse, colours[number], views[i].coarse, colours[i]) for i in others]
        ratio = log_likelihood_ratio([each for each in seen if each is not None], view.coarse.is_ground.shape)
        found.append(replace(view, ground=with_on_plane(view.ground, ratio)))
    return found


def without_plane(view: SceneView) -> SceneView:
    """The view without the others' evidence on which of its pixels lie on the plane."""
    return replace(view, ground=replace(view.ground, on_plane=None))
