"""The light overlay: an arrow that flies from the light to the model, or a bulb where a lamp in view is."""

from dataclasses import dataclass

import moderngl
import numpy as np

from ashe_live.core.arrays import Float, box_corners
from ashe_live.core.camera import Camera
from ashe_live.core.light import Light
from ashe_live.core.transforms import inverse_rigid, light_view, normalised, transform_points
from ashe_live.models.primitives import revolved
from ashe_live.render.camera.in_frame import project_distorted
from ashe_live.render.gl.framing import Framing
from ashe_live.render.gl.programs import build_program, set_uniforms
from ashe_live.render.lights.lighting import angular_size

# Radius and height of a unit arrow, its point at the origin and its tail along +z.
ARROW = ((0.0, 0.0), (0.11, 0.3), (0.04, 0.3), (0.04, 1.0), (0.0, 1.0))
# And of a bulb: a ball of radius 1 around the origin, from pole to neck, and its base along +z.
BALL = tuple((np.cos(tilt), np.sin(tilt)) for tilt in np.radians((-90, -65, -40, -15, 10, 35, 58)))
BULB = (*BALL, (0.45, 1.25), (0.45, 1.9), (0.25, 2.1), (0.0, 2.1))
COLOUR_SRGB = (1.0, 0.9, 0.45)
LENGTH_RADII = 1.1  # the arrow's length in radii of the model
GAP_RADII = 1.05  # from the model's centre to the point
# A bulb is as large as the lamp, but no smaller than the first share of the model's radius, so that it is seen, and no
# larger than the second of its distance from the camera, so that the rest is.
SMALLEST_BULB_RADII, LARGEST_BULB = 0.15, 0.1


@dataclass(frozen=True, slots=True, eq=False)
class LightSign:
    """One of the two shapes at its place."""

    profile: tuple[tuple[float, float], ...]  # ARROW or BULB
    marker_from_sign: Float  # (4, 4) a similarity

    @property
    def corners(self) -> Float:
        """(8, 3) of a box around it, metres, marker frame."""
        radius, heights = max(r for r, _ in self.profile), [height for _, height in self.profile]
        box = box_corners(np.array([(-radius, -radius, min(heights)), (radius, radius, max(heights))]))
        return transform_points(self.marker_from_sign, box)


class LightSigns:
    """Both shapes on the graphics card."""

    def __init__(self, ctx: moderngl.Context) -> None:
        self._ctx = ctx
        self._program = build_program(ctx, "screen/light_sign")
        self._held: list[moderngl.Buffer] = []
        self._shapes = {profile: self._uploaded(profile) for profile in (ARROW, BULB)}

    def draw(self, framing: Framing, sign: LightSign) -> None:
        self._ctx.enable_only(moderngl.DEPTH_TEST)
        set_uniforms(
            self._program,
            clip_from_marker=framing.clip_from_marker,
            marker_from_sign=sign.marker_from_sign,
            eye=tuple(framing.eye_marker),
            encoded_colour=COLOUR_SRGB,
        )
        self._shapes[sign.profile].render()

    def release(self) -> None:
        for shape in self._shapes.values():
            shape.release()
        for buffer in self._held:
            buffer.release()
        self._program.release()

    def _uploaded(self, profile: tuple[tuple[float, float], ...]) -> moderngl.VertexArray:
        mesh = revolved(profile, segments=24)
        vertices = self._ctx.buffer(np.hstack([mesh.vertices, mesh.normals]))
        indices = self._ctx.buffer(mesh.triangles)
        self._held += [vertices, indices]
        return self._ctx.vertex_array(self._program, [(vertices, "3f 3f", "in_position", "in_normal")], indices)


def light_sign(corners: Float, light: Light, camera: Camera, T_cam_marker: Float) -> LightSign:
    """For a model in a box of `corners` (8, 3): a bulb if the lamp is in the picture by the lens of `camera`."""
    centre = corners.mean(axis=0)
    radius = float(np.linalg.norm(corners - centre, axis=1).max())
    lamp = light.position_marker_m
    if lamp is not None and _is_in_picture(lamp, camera, T_cam_marker):
        from_eye = float(np.linalg.norm(transform_points(T_cam_marker, lamp[None])))
        bulb = np.tan(angular_size(light) / 2) / light.inverse_distance
        size = min(max(float(bulb), SMALLEST_BULB_RADII * radius), LARGEST_BULB * from_eye)
        return LightSign(BULB, _placed(size, lamp, light.to_light_marker))
    to_light = light.to_light_marker - light.inverse_distance * centre
    to_light = normalised(to_light) if np.linalg.norm(to_light) > 0 else light.to_light_marker
    return LightSign(ARROW, _placed(LENGTH_RADII * radius, centre + GAP_RADII * radius * to_light, to_light))


def _is_in_picture(point: Float, camera: Camera, T_cam_marker: Float) -> bool:
    (pixel,) = project_distorted(camera, T_cam_marker, point[None])
    return bool((pixel >= -0.5).all() and (pixel <= np.array(camera.size) - 0.5).all())


def _placed(scale: float, origin: Float, up: Float) -> Float:
    """(4, 4) marker frame from a shape whose +z is to point along `up`."""
    placement = inverse_rigid(light_view(up))
    placement[:3, :3] *= scale
    placement[:3, 3] = origin
    return placement
