"""Ambient occlusion of the ground around a model and of its own surface, computed once for each model.

By its definition it is the mean of the shadows of many lights spread all around, weighted by their cosines (Langer and
Buelthoff, "Depth discrimination from shading under diffuse lighting", 2000). A few directions are drawn at a time; if
the model moves, each of them in another pose, so that the result is a mean over its poses. It depends on the model
alone, and is moved, turned and scaled with it.
"""

from collections.abc import Generator, Iterator
from dataclasses import dataclass, replace
from weakref import WeakKeyDictionary

import moderngl
import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import GOLDEN_SHARE, Float, directions_on_spiral
from ashe_live.models.placement import PlacedModel
from ashe_live.render.gl.geometry import GpuModel
from ashe_live.render.gl.preset import FAST
from ashe_live.render.gl.programs import Programs
from ashe_live.render.lights.lighting import Lighting, ShadingLight
from ashe_live.render.lights.shadow_maps import ShadowMaps
from ashe_live.render.occlusion.contact import ContactPatch
from ashe_live.render.occlusion.self_occlusion import SelfOcclusion
from ashe_live.render.occlusion.stand_in import stand_in_for

DIRECTIONS = 80
# Directions drawn in one pass: a software rasteriser spends most of a pass on waiting for the one before.
AT_ONCE = 4
DEPTHS = replace(FAST, shadow_map_size=192, soft_on_model=True, soft_taps=8, pcf_radius=1)
# On the model each direction stands for a disc around it, which nearly touches its neighbours' (they are 0.4 apart). As
# points, few of which are seen from within a bowl, they would cast shadows with borders onto its bottom. Wider discs
# would shine past walls near by, behind which a depth map shows nothing.
DIAMETER_RAD = 0.36
NO_LIGHT = (0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True, eq=False)
class Hidden:
    """The occlusion by one model."""

    contact: NDArray[np.float16]  # as ContactPatch.smoothed
    openness: tuple[NDArray[np.uint8], ...]  # (n, 4) of each part's vertices, 255 for open


# Of models that are still referenced somewhere: for one that is shown again nothing is computed again.
Known = WeakKeyDictionary[PlacedModel, Hidden]


def occlusion_steps(
    ctx: moderngl.Context, programs: Programs, model: GpuModel, contact: ContactPatch, known: Known
) -> Generator[None, None, None]:
    """Fills the contact patch and the openness of the parts of a model that is uploaded; a round or a part each step.

    `known` has what is found from then on, and is believed.
    """
    if model.placed not in known:
        known[model.placed] = yield from _found(ctx, programs, model, contact)
    contact.fill(known[model.placed].contact)
    for part, openness in zip(model.parts, known[model.placed].openness, strict=True):
        part.set_openness(openness)
        yield


def _found(
    ctx: moderngl.Context, programs: Programs, model: GpuModel, contact: ContactPatch
) -> Generator[None, None, Hidden]:
    """What the model hides of the sky, from itself and from the ground at its foot, by shadows from all directions.

    Yields after each part of the work, so that frames are drawn meanwhile.
    """
    stand_in = stand_in_for(model.placed)
    caster = model
    depth_map = ShadowMaps(ctx, DEPTHS)
    on_model: SelfOcclusion | None = None
    try:
        if stand_in.placed is not model.placed:
            caster = GpuModel(ctx, stand_in.placed, programs)
            yield from caster.upload()
        on_model = SelfOcclusion(ctx, programs, stand_in.placed.model.parts)
        yield
        duration_s = model.placed.model.duration_s
        # The mean of a cosine over all directions, where it is positive, is a quarter.
        share = 4.0 / DIRECTIONS
        for number, directions in enumerate(_rounds()):
            # Not in the order of the rounds, which go around, and from above to below.
            moment_s = duration_s * (number * GOLDEN_SHARE % 1.0)
            caster.pose(moment_s)
            lights = tuple(ShadingLight(direction, NO_LIGHT, NO_LIGHT, DIAMETER_RAD) for direction in directions)
            depth_map.render((caster,), Lighting(lights, NO_LIGHT, NO_LIGHT))
            if directions[0, 2] > 0:
                contact.add(depth_map, share)
            on_model.add(depth_map, share, moment_s)
            yield
        openness = []
        for found, vertices in zip(on_model.openness(), stand_in.vertices, strict=True):
            openness.append(np.round(found * 255).astype(np.uint8)[vertices])
            yield
        distances = contact.distances(stand_in.placed.model.parts)
        yield
        return Hidden(contact.smoothed(distances), tuple(openness))
    finally:
        # moderngl binds again what was bound before, which must not have been released by then.
        ctx.detect_framebuffer(0).use()
        if caster is not model:
            caster.release()
        if on_model is not None:
            on_model.release()
        depth_map.release()


def _rounds() -> Iterator[Float]:
    """(AT_ONCE, 3) each, of all directions: the sphere's upper half first, every round from its top to its rim."""
    for half in np.split(directions_on_spiral(DIRECTIONS), 2):
        count = len(half) // AT_ONCE
        yield from (half[first::count] for first in range(count))
