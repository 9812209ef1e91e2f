"""Which views still show the scene of the first: nothing moved, the same light on, the marker where it was.

Around a body and its shadow that explain the first view, the plane must look the same from everywhere, except where the
body hides it. Where the shadow has gone, the body stands elsewhere, or the print has moved, it does not.
"""

from collections.abc import Sequence

import numpy as np

from ashe_live.core.arrays import Float, Mask
from ashe_live.core.proxy import Proxy
from ashe_live.core.types import TrackedFrame
from ashe_live.light.explanation.explanation import Explanation
from ashe_live.light.explanation.judgement.judge import Judge
from ashe_live.light.pixels.areas import grown
from ashe_live.light.pixels.log_colour import log_opponent
from ashe_live.light.pixels.view import View
from ashe_live.light.shape.predicted import predicted
from ashe_live.light.views.joint.aligned import in_each_view
from ashe_live.light.views.plane import OnPlane, on_plane, where_in

WIDTH_PX = 160  # at which views are compared: displacements that matter are larger than its pixels
SQUARED_SIGMAS = 21.1  # of a residual in three channels, exceeded once in ten thousand
AROUND_PX, HIDDEN_PX = 5, 2  # how far around body and shadow the plane is compared; margin of what the body hides
LEAST_PX = 30  # of the plane to compare
MOST_AROUND, MOST_OF_SHADOW = 0.08, 0.2  # fractions of the pixels that may differ: body and gloss are not quite known
# By how many log odds an explanation may be less likely in a view than in the first one, for the view to count as one
# of the same scene: one of another scene has no borders where the body and its shadow should be, and is behind by more.
MOST_BEHIND_FIRST = 1.0


def agreeing(views: Sequence[View], body: Proxy, lights: Float, depth: float = 0.0) -> list[bool]:
    """For each view but the first, whether it shows the scene that `body` and `lights` (l, 4) explain in the first.

    views: WIDTH_PX wide. depth: of the shadow, in log brightness; what differs by less than half of it is gloss. A view
    that shows too little of the plane around them contradicts nothing, and agrees.
    """
    first, *others = views
    colours = log_opponent(first.image_bgr)
    seen = predicted(body, lights, first)
    found = []
    for other in others:
        plane = on_plane(first, colours, other, log_opponent(other.image_bgr))
        if plane is None:
            found.append(True)
            continue
        hidden = grown(seen.body | where_in(predicted(body, lights, other).body, other, first), HIDDEN_PX)
        clear = plane.seen & ~hidden
        differs = _differs(plane, 0.5 * depth)
        around = grown(seen.whole, AROUND_PX) & clear
        shadow = seen.shadow & clear
        found.append(_share(differs, around) <= MOST_AROUND and _share(differs, shadow) <= MOST_OF_SHADOW)
    return found


def without_confirming(several: Sequence[TrackedFrame], explanation: Explanation, judge: Judge) -> list[TrackedFrame]:
    """Those of the frames that do not show body and shadow where an explanation of theirs and others has them.

    In the ones that do, the plane looks different because something else stands before it. explanation: of several
    views, the first of which is not among the frames.
    """
    first, *others = in_each_view(explanation).each
    least = judge.log_odds(first) - MOST_BEHIND_FIRST
    confirming = [each.region.view for each in others if judge.log_odds(each) > least]
    return [each for each in several if not any(view.shows(each.marker) for view in confirming)]


def _differs(plane: OnPlane, least: float) -> Mask:
    """(h, w) where the two views do not show the same, and differ in log brightness by `least`."""
    are_sure = (plane.residual**2 / plane.variance).sum(axis=2) > SQUARED_SIGMAS
    return np.asarray(are_sure & (np.abs(plane.residual[..., 0]) >= least))


def _share(mask: Mask, within: Mask) -> float:
    """The fraction of `within` that is in `mask`; 0 where there is too little of it."""
    count = np.count_nonzero(within)
    return int(np.count_nonzero(mask & within)) / int(count) if count >= LEAST_PX else 0.0
