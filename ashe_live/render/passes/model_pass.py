"""Draws the models, each part with the shader variant that computes only what its material needs."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from enum import Enum, auto

import moderngl
import numpy as np

from ashe_live.core.arrays import GOLDEN_SHARE, Float
from ashe_live.core.transforms import transform_points
from ashe_live.models.material import BLACK, Alpha, Material
from ashe_live.render.gl.framing import Framing
from ashe_live.render.gl.geometry import GpuModel, GpuPart
from ashe_live.render.gl.map_layout import layout_constants, layout_uniforms
from ashe_live.render.gl.programs import Programs, set_uniforms
from ashe_live.render.gl.texture_units import UNIT_OF
from ashe_live.render.lights.ground_shadows import GroundShadows
from ashe_live.render.lights.lighting import RGB, Lighting
from ashe_live.render.lights.shadow_maps import ShadowMaps
from ashe_live.render.passes.standing import StandingGroup, StandingModel
from ashe_live.render.reflections.environment import Environment

NOWHERE: Float = np.zeros((4, 4))  # as a projection: nothing is drawn, but the shader gets compiled
# A narrower specular lobe would be a point that flickers between pixels.
MIN_ROUGHNESS = 0.06
SOLID = 0.95  # opacity from which on a blended surface hides what is drawn later behind it


class Only(Enum):
    """Places of a part that are drawn by themselves."""

    RIM = auto()  # of what is cut out: pixels that it fills in part
    SOLID = auto()  # of what is blended: what hides all that is behind it
    CLEAR = auto()  # and the others


@dataclass(frozen=True, slots=True, eq=False)
class LookedUp:
    """The textures that surfaces sample besides their own maps."""

    shadows: ShadowMaps
    ground_shadows: GroundShadows  # on the ground that they mirror
    environment: Environment


@dataclass(frozen=True, slots=True, eq=False)
class ShadingInputs:
    """The inputs to the shading of every part, besides its material."""

    framing: Framing
    lighting: Lighting
    looked_up: LookedUp
    exposure: RGB  # what white of radiance 1 becomes in the picture, linear RGB


class ModelPass:
    """Draws opaque parts, then rims of cut-out ones, then blended ones, of all models that stand on the table."""

    def __init__(self, ctx: moderngl.Context, programs: Programs) -> None:
        self._ctx = ctx
        self._programs = programs

    def build_for(self, model: GpuModel, looked_up: Callable[[], LookedUp]) -> Iterator[None]:
        """Has the driver compile the model's shader variants, one each step, into the framebuffer that is bound then.

        A software rasteriser takes 100 ms for one that this machine has never drawn (later ones come from its disk).
        `looked_up` is asked at each step, as the quality may have changed since the last one.
        """
        for part in model.parts:
            for only in drawn_in(part):
                program = self._bound_program(part, looked_up(), only)
                set_uniforms(program, clip_from_marker=NOWHERE)
                self._ctx.enable_only(gl_flags(part.material))
                part.draw(program)
                yield

    def draw_opaque(self, standing: StandingGroup, inputs: ShadingInputs) -> None:
        """Draws opaque parts, and cut-out ones where they fill the whole pixel."""
        for member in standing.members:
            for part in member.model.parts:
                if part.material.alpha is not Alpha.BLEND:
                    self._ctx.enable_only(gl_flags(part.material))
                    self._draw(part, member, inputs)

    def draw_rims(self, standing: StandingGroup, inputs: ShadingInputs) -> None:
        """Draws cut-out parts where they fill part of the pixel, before what is behind them there.

        They hide nothing of one another, so that their order is of little weight, and nothing that is blended later.
        """
        self._ctx.blend_func = moderngl.ONE, moderngl.ONE_MINUS_SRC_ALPHA
        self._ctx.fbo.depth_mask = False
        for member in standing.members:
            for part in member.model.parts:
                if part.material.alpha is Alpha.CUT_OUT:
                    self._ctx.enable_only(gl_flags(part.material) | moderngl.BLEND)
                    self._draw(part, member, inputs, Only.RIM)
        self._ctx.fbo.depth_mask = True

    def draw_blended(self, standing: StandingGroup, inputs: ShadingInputs) -> None:
        """Draws blended parts, after everything behind them: first where they hide it, then where they are clear.

        Both far before near, and so the triangles of clear ones; of parts whose triangles keep their order back faces
        before front faces. Many files blend everything, for the sake of a few clear places.
        """
        eye = inputs.framing.eye_marker
        blended = [
            (float(np.linalg.norm(transform_points(member.marker_from_placed, part.centre[None]) - eye)), part, member)
            for member in standing.members
            for part in member.model.parts
            if part.material.alpha is Alpha.BLEND
        ]
        if not blended:
            return
        blended.sort(key=lambda each: -each[0])
        self._ctx.blend_func = moderngl.ONE, moderngl.ONE_MINUS_SRC_ALPHA
        for only in (Only.SOLID, Only.CLEAR):
            self._ctx.fbo.depth_mask = only is Only.SOLID
            for _, part, member in blended:
                if only in blended_in(part):
                    self._draw_faces(part, member, inputs, only)
        self._ctx.fbo.depth_mask = True
        self._ctx.cull_face = "back"

    def _draw_faces(self, part: GpuPart, standing: StandingModel, inputs: ShadingInputs, only: Only) -> None:
        # The walls of a glass are seen through one another, and leaves through the holes in their pictures.
        eye_placed = transform_points(standing.placed_from_marker, inputs.framing.eye_marker[None])[0]
        is_sorted = only is Only.CLEAR and part.sort(eye_placed)
        shows_all = is_sorted and part.material.double_sided
        self._ctx.enable_only(gl_flags(part.material) & ~(moderngl.CULL_FACE if shows_all else 0))
        for culled in ("front", "back") if part.material.double_sided and not is_sorted else ("back",):
            self._ctx.cull_face = culled
            self._draw(part, standing, inputs, only)

    def _draw(self, part: GpuPart, standing: StandingModel, inputs: ShadingInputs, only: Only | None = None) -> None:
        material = part.material
        program = self._bound_program(part, inputs.looked_up, only)
        set_uniforms(program, **layout_uniforms(part.mesh))
        set_uniforms(
            program,
            clip_from_marker=inputs.framing.clip_from_marker,
            marker_from_placed=standing.marker_from_placed,
            eye=tuple(inputs.framing.eye_marker),
            exposure=inputs.exposure,
            base_colour=material.base_colour,
            metallic=material.metallic,
            roughness=material.roughness,
            coat=material.coat,
            coat_roughness=material.coat_roughness,
            normal_scale=material.normal_scale,
            occlusion_strength=material.occlusion_strength,
            emissive=material.emissive,
            alpha_cutoff=material.alpha_cutoff,
            part_number=part.number * GOLDEN_SHARE % 1,
            sky=inputs.lighting.sky,
            sky_slope=inputs.lighting.sky_slope,
            ground_bounce=inputs.lighting.bounce,
            light_irradiance=inputs.lighting.irradiances,
            light_ground_share=inputs.lighting.ground_shares,
        )
        part.draw(program)

    def _bound_program(self, part: GpuPart, looked_up: LookedUp, only: Only | None) -> moderngl.Program:
        """The part's shader variant with all its textures bound: a driver may recompile for another kind of texture."""
        program = self._programs.get(
            "model/model",
            min_roughness=MIN_ROUGHNESS,
            **shading_constants(part),
            **only_constants(part, only),
            **looked_up.shadows.constants,
        )
        looked_up.shadows.bind(program)
        looked_up.ground_shadows.bind(program)
        looked_up.environment.bind(program)
        for name, texture in part.maps.items():
            texture.use(UNIT_OF[name])
        return program


