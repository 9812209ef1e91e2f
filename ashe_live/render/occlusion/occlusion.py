"""What a model hides of the sky and of the ground, from the ground around it and from its own surface; once a model.

Ambient occlusion by its definition: the mean of the shadows that many lights spread all around would cast, each with
the weight of its cosine (Langer and Buelthoff, "Depth discrimination from shading under diffuse lighting", 2000). Drawn
a direction at a time; of a model that moves each in another pose, so that it is the mean over them. It depends on the
model alone: it is moved, turned and scaled with it.
"""

from collections.abc import Generator
from dataclasses import replace

import moderngl

from ashe_live.core.arrays import directions_on_spiral
from ashe_live.render.gl.geometry import GpuModel
from ashe_live.render.gl.preset import FAST
from ashe_live.render.gl.programs import Programs
from ashe_live.render.lights.lighting import Lighting, Sun
from ashe_live.render.lights.shadow_maps import ShadowMaps
from ashe_live.render.occlusion.contact import ContactPatch
from ashe_live.render.occlusion.self_occlusion import SelfOcclusion
from ashe_live.render.occlusion.stand_in import stand_in_for

DIRECTIONS = 80
DEPTHS = replace(FAST, shadow_map_size=192, soft_on_model=False, pcf_radius=1)
NO_LIGHT = (0.0, 0.0, 0.0)
GOLDEN_SHARE = 0.618034  # multiples of which are spread evenly


def occlusion_steps(
    ctx: moderngl.Context, programs: Programs, model: GpuModel, contact: ContactPatch
) -> Generator[None, None, None]:
    """Fills the contact patch and the openness of the parts of a model that is uploaded, a direction each step."""
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
        for number, direction in enumerate(directions_on_spiral(DIRECTIONS)):
            # Not in the order of the directions, which go from above to below.
            moment_s = duration_s * (number * GOLDEN_SHARE % 1.0)
            caster.pose(moment_s)
            depth_map.render((caster,), Lighting((Sun(direction, NO_LIGHT, NO_LIGHT, 0.0),), NO_LIGHT, NO_LIGHT))
            if direction[2] > 0:
                contact.add(depth_map, share * float(direction[2]))
            on_model.add(depth_map, share, moment_s)
            yield
        contact.finish()
        for part, found, vertices in zip(model.parts, on_model.openness(), stand_in.vertices, strict=True):
            part.set_openness(found[vertices])
            yield
    finally:
        # moderngl binds again what was bound before, which must not have been released by then.
        ctx.detect_framebuffer(0).use()
        if caster is not model:
            caster.release()
        if on_model is not None:
            on_model.release()
        depth_map.release()
