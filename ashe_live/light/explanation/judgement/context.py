"""The context of an explanation: what else its picture shows in favour of its light.

All objects of a picture stand in one light. If two objects were explained independently and agree about the light, that
is an accident only if both err in the same way. The mirror image of a light in glossy ground, and the shadow of the
marker's own sheet, agree with it or not in the same way.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ashe_live.core.proxy import Proxy
from ashe_live.core.transforms import angle_between
from ashe_live.light.explanation.explanation import Explanation
from ashe_live.light.ground.glint import Glint
from ashe_live.light.ground.sheet_shadow import SheetShadow
from ashe_live.light.shape.light_points import towards

AGREEING_RAD = math.radians(10)


@dataclass(frozen=True, slots=True, eq=False)
class Context:
    """What else a picture shows of its lights, beside the explanation that is judged."""

    others: Sequence[Explanation] = ()  # all that were tried on the picture, itself among them or not
    glint: Glint | None = None  # the mirror image of a light that the ground shows
    sheet: SheetShadow | None = None  # of the marker's own sheet


NO_CONTEXT = Context()


def context_features(explanation: Explanation, context: Context) -> dict[str, float]:
    """The features of an explanation that depend on its context (docs/maths, "Evidence")."""
    first = explanation.lights[0]
    agreeing = [
        min(other.alignment.clear_body, other.alignment.clear_shadow)
        for other in context.others
        if first.to_light_marker @ other.lights[0].to_light_marker > math.cos(AGREEING_RAD)
        and are_apart(explanation.proxy, other.proxy)
    ]
    if context.glint is not None:
        # A lamp is elsewhere as seen from the glint than from the marker.
        there = towards(first.light, np.append(context.glint.place_marker, 0.0))
        if angle_between(there, context.glint.to_light_marker) < AGREEING_RAD:
            agreeing.append(1.0)
    by_sheet = 0.0 if context.sheet is None else context.sheet.log_odds(first.to_light_marker)
    return {"agreeing": max(agreeing, default=0.0), "sheet": by_sheet}


def are_apart(one: Proxy, other: Proxy) -> bool:
    """Whether two bodies stand on different ground."""
    distance = float(np.linalg.norm(one.foot_marker - other.foot_marker))
    return distance > reach_m(one) + reach_m(other)


def reach_m(proxy: Proxy) -> float:
    """How far a body reaches from its foot along the ground, metres."""
    away = np.linalg.norm(proxy.spheroids_marker[:, :2] - proxy.foot_marker[:2], axis=1)
    return float((away + proxy.spheroids_marker[:, 3]).max())
