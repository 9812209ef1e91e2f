"""The shadow catcher: the part of the marker plane that the models' shadows can darken."""

from dataclasses import dataclass
from typing import Any

import cv2
import moderngl
import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.render.cover.marker_cover import MarkerCover
from ashe_live.render.gl.programs import Programs, set_uniforms
from ashe_live.render.gl.texture_units import UNIT_OF
from ashe_live.render.lights.cast_shadows import LEAST_DISTANCE, MAX_SHADOW_HEIGHTS, shadow_hull
from ashe_live.render.lights.ground_shadows import GroundShadows
from ashe_live.render.lights.lighting import Lighting, ShadingLight
from ashe_live.render.lights.shadow_maps import ShadowMaps
from ashe_live.render.occlusion.walls import WallLight
from ashe_live.render.passes.model_pass import ShadingInputs
from ashe_live.render.passes.standing import StandingGroup, StandingModel
from ashe_live.render.passes.video import Video

LEAST_BORDER_PX = 0.2  # that is worth four looks at a shadow instead of one


@dataclass(frozen=True, slots=True, eq=False)
class CatchingGround:
    """The ground in the video, as the shadows on it need it."""

    video: Video  # as the framing's pinhole camera sees it
    lit_rgb: Float | None  # (3,) linear RGB where it is lit, if that is known
    cover: MarkerCover | None  # of the marker's sheet
    darkens: bool  # whether the models take light away from it
    # Standard deviation, pixels of the framebuffer, of the real shadow's border beyond what lens and light explain.
    border_px: float


class ShadowCatcher:
    """Multiplies the video, in linear light, where the models' shadows and their contact with the ground are."""

    def __init__(self, ctx: moderngl.Context, programs: Programs) -> None:
        self._ctx = ctx
        self._programs = programs
        self._fitted_for: tuple[StandingGroup, Lighting, bytes] | None = None
        self._buffer: moderngl.Buffer | None = None
        self._fans: dict[moderngl.Program, moderngl.VertexArray] = {}
        self._walls: list[WallLight] = []  # of each model
        self.polygon: Float = np.zeros((0, 3))  # (n, 3) convex, metres, marker frame

    def fit(self, models: StandingGroup, lighting: Lighting, shadows: ShadowMaps, covered: Float) -> None:
        """Computes the convex polygon of the plane that can be darkened, unless nothing has changed.

        `covered`: (n, 2) metres, corners of what else is drawn there.
        """
        key = covered.tobytes()
        known = self._fitted_for
        if known is not None and known[0] is models and known[1] is lighting and known[2] == key:
            return
        blur_m = shadows.blur_texels * shadows.texel_m
        cast = (_shadow_points(models.points, light, blur_m) for light in lighting.lights)
        points = np.concatenate([*(each.contact_corners for each in models.members), covered, *cast])
        hull = cv2.convexHull(points.astype(np.float32)).reshape(-1, 2)
        self.polygon = np.column_stack([hull, np.zeros(len(hull))]).astype(np.float64)
        self.forget()
        self._buffer = self._ctx.buffer(np.ascontiguousarray(hull))
        self._fitted_for = models, lighting, key

    def follow(self, models: StandingGroup, lighting: Lighting, shadows: GroundShadows) -> None:
        """Readies what depends on neither camera nor video. Leaves another framebuffer bound."""
        while len(self._walls) < len(models.members):
            self._walls.append(WallLight(self._ctx, self._programs))
        for walls, model in zip(self._walls, models.members, strict=False):
            walls.follow(model.contact, model.marker_from_placed, lighting, shadows)

    def draw(self, models: StandingGroup, inputs: ShadingInputs, ground: CatchingGround) -> None:
        """Draws behind the models' depth; nothing where the camera is below the plane."""
        lighting, shadows = inputs.lighting, inputs.looked_up.ground_shadows
        if inputs.framing.eye_marker[2] <= 0 or self._buffer is None:
            return
        groups = shadows.group_count
        casters = groups + inputs.looked_up.shadows.shadows_meet
        soft_border = ground.border_px >= LEAST_BORDER_PX
        constants = {**lighting.constants, "groups": groups, "casters": casters, "soft_border": soft_border}
        ground.video.bind()
        uniforms = _uniforms(inputs, ground) | {"outline_error": shadows.outline_errors}
        seen = shadows.seen_of_real if casters > groups else None
        if seen is not None and seen.lit_ground is not None and seen.shadow.ground is not None:
            constants["lit_ground"] = True
            seen.lit_ground.use(UNIT_OF["lit_ground"])
            uniforms["lit_bounds"] = tuple(map(float, seen.shadow.ground.bounds))
            uniforms["shadow_ratio"] = tuple(map(float, seen.shadow.ground.ratio))
        # Behind a model that is flat on the ground.
        self._ctx.polygon_offset = 1.0, 1.0
        self._ctx.enable_only(moderngl.DEPTH_TEST)
        first, *others = models.members
        program = self._programs.get("catchers/ground", covers=ground.cover is not None, **constants)
        if ground.cover is not None:
            ground.cover.bind(program)
        self._draw_fan(program, first, self._walls[0], shadows, uniforms)
        if others and ground.darkens:
            # What each lets through multiplies: 1 - (1 - removed) (1 - drawn).
            self._ctx.enable_only(moderngl.DEPTH_TEST | moderngl.BLEND)
            self._ctx.blend_func = moderngl.ONE, moderngl.ONE_MINUS_SRC_COLOR
            # On the polygon that has just been drawn.
            self._ctx.depth_func = "<="
            program = self._programs.get("catchers/ground", contact_alone=1, **constants)
            for model, walls in zip(others, self._walls[1:], strict=False):
                self._draw_fan(program, model, walls, shadows, uniforms)
            self._ctx.depth_func = "<"
        self._ctx.polygon_offset = 0.0, 0.0

    def _draw_fan(
        self,
        program: moderngl.Program,
        model: StandingModel,
        walls: WallLight,
        shadows: GroundShadows,
        uniforms: dict[str, Any],
    ) -> None:
        """Draws the polygon with the contact of one model."""
        shadows.bind(program)
        model.contact.bind(program)
        walls.bind()
        set_uniforms(
            program,
            placed_from_marker=model.placed_from_marker,
            marker_from_placed=model.marker_from_placed,
            model_albedo=tuple(model.model.albedo),
            **uniforms,
        )
        if program not in self._fans:
            self._fans[program] = self._ctx.vertex_array(program, [(self._buffer, "2f", "in_position")])
        self._fans[program].render(moderngl.TRIANGLE_FAN)

    def forget(self) -> None:
        """Drops the polygon, and the references to the models."""
        self._fitted_for = None
        for walls in self._walls:
            walls.forget()
        for fan in self._fans.values():
            fan.release()
        self._fans.clear()
        if self._buffer is not None:
            self._buffer.release()
        self._buffer = None

    def release(self) -> None:
        self.forget()
        for walls in self._walls:
            walls.release()
        self._walls.clear()


