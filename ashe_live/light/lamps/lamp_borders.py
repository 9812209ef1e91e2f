"""How the borders of silhouette and shadow constrain a light's nearness, whatever the body."""

from dataclasses import dataclass

import numpy as np

from ashe_live.core.arrays import Float, once_for_each
from ashe_live.light.explanation.alignment import lights_as_lamps
from ashe_live.light.explanation.explain import END_IN_VIEW
from ashe_live.light.explanation.explanation import Explanation
from ashe_live.light.explanation.light_covariance import tempered
from ashe_live.light.shape.directions import information_on_displacement
from ashe_live.light.shape.layout import ParameterLayout, nearness_of
from ashe_live.light.views.joint.aligned import views_per_sample

LEAST_EIGENVALUE = 1e-6  # of a correlation matrix


@dataclass(frozen=True, slots=True, eq=False)
class LampBorders:
    """One of an explanation's lights as a lamp, by the borders, the body marginalised out."""

    nearness: float  # 1/m, w / z that they ask for: 0 for a light at infinity
    nearness_sigma: float  # 1/m; one unknown body in one view hardly constrains it
    by_nearness: Float  # (2,) metres: the displacement s at the marker's centre by which a nearer light fits as well


@once_for_each
def lamp_borders(explanation: Explanation) -> list[LampBorders]:
    """For each light; all are about the explanation's own lights, whose displacement depends on their nearness.

    They are first-order figures. A shadow grows with height by 1 / (1 - k z), of which they leave out (k z)^2 from the
    second order on; so where they ask for another nearness by k, they are wrong by as much as k^2 h, h the body's top.
    """
    placed, frame = explanation.alignment.placed, explanation.lit.body.frame
    if explanation.nearness is not None:
        offset, information = explanation.nearness.offset, explanation.nearness.information
    else:
        views = [placed, *explanation.alignment.elsewhere]
        offset, unary = lights_as_lamps(views)
        by_borders = tempered(unary, explanation.alignment) / views_per_sample(len(views))
        information = by_borders + _of_ends_out_of_view(explanation)
        # What the borders leave open of a shadow without an end must not stay where the fit has left it.
        offset = _bounded_inverse(information) @ (by_borders @ offset)
    covariance = _bounded_inverse(information)
    layout, top = ParameterLayout(len(placed.lit.lights), with_nearness=True), placed.lit.body.height
    found = []
    for i, held in enumerate(nearness_of(placed.lit.lights)):
        of_light = layout.light(i)
        spread, asked = covariance[of_light, of_light], float(offset[of_light][2])
        sigma = float(np.hypot(np.sqrt(spread[2, 2]), asked**2 * top))
        from_origin = spread[:2, 2] / spread[2, 2] * frame.unit_m
        nearness = float(held) + asked / frame.unit_m
        found.append(LampBorders(nearness, sigma / frame.unit_m, from_origin + frame.origin_marker))
    return found


def length_by_light(light: Float, top: float) -> Float:
    """(3,) by how much the length of the shadow of what is `top` high grows with a light's displacement and nearness.

    Over how much it grows with the displacement's length. light: (4,) homogeneous, above `top`, with a displacement.
    """
    displacement = light[:2] / light[2]
    length = float(np.linalg.norm(displacement))
    return np.array([*(displacement / length), length * top / (1 - float(nearness_of(light)) * top)])


def _of_ends_out_of_view(explanation: Explanation) -> Float:
    """(3 l, 3 l) what is known of shadows' ends that the picture does not show, about the explanation's own lights.

    A shadow ends not far outside of the picture, (22b) of docs/maths, in whichever light: its top h casts a shadow
    of the length s h / (1 - k h), so that a nearer light of the same end has a shorter displacement, by s h / (1 - k h)
    for each k. Without this it would follow from the other borders alone, which hardly determine a shadow's length.
    """
    lit, layout = explanation.lit, ParameterLayout(len(explanation.lights), with_nearness=True)
    information = np.zeros((layout.split, layout.split))
    ends = zip(explanation.lights, lit.lights_in_body_frame, explanation.alignment.ends_in_view, strict=True)
    for i, (fitted, light, in_view) in enumerate(ends):
        if in_view >= END_IN_VIEW or not light[:2].any():
            continue
        end = length_by_light(light, lit.body.height)
        variance = end[:2] @ np.linalg.solve(information_on_displacement(fitted), end[:2])
        information[layout.light(i), layout.light(i)] = np.outer(end, end) / variance
    return information


def _bounded_inverse(information: Float) -> Float:
    """The inverse of a symmetric matrix whose smallest eigenvalues rounding may have made zero or negative."""
    scale = np.sqrt(np.maximum(np.diag(information), 1e-9))
    values, vectors = np.linalg.eigh(information / np.outer(scale, scale))
    return np.asarray((vectors / np.maximum(values, LEAST_EIGENVALUE)) @ vectors.T / np.outer(scale, scale))
