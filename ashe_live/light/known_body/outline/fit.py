"""Moves a light until the predicted edges of the body's shadow lie where the light on the table falls to its half."""

import math
from dataclasses import dataclass, replace

import numpy as np

from ashe_live.core.arrays import Float, Mask, once_for_each
from ashe_live.light.known_body.outline.edges import ShadowEdges
from ashe_live.light.known_body.outline.profiles import LEAST_PX, POINTS_A_SAMPLE, EdgeImage, Profiles
from ashe_live.light.pixels.view import View

# How far from the predicted edge the search reaches: of the body's height in the picture at first, then as much as the
# penumbra needs, in standard deviations, and never less than LEAST_PX.
REACHES = (0.25, 0.16)
MOST_ROUNDS, SPREADS, MOST_SHARE = 6, 2.6, 0.4
DONE_PX = 0.15  # a step that moves no edge farther is the last one: half of what a side may be off
BLUR_PX = 0.8  # standard deviation of the picture's blur, until it is measured
EARLY_LOSS = 2.0  # factor on the scale of Cauchy's loss in the first rounds
FEWEST = 5  # places that show an edge, without which nothing is fitted
# Of a start's displacement s, over 1 + |s|; and of where a lamp's shadow ends, over the same: that of a low one is far
# beyond the end of the sun's that was found in its place.
START_SIGMA, LAMP_START_SIGMA = 0.12, 0.4
NEARNESS_SIGMA = 1.5  # 1/m, of one over the light's distance before the picture is seen: most lamps are within it
NEAREST = 0.7  # height of the body over that of a lamp, at most
EDGE_SIGMA_PX = 0.3  # of an edge that is measured, beside which the start's own uncertainty counts
LEAST_SHOWN = 0.1  # mean weight of a side's visible places, below which its edge is not seen
LEAST_SIGMA_PX = 0.1  # of the edges' misfit, however small it is


@dataclass(frozen=True, eq=False)
class ShadowFit:
    """A light whose shadow's edges were moved onto those in the picture."""

    light: Float  # (4,) homogeneous, z = 1, marker frame
    covariance: Float  # (p, p) of s = (x, y) / z, and of the nearness w / z where that was fitted
    size_rad: float | None  # the light's angular diameter; None: its penumbra does not exceed the picture's blur
    misfit_px: float  # root mean square distance of the edges, robust
    misfit_share: float  # the same over how far they were looked for
    clear: float  # of the outline's points that could be seen, the part with a step as deep as the shadow
    seen: float  # part of the outline's points that could be seen
    view: View  # of the picture in which it was made

    @once_for_each
    def profiles_in(self, image: EdgeImage) -> Profiles | None:
        """Across the edges of its shadow; None where it has none in the picture."""
        edges = image.edges(self.light)
        if edges is None:
            return None
        return image.profiles(edges, windows_px(edges, BLUR_PX**2, self.size_rad or 0.0, image.height_px))

    def seen_again_in(self, image: EdgeImage, darkening: float) -> "ShadowFit":
        """With what is seen of its edges in another room, as beside lights that were not known when it was made."""
        profiles = self.profiles_in(image)
        if profiles is None:
            return self
        return replace(self, clear=profiles.clear(darkening), seen=float(profiles.visible.mean()))


def fitted(
    image: EdgeImage, light: Float, darkening: float, with_nearness: bool = False, size_rad: float | None = None
) -> ShadowFit | None:
    """The light near `light` (4,) that explains the edges; None where too few of them are seen.

    darkening: the part of the table's light that it gives, roughly. with_nearness: whether w / z is fitted, too; else
    it is held. size_rad: of a light that lies on its edges already, its angular diameter.
    """
    here, size, blur = light / light[2], size_rad or 0.0, BLUR_PX**2
    reaches = REACHES if size_rad is None else ()
    parameters = [0, 1, 3] if with_nearness else [0, 1]
    start, prior = prior_of(here, image.height_m, with_nearness)
    tall_px = image.height_px
    for number in range(MOST_ROUNDS):
        edges = image.edges(here)
        if edges is None:
            return None
        is_first = number < len(reaches)
        if is_first:
            wanted_px = np.full(len(edges.points_px), max(reaches[number] * tall_px, 2 * LEAST_PX))
        else:
            wanted_px = windows_px(edges, blur, size, tall_px)
        profiles = image.profiles(edges, wanted_px)
        weight = profiles.weights(darkening, EARLY_LOSS if is_first else 1.0)
        if np.count_nonzero(weight) < FEWEST:
            return None
        if number >= len(reaches) - 1:
            blur, size = profiles.widths(weight)
        last = _Round.of(profiles, weight, prior, here[parameters] - start)
        here = moved(here, last.step, image.height_m)
        if not is_first and np.abs(last.moves_px).max() < DONE_PX:
            break
    return last.fit(here, size or None, darkening, image.view)


def windows_px(edges: ShadowEdges, blur_px2: float, size_rad: float, height_px: float) -> Float:
    """(n,) how far an edge is looked for that is known but for its blur."""
    spread_px = np.sqrt(blur_px2 + (size_rad * edges.by_size) ** 2)
    return np.asarray(np.clip(SPREADS * spread_px, LEAST_PX, max(MOST_SHARE * height_px, LEAST_PX)))