def _uniforms(inputs: ShadingInputs, ground: CatchingGround) -> dict[str, Any]:
    """Those of the ground that are the same for all models."""
    framing, lighting = inputs.framing, inputs.lighting
    return {
        "clip_from_marker": framing.clip_from_marker,
        "ground_bounce": lighting.bounce,
        "viewport": tuple(float(value) for value in framing.viewport),
        "ground_rgb": (0.0, 0.0, 0.0) if ground.lit_rgb is None else tuple(float(each) for each in ground.lit_rgb),
        "sky": lighting.sky,
        "sky_slope": lighting.sky_slope,
        "strength": 1.0 if ground.darkens else 0.0,
        "light_ground_share": lighting.ground_shares,
        "light_irradiance": lighting.irradiances,
        "border_px": ground.border_px,
    }


def _shadow_points(points: Float, light: ShadingLight, blur_m: float) -> Float:
    """(n, 2) hull of the shadows that points (n, 3) cast, widened by the penumbra and by the filter's blur."""
    hull = shadow_hull(points, light)
    # A texel grows with its distance from a lamp, relative to the caster's, and with the slant of the light.
    towards = light.towards(np.column_stack([hull, np.zeros(len(hull))]))
    distance = np.linalg.norm(towards, axis=1)
    sine = np.maximum(light.to_light[2] / distance, 1 / MAX_SHADOW_HEIGHTS)
    nearest = np.linalg.norm(light.towards(points), axis=1).min()
    blur = (blur_m * distance / np.maximum(nearest, LEAST_DISTANCE) / sine)[:, None, None]
    corners = blur * np.array([(-1, -1), (-1, 1), (1, -1), (1, 1)])
    return np.asarray(hull[:, None] + corners).reshape(-1, 2)