def drawn_in(part: GpuPart) -> tuple[Only | None, ...]:
    """The places in which a part is drawn, one after the other; None: all of it at once."""
    if part.material.alpha is Alpha.BLEND:
        return blended_in(part)
    return (None, Only.RIM) if part.material.alpha is Alpha.CUT_OUT else (None,)


def blended_in(part: GpuPart) -> tuple[Only, ...]:
    """The same of a blended part."""
    if part.greatest_opacity < SOLID:
        return (Only.CLEAR,)
    return (Only.SOLID, Only.CLEAR) if part.has_clear_places else (Only.SOLID,)


def only_constants(part: GpuPart, only: Only | None) -> dict[str, float]:
    """Macros of the shader variant that draws these places alone."""
    is_divided = part.material.alpha is Alpha.BLEND and len(blended_in(part)) > 1
    return {
        "rim": only is Only.RIM,
        "solid": SOLID if is_divided else False,
        "is_solid": is_divided and only is Only.SOLID,
    }


def gl_flags(material: Material) -> int:
    """The OpenGL state for such a surface; the faces of a blended one are drawn in two passes."""
    if material.alpha is Alpha.BLEND:
        return moderngl.DEPTH_TEST | moderngl.CULL_FACE | moderngl.BLEND
    return moderngl.DEPTH_TEST | (0 if material.double_sided else moderngl.CULL_FACE)


def shading_constants(part: GpuPart) -> dict[str, bool]:
    """Macros of the part's shader variant."""
    material = part.material
    emits = material.emissive != BLACK
    return {
        **dict.fromkeys(part.maps, True),
        "emissive_map": emits and "emissive_map" in part.maps,
        material.alpha.name: material.alpha is not Alpha.OPAQUE,
        "vertex_colours": part.mesh.colours is not None,
        "rounded": part.is_rounded,
        "emits": emits,
        "unlit": emits and material.is_unlit,
        "glossy": not material.is_matt,
        "mirrors": material.is_mirror,
        "coated": material.coat > 0,
        "has_maps": bool(part.maps),
        **layout_constants(part.mesh),
    }
