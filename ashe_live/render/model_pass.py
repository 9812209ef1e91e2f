"""The model itself: matt, under sky and sun, shadowing itself."""

import moderngl

from ashe_live.render.framing import Framing
from ashe_live.render.geometry import GpuModel
from ashe_live.render.lighting import Lighting
from ashe_live.render.programs import build_program, set_uniforms
from ashe_live.render.shadow_map import ShadowMap

# White, fully lit, comes out a little below the display's white, as paper in a well exposed photo does.
EXPOSURE = 0.8


class ModelPass:
    def __init__(self, ctx: moderngl.Context, pcf_radius: int) -> None:
        self._ctx = ctx
        self.program = build_program(ctx, "model", pcf_radius=pcf_radius)

    def draw(self, model: GpuModel, framing: Framing, lighting: Lighting, shadow: ShadowMap) -> None:
        shadow.bind(self.program, 1)
        set_uniforms(
            self.program,
            clip_from_marker=framing.clip_from_marker,
            base_texture=0,
            sky=lighting.sky,
            sun=lighting.sun,
            to_light=tuple(lighting.to_light),
            ground_bounce=lighting.bounce,
            exposure=EXPOSURE,
            shadow_texel_m=shadow.texel_m,
        )
        for part in model.parts:
            faces = 0 if part.double_sided else moderngl.CULL_FACE
            self._ctx.enable_only(moderngl.DEPTH_TEST | faces)
            part.texture.use(0)
            set_uniforms(self.program, base_colour=part.base_colour)
            part.shaded.render()

    def release(self) -> None:
        self.program.release()
