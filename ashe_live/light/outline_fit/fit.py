"""Fits bodies and lights to the outlines of an object's mask and of its shadows' masks.

Families of bodies are tried one generation after the other, from simple to rich. The best member of each is searched
for together with the lights, and families are ranked by the Bayesian information criterion (docs/maths, "Search").
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from ashe_live.core.arrays import Float, Mask
from ashe_live.light.outline_fit.first_guess import FirstGuess, guess_scene
from ashe_live.light.outline_fit.preset import FitPreset
from ashe_live.light.outline_fit.residuals import Observations
from ashe_live.light.outline_fit.search import Problem, Solution, search
from ashe_live.light.shape.body import Body, LitBody
from ashe_live.light.shape.families import FAMILIES
from ashe_live.light.shape.family import Family
from ashe_live.light.shape.known import family_of, resized_family_of
from ashe_live.light.shape.layout import ParameterLayout
from ashe_live.light.shape.light_points import held_near
from ashe_live.light.shape.outlines.silhouettes import EDGE_SIGMA_PX, Outlines, observe_outlines
from ashe_live.light.shape.sight import Sight

# The number of directions over the effective sample size, as errors in neighbouring directions are correlated.
DIRECTIONS_PER_SAMPLE = 4.0
# Scale of Cauchy's loss, as a fraction of the object's size, and its limits in pixels: larger errors are outliers (a
# handle, a hole in a mask).
OUTLIER_SHARE, OUTLIER_PX = 0.03, (0.75, 4.0)
# Upper limit of `FitPreset.sufficient_rms`, as a fraction of the object's size, so that small objects try all families.
SUFFICIENT_SHARE = 0.005
HIGHEST_NEARNESS = 0.7  # of a lamp, times the guessed height of the body below it


@dataclass(frozen=True, slots=True, eq=False)
class Masks:
    """An object that stands on the marker plane and the shadows that it casts, as a camera sees them.

    Masks: (h, w) of the camera's size, of undistorted pixels.
    """

    body: Mask
    shadows: Sequence[Mask]  # one for each light
    sight: Sight
    unreliable: Mask | None = None  # pixels that are neither object, shadow nor ground (the marker, other objects)
    undecided: Mask | None = None  # pixels outside the masks that belong to the object or to a shadow
    start: Float | None = None  # (l, 4) lights, marker frame, as a further start
    nearness: float = 0.0  # 1/m, w / z at which the first light is held: 0 for one at infinity


@dataclass(frozen=True, slots=True, eq=False)
class FittedBodies:
    """The best body of every family that was tried, with its lights."""

    bodies: list[LitBody]  # the likeliest first
    sight: Sight  # in which they were fitted, about the object's centre


def fit_bodies(several: Sequence[Masks], preset: FitPreset) -> list[FittedBodies | None]:
    """For each scene the best body of every family with its lights, None where there is none; one batch, for speed."""
    scenes = [_scene(masks, preset) for masks in several]
    known = [scene for scene in scenes if scene is not None]
    for lights in {len(scene.outlines.shadows) for scene in known}:
        _try_families([scene for scene in known if len(scene.outlines.shadows) == lights], preset)
    return [None if scene is None else scene.fitted() for scene in scenes]


@dataclass(slots=True, eq=False)
class _Scene:
    """The outlines to fit, the starts of the search, and the solutions found so far."""

    outlines: Outlines
    sight: Sight  # its pixels counted from the outlines' centre
    guess: FirstGuess
    starts: list[Float]  # (l, 4) each, lights to start from, in the frame of the guess
    nearness: Float  # (l,) at which each light is held, in that frame
    solutions: dict[str, Solution] = field(default_factory=dict)  # by family

    @property
    def outlier_px(self) -> float:
        return min(max(OUTLIER_SHARE * self.outlines.size_px, OUTLIER_PX[0]), OUTLIER_PX[1])

    def is_explained(self, sufficient_rms: float) -> bool:
        least = min((solution.mean_square for solution in self.solutions.values()), default=math.inf)
        return math.sqrt(least) < min(sufficient_rms * EDGE_SIGMA_PX, SUFFICIENT_SHARE * self.outlines.size_px)

    def problem(self, number: int, family: Family) -> Problem:
        """The search among a family's members; number: this scene's index in the observations."""
        if family.grows_from is None:
            height, radius = math.log(self.guess.height), self.guess.radius
            shapes, lights = family.starts(np.array([0.0, 0.0, height, radius, radius])), self.starts
        else:
            parent = self.solutions[family.grows_from]
            shapes, lights = family.starts(parent.shape), [parent.lights]
        return Problem(
            number, family, np.repeat(lights, len(shapes), axis=0), np.tile(shapes, (len(lights), 1)), self.nearness
        )

    def fitted(self) -> FittedBodies:
        """The solutions, by rising information criterion."""
        ranked = sorted(self.solutions.values(), key=_information_criterion)
        frame = self.guess.frame
        bodies = [LitBody(Body(frame, one.family, one.shape), frame.lights_marker(one.lights)) for one in ranked]
        return FittedBodies(bodies, self.sight)

    @property
    def least_cost(self) -> float:
        return min((solution.cost for solution in self.solutions.values()), default=math.inf)


def _scene(masks: Masks, preset: FitPreset) -> _Scene | None:
    outlines = observe_outlines(masks.body, masks.shadows, masks.unreliable, preset.directions, masks.undecided)
    if outlines is None:
        return None
    sight = replace(masks.sight, centre_px=outlines.centre_px)
    guess = guess_scene(sight, outlines, preset.caster)
    if guess is None:
        return None
    nearness = np.zeros(len(guess.lights))
    nearness[0] = min(masks.nearness * guess.frame.unit_m, HIGHEST_NEARNESS / guess.height)
    starts = [held_near(guess.lights, nearness, guess.height)]
    if masks.start is not None:
        starts.append(held_near(guess.frame.lights(masks.start), nearness, 0.5 * guess.height))
    return _Scene(outlines, sight, guess, starts, nearness)


def _try_families(scenes: Sequence[_Scene], preset: FitPreset) -> None:
    """Solves scenes that have the same number of lights, adding to their `solutions`."""
    observations = Observations.stacked(
        [scene.sight.P(scene.guess.frame) for scene in scenes],
        [scene.outlines for scene in scenes],
        [scene.outlier_px for scene in scenes],
    )
    for families in _generations(preset):
        # All families that grow from the first guess are tried in any case, as a small ball also looks much like a cup.
        problems = [
            scene.problem(number, family)
            for family in families
            for number, scene in enumerate(scenes)
            if not (family.grows_from and scene.is_explained(preset.sufficient_rms))
        ]
        if not problems:
            break
        least_cost = np.array([scene.least_cost for scene in scenes])
        solutions = search(observations, problems, least_cost, preset.iterations)
        for problem, solution in zip(problems, solutions, strict=True):
            scenes[problem.scene].solutions[problem.family.name] = solution


def _generations(preset: FitPreset) -> list[list[Family]]:
    """The families that grow from the first guess, then those that grow from one of these."""
    if preset.caster is not None:
        return [[(resized_family_of if preset.resizes else family_of)(preset.caster)]]
    families = [FAMILIES[name] for name in preset.families]
    return [
        [family for family in families if family.grows_from is None],
        [family for family in families if family.grows_from is not None],
    ]


def _information_criterion(solution: Solution) -> float:
    """The Bayesian information criterion with the effective sample size for n; lower is better."""
    parameters = ParameterLayout(len(solution.lights)).split + solution.shape.size
    measurements = max(solution.count / DIRECTIONS_PER_SAMPLE, parameters + 1.0)
    error = solution.mean_square + EDGE_SIGMA_PX**2
    return measurements * math.log(error) + parameters * math.log(measurements)
