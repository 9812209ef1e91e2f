"""The shadow catcher: the part of the marker plane that the model's shadow can darken."""

import cv2
import moderngl
import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.render.cover.hidden_marker import HiddenMarker
from ashe_live.render.gl.framing import Framing
from ashe_live.render.gl.programs import Programs, set_uniforms
from ashe_live.render.lights.cast_shadows import LEAST_DISTANCE, MAX_SHADOW_HEIGHTS, shadow_hull
from ashe_live.render.lights.ground_shadows import GroundShadows
from ashe_live.render.lights.lighting import Lighting, Sun
from ashe_live.render.lights.shadow_maps import ShadowMaps
from ashe_live.render.passes.contact import FADE
from ashe_live.render.passes.standing import StandingModel
from ashe_live.render.passes.video import Video

LEAST_BORDER_PX = 0.2  # that is worth four looks at a shadow instead of one


class ShadowCatcher:
    """Multiplies the video, in linear light, where the model's shadow and its contact with the ground are."""

    def __init__(self, ctx: moderngl.Context, programs: Programs) -> None:
        self._ctx = ctx
        self._programs = programs
        self._outline: tuple[StandingModel, Lighting, bytes] | None = None
        self._buffer: moderngl.Buffer | None = None
        self._fan: tuple[moderngl.Program, moderngl.VertexArray] | None = None
        self.polygon: Float = np.zeros((0, 3))  # (n, 3) convex, metres, marker frame

    def fit(self, model: StandingModel, lighting: Lighting, shadows: ShadowMaps, covered: Float) -> None:
        """Computes the convex polygon of the plane that can be darkened, unless nothing has changed.

        `covered`: (n, 2) metres, corners of what else is drawn there.
        """
        key = covered.tobytes()
        if self._outline is not None and self._outline[0] is model and self._outline[1:] == (lighting, key):
            return
        blur_m = shadows.blur_texels * shadows.texel_m
        shadows_of_suns = (_shadow_points(model.points, sun, blur_m) for sun in lighting.suns)
        points = np.concatenate([model.contact_corners, covered, *shadows_of_suns])
        hull = cv2.convexHull(points.astype(np.float32)).reshape(-1, 2)
        self.polygon = np.column_stack([hull, np.zeros(len(hull))]).astype(np.float64)
        self.forget()
        self._buffer = self._ctx.buffer(np.ascontiguousarray(hull))
        self._outline = (model, lighting, key)

    def draw(
        self,
        framing: Framing,
        video: Video,
        lighting: Lighting,
        shadows: GroundShadows,
        casters: int,
        model: StandingModel,
        ground_rgb: Float | None,
        hidden: HiddenMarker | None,
        darkens: bool,
        border_px: float,
    ) -> None:
        """Draws behind the model's depth; nothing where the camera is below the plane.

        `ground_rgb`: (3,) linear RGB of the lit ground in the video, where that is known. `hidden`: what covers the
        marker's sheet. `darkens`: whether the model takes light away. `border_px`: standard deviation, pixels of the
        framebuffer, of the real shadow's border beyond what lens and sun explain.
        """
        if framing.eye_marker[2] <= 0 or self._buffer is None:
            return
        constants = lighting.constants | ({} if hidden is None else {"covers": 1})
        if border_px >= LEAST_BORDER_PX:
            constants |= {"soft_border": 1}
        program = self._programs.get("catcher", contact_fade=FADE, casters=casters, **constants)
        self._ctx.enable_only(moderngl.DEPTH_TEST)
        # Behind a model that is flat on the ground.
        self._ctx.polygon_offset = 1.0, 1.0
        video.bind()
        shadows.bind(program)
        model.contact.bind(program)
        if hidden is not None:
            hidden.bind(program)
        set_uniforms(
            program,
            clip_from_marker=framing.clip_from_marker,
            placed_from_marker=model.placed_from_marker,
            marker_from_placed=model.marker_from_placed,
            model_albedo=tuple(model.model.albedo),
            ground_bounce=lighting.bounce,
            viewport=tuple(float(value) for value in framing.viewport),
            ground_rgb=(0.0, 0.0, 0.0) if ground_rgb is None else tuple(float(value) for value in ground_rgb),
            sky=lighting.sky,
            strength=1.0 if darkens else 0.0,
            sun_on_ground=lighting.ground_shares,
            sun=lighting.irradiances,
            border_px=border_px,
        )
        self._fan_of(program).render(moderngl.TRIANGLE_FAN)
        self._ctx.polygon_offset = 0.0, 0.0

    def forget(self) -> None:
        """Drops the polygon, and with it the reference to the model."""
        self._outline = None
        if self._fan is not None:
            self._fan[1].release()
        if self._buffer is not None:
            self._buffer.release()
        self._fan = self._buffer = None

    def _fan_of(self, program: moderngl.Program) -> moderngl.VertexArray:
        if self._fan is None or self._fan[0] is not program:
            if self._fan is not None:
                self._fan[1].release()
            self._fan = program, self._ctx.vertex_array(program, [(self._buffer, "2f", "in_position")])
        return self._fan[1]


def _shadow_points(points: Float, sun: Sun, blur_m: float) -> Float:
    """(n, 2) hull of the shadows that points (n, 3) cast, widened by the penumbra and by the filter's blur."""
    hull = shadow_hull(points, sun)
    # A texel grows with its distance from a lamp, relative to the caster's, and with the slant of the light.
    towards = sun.towards(np.column_stack([hull, np.zeros(len(hull))]))
    distance = np.linalg.norm(towards, axis=1)
    sine = np.maximum(sun.to_light[2] / distance, 1 / MAX_SHADOW_HEIGHTS)
    nearest = np.linalg.norm(sun.towards(points), axis=1).min()
    blur = (blur_m * distance / np.maximum(nearest, LEAST_DISTANCE) / sine)[:, None, None]
    corners = blur * np.array([(-1, -1), (-1, 1), (1, -1), (1, 1)])
    return np.asarray(hull[:, None] + corners).reshape(-1, 2)
