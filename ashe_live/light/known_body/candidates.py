"""Where a light may be: the likeliest directions of the scan, moved onto the edges of their shadows."""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ashe_live.core.arrays import Float, Float32
from ashe_live.core.transforms import camera_centre, normalised
from ashe_live.light.known_body.evidence import Evidence
from ashe_live.light.known_body.found_light import FoundLight
from ashe_live.light.known_body.outline.fit import fitted
from ashe_live.light.known_body.outline.room import Room
from ashe_live.light.known_body.seen import Seen
from ashe_live.light.known_body.templates import shadows_of, templates_of
from ashe_live.light.shape.light_points import at_infinity

TRIED, APART_RAD, TRIED_WITHIN = 3, math.radians(12), 12.0  # starts of a fit; within so much log likelihood of the best
MOST_MOVED_RAD = math.radians(15)  # by a fit: what moves farther has found other edges
LEAST_CLEAR = 0.5  # of the edges that can be seen, the part with a step: else a fit has found other edges
# Displacements around a template's, along it and across, over 1/2 + |s|: within the distance of the next one; then
# along it alone and finer, as the scan hardly tells the lengths of shadows that leave the picture.
AROUND = 0.045 * np.array([(along, across) for along in range(-2, 3) for across in range(-2, 3)])
ALONG = 0.035 * np.array([(along, 0) for along in range(-8, 4)])
TEMPLATES_APART = 0.1  # in s = (x, y) / z, over 1 + |s|, roughly
# Lights behind the camera, whose shadow the body hides: parts of the displacement at which the camera would cast it,
# and how far beside it, over 1 + |s|.
BEHIND, BEHIND_ASIDE = np.arange(0.15, 1.2, 0.1), np.array([-0.09, -0.03, 0.03, 0.09])


@dataclass(frozen=True, slots=True, eq=False)
class Directions:
    """Everywhere that a light is looked for."""

    lights: Float  # (m, 4) at infinity, unit (x, y, z)
    solid_angle: Float  # (m,) share of the upper hemisphere that each stands for
    shadows: Float32  # (m, n * n) part of each cell of the map that is in shadow

    @staticmethod
    def of(seen: Seen) -> "Directions":
        """The templates, and between them more of those whose shadow the body hides from the camera."""
        templates = templates_of(seen.body)
        eye = camera_centre(seen.view.T_cam_marker) - seen.body.foot_marker
        if eye[2] <= 0:
            return Directions(templates.lights, templates.solid_angle, templates.shadows)
        s = eye[:2] / eye[2]
        aside = np.array([-s[1], s[0]]) / max(float(np.hypot(*s)), 1e-9)
        wide = 1 + float(np.hypot(*s))
        grid = BEHIND[:, None, None] * s + wide * BEHIND_ASIDE[:, None] * aside
        s_all = np.column_stack([grid.reshape(-1, 2), np.ones(grid.size // 2)])
        lengths = np.linalg.norm(s_all, axis=1)
        lights = at_infinity(s_all / lengths[:, None])
        cell = float(np.hypot(*s)) * (BEHIND[1] - BEHIND[0]) * wide * (BEHIND_ASIDE[1] - BEHIND_ASIDE[0])
        return Directions(
            np.concatenate([templates.lights, lights]),
            np.concatenate([templates.solid_angle, cell / lengths**3 / (2 * math.pi)]),
            np.concatenate([templates.shadows, shadows_of(seen.body, lights)]),
        )


def refined(
    seen: Seen, directions: Directions, score: Float, darkenings: Float, beside: Evidence, room: Room
) -> Iterator[FoundLight]:
    """The likeliest different directions, each moved onto its shadow's edges where these are seen.

    score: (m,) log likelihood of each of the directions. darkenings: (m,) of each. beside: the picture, beside the
    lights that are known. room: table on which edges may be seen.
    """
    chosen: list[Float] = []
    for index in np.argsort(-score, kind="stable"):
        if score[index] < score.max() - TRIED_WITHIN or len(chosen) == TRIED:
            break
        template = directions.lights[index]
        if any(template[:3] @ other > math.cos(APART_RAD) for other in chosen):
            continue
        chosen.append(template[:3])
        start, darkening = _nearby(seen, template, beside)
        fit = fitted(seen.body, start, darkening, seen.light, room, seen.view) if darkening > 0 else None
        is_near = fit is not None and normalised(fit.light[:3]) @ normalised(start[:3]) > math.cos(MOST_MOVED_RAD)
        if fit is not None and is_near and fit.clear > LEAST_CLEAR:
            yield FoundLight(fit.light, fit.covariance, fit, darkening)
        else:
            mean, spread, darkening = _mean_near(directions, score, darkenings, template)
            yield FoundLight(mean, spread, None, darkening)


def _nearby(seen: Seen, template: Float, beside: Evidence) -> tuple[Float, float]:
    """The likeliest light (4,) around a template (4,), and its part of the table's light."""
    s = template[:2] / template[2]
    for offsets in (AROUND, ALONG):
        length = max(float(np.hypot(*s)), 1e-9)
        around = s + (0.5 + length) * offsets @ (np.array([s, (-s[1], s[0])]) / length)
        lights = at_infinity(np.column_stack([around, np.ones(len(around))]))
        scan = seen.scan(lights, beside)
        best = int(scan.log_likelihood.argmax())
        s = around[best]
    return lights[best], float(scan.darkenings[best, -1])


def _mean_near(directions: Directions, score: Float, darkenings: Float, light: Float) -> tuple[Float, Float, float]:
    """The mean light (4,) of the directions near one (4,), each as likely as its score says; the covariance (2, 2) of
    its displacement; and its part of the table's light.
    """
    near = directions.lights[:, :3] @ normalised(light[:3]) > math.cos(2 * APART_RAD)
    weight = directions.solid_angle[near] * np.exp(score[near] - score[near].max())
    weight /= weight.sum()
    # Directions are averaged, as displacements are long-tailed towards the horizon.
    mean = normalised(weight @ directions.lights[near, :3])
    mean = np.append(mean / mean[2], 0.0)
    away = directions.lights[near, :2] / directions.lights[near, 2:3] - mean[:2]
    # No finer than the templates lie.
    apart = TEMPLATES_APART * (1 + float(np.hypot(*mean[:2])))
    return mean, (weight[:, None] * away).T @ away + apart**2 * np.eye(2), float(weight @ darkenings[near])