def prior_of(light: Float, height: float, with_nearness: bool) -> tuple[Float, Float]:
    """(p,) mean and (p, p) information of a light's parameters before its edges are seen, by the start `light` (4,).

    In units of the residuals' weights. Where an edge is hidden, what it would determine stays as it was found. A start
    determines where the shadow of something `height` high ends, s / (1 - height w / z), but not what of that is
    nearness.
    """
    end = light[:2] / (1 - height * light[3])
    sigma = (LAMP_START_SIGMA if with_nearness else START_SIGMA) * (1 + math.hypot(*end))
    unit = EDGE_SIGMA_PX**2 * POINTS_A_SAMPLE
    if not with_nearness:
        return light[:2], unit / sigma**2 * np.eye(2)
    by_parameters = np.column_stack([np.eye(2), height * end])
    information = by_parameters.T @ by_parameters / sigma**2 + np.diag([0.0, 0.0, nearness_sigma(light) ** -2])
    return np.append(end, 0.0), unit * information


def nearness_sigma(light: Float) -> float:
    """Of the nearness w / z near a light (4,), z = 1, before the picture is seen: a low lamp's is over its distance."""
    return NEARNESS_SIGMA * math.sqrt(1 + float(light[:2] @ light[:2]))


def moved(light: Float, step: Float, height: float) -> Float:
    """A light (4,) with z = 1 after a step (p,) of its parameters, over a body of some height.

    Its displacement changes by no more than half of that and one, and no lamp comes near the body.
    """
    most = 0.5 * math.hypot(1.0, *light[:2])
    there = light.copy()
    there[:2] += step[:2] * min(1.0, most / max(math.hypot(*step[:2]), 1e-12))
    if len(step) > 2:
        there[3] = min(max(there[3] + step[2], -NEAREST / height), NEAREST / height)
    return there


def informative_sides(profiles: Profiles, weight: Float, darkening: float, with_nearness: bool) -> Mask:
    """(m,) which sides of an outline are evidence on where it lies, by the weights (n,) of its points.

    One that shows an edge in few places, by chance or by its neighbours', may lead a fit but adds no information.
    """
    side, count = profiles.edges.side, len(profiles.edges.corners_px)
    shown = np.bincount(side, weight, count) >= LEAST_SHOWN * np.bincount(side, profiles.visible, count)
    if with_nearness:
        # A lamp's shadow that leaves the picture may end nearly anywhere, and comes to rest on any step by chance.
        shown &= profiles.are_edges(darkening) | ~profiles.are_cut_off()
    return np.asarray(shown)


@dataclass(frozen=True, slots=True, eq=False)
class _Round:
    """A Gauss-Newton step of a light's p parameters, by n points of its shadow's edges."""

    profiles: Profiles
    weight: Float  # (n,)
    prior: Float  # (p, p) information of the start
    J: Float  # (n, p) pixels by which each edge moves along its normal, by each parameter
    step: Float  # (p,)

    @staticmethod
    def of(profiles: Profiles, weight: Float, prior: Float, off_start: Float) -> "_Round":
        """off_start: (p,) from the parameters of the start to those of the light whose edges these are."""
        J = profiles.edges.by_light[:, : len(off_start)]
        weighted = J.T * weight
        normal = weighted @ J + prior
        pull = weighted @ profiles.offset_px - prior @ off_start
        return _Round(profiles, weight, prior, J, np.asarray(np.linalg.solve(normal, pull)))

    @property
    def moves_px(self) -> Float:
        """(n,) by how much the step moves each edge."""
        return self.J @ self.step

    def fit(self, light: Float, size_rad: float | None, darkening: float, view: View) -> ShadowFit:
        """What is said of the light (4,) that this step has led to."""
        profiles, weight, edges, J = self.profiles, self.weight, self.profiles.edges, self.J
        left_px = profiles.offset_px - self.moves_px
        variance = float((weight * left_px**2).sum() / weight.sum()) + LEAST_SIGMA_PX**2
        is_informative = informative_sides(profiles, weight, darkening, with_nearness=len(self.step) > 2)
        informative = weight * is_informative[edges.side]
        inverse = np.linalg.inv((J.T * informative) @ J + self.prior)
        # What the edges leave open is as open as before, however well they fit.
        by_prior = max(EDGE_SIGMA_PX**2 - variance, 0.0) * inverse @ self.prior @ inverse
        # Neighbouring points err alike, and whole sides do where stains, folds or the hidden sky's gradient shift them.
        by_sides = (
            EDGE_SIGMA_PX * ((edges.side == np.arange(len(edges.corners_px))[:, None]) * informative) @ J @ inverse
        )
        return ShadowFit(
            light=light,
            covariance=np.asarray(POINTS_A_SAMPLE * (variance * inverse + by_prior) + by_sides.T @ by_sides),
            size_rad=size_rad,
            misfit_px=math.sqrt(variance),
            misfit_share=math.sqrt(float((weight * (left_px / profiles.reach_px) ** 2).sum() / weight.sum())),
            clear=profiles.clear(darkening),
            seen=float(profiles.visible.mean()),
            view=view,
        )
