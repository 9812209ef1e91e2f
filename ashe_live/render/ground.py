"""The shadow catcher: the part of the marker plane where the model takes light away from the video."""

import math

import cv2
import moderngl
import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.render.contact import FADE, ContactPatch
from ashe_live.render.framing import Framing
from ashe_live.render.geometry import GpuModel
from ashe_live.render.lighting import Lighting
from ashe_live.render.programs import build_program, set_uniforms
from ashe_live.render.shadow_map import ShadowMap
from ashe_live.render.video import Video

MAX_SHADOW_HEIGHTS = 30.0  # a shadow is drawn this many heights of the model long at most


class ShadowCatcher:
    """Multiplies the video, in linear light, where the model's shadow and its contact with the ground are."""

    def __init__(self, ctx: moderngl.Context, pcf_radius: int) -> None:
        self._ctx = ctx
        self._pcf_radius = pcf_radius
        self._program = build_program(ctx, "catcher", pcf_radius=pcf_radius, contact_fade=FADE)
        self._outline: tuple[GpuModel, bytes] | None = None
        self._buffer: moderngl.Buffer | None = None
        self._fan: moderngl.VertexArray | None = None
        self.polygon: Float = np.zeros((0, 3))  # (n, 3) convex, metres, marker frame

    def fit(self, model: GpuModel, lighting: Lighting, shadow: ShadowMap, contact: ContactPatch) -> None:
        """Finds the convex polygon of the plane that can be darkened, unless it is known."""
        key = lighting.to_light.tobytes() if lighting.has_sun else b""
        if self._outline is not None and self._outline[0] is model and self._outline[1] == key:
            return
        (x0, y0), (x1, y1) = contact.bounds
        points = np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)])
        if lighting.has_sun:
            points = np.concatenate([points, self._shadow_points(model.points, lighting.to_light, shadow.texel_m)])
        hull = cv2.convexHull(points.astype(np.float32)).reshape(-1, 2)
        self.polygon = np.column_stack([hull, np.zeros(len(hull))]).astype(np.float64)
        self.forget()
        self._buffer = self._ctx.buffer(np.ascontiguousarray(hull))
        self._fan = self._ctx.vertex_array(self._program, [(self._buffer, "2f", "in_position")])
        self._outline = (model, key)

    def draw(
        self, framing: Framing, video: Video, lighting: Lighting, shadow: ShadowMap, contact: ContactPatch
    ) -> None:
        """Draws behind the model's depth; nothing where the camera is below the plane."""
        if framing.eye_marker[2] <= 0 or self._fan is None:
            return
        self._ctx.enable_only(moderngl.DEPTH_TEST)
        # Behind a model that is flat on the ground.
        self._ctx.polygon_offset = 1.0, 1.0
        video.bind(0)
        shadow.bind(self._program, 1)
        contact.bind(self._program, 2)
        set_uniforms(
            self._program,
            clip_from_marker=framing.clip_from_marker,
            video=0,
            viewport=tuple(float(value) for value in framing.viewport),
            shadow_ratio=lighting.sky,
            has_sun=lighting.has_sun,
        )
        self._fan.render(moderngl.TRIANGLE_FAN)
        self._ctx.polygon_offset = 0.0, 0.0

    def forget(self) -> None:
        """Drops the outline, and with it the reference to the model."""
        self._outline = None
        if self._fan is not None and self._buffer is not None:
            self._fan.release()
            self._buffer.release()
        self._fan = self._buffer = None

    def release(self) -> None:
        self.forget()
        self._program.release()

    def _shadow_points(self, points: Float, to_light: Float, texel_m: float) -> Float:
        """(n, 2) where points (n, 3) cast their shadows, wider by what the filter blurs."""
        flat = math.hypot(to_light[0], to_light[1])
        slope = min(flat / to_light[2], MAX_SHADOW_HEIGHTS) / flat if flat > 0 else 0.0
        shadows = points[:, :2] - slope * points[:, 2:] * to_light[:2]
        blur = 2 * (self._pcf_radius + 1) * texel_m / max(to_light[2], 1 / MAX_SHADOW_HEIGHTS)
        corners = blur * np.array([(-1, -1), (-1, 1), (1, -1), (1, 1)])
        hull = cv2.convexHull(shadows.astype(np.float32)).reshape(-1, 2)
        return np.asarray(hull[:, None] + corners).reshape(-1, 2)
