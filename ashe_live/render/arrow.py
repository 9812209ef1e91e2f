"""The light overlay: an arrow that flies from the light to the model."""

import moderngl
import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.transforms import inverse_rigid, light_view
from ashe_live.models.primitives import revolved
from ashe_live.render.framing import Framing
from ashe_live.render.programs import build_program, set_uniforms

# Radius and height of a unit arrow, its point at the origin and its tail along +z.
PROFILE = ((0.0, 0.0), (0.11, 0.3), (0.04, 0.3), (0.04, 1.0), (0.0, 1.0))
COLOUR_SRGB = (1.0, 0.9, 0.45)
LENGTH_RADII = 1.1  # the arrow's length in radii of the model
GAP_RADII = 1.05  # from the model's centre to the point


class LightArrow:
    def __init__(self, ctx: moderngl.Context) -> None:
        self._ctx = ctx
        self._program = build_program(ctx, "arrow")
        mesh = revolved(PROFILE, segments=24)
        self._buffer = ctx.buffer(np.hstack([mesh.vertices, mesh.normals]))
        self._indices = ctx.buffer(mesh.triangles)
        layout = [(self._buffer, "3f 3f", "in_position", "in_normal")]
        self._arrow = ctx.vertex_array(self._program, layout, self._indices)

    def draw(self, framing: Framing, marker_from_arrow: Float) -> None:
        self._ctx.enable_only(moderngl.DEPTH_TEST)
        set_uniforms(
            self._program,
            clip_from_marker=framing.clip_from_marker,
            marker_from_arrow=marker_from_arrow,
            eye=tuple(framing.eye_marker),
            encoded_colour=COLOUR_SRGB,
        )
        self._arrow.render()

    def release(self) -> None:
        for held in (self._arrow, self._buffer, self._indices, self._program):
            held.release()


def arrow_placement(corners: Float, to_light: Float) -> Float:
    """(4, 4) marker frame from the unit arrow, beside a model in a box of `corners` (8, 3), from a light."""
    centre = corners.mean(axis=0)
    radius = float(np.linalg.norm(corners - centre, axis=1).max())
    placement = inverse_rigid(light_view(to_light))
    placement[:3, :3] *= LENGTH_RADII * radius
    placement[:3, 3] = centre + GAP_RADII * radius * to_light
    return placement


def arrow_extent(placement: Float) -> Float:
    """(8, 3) corners of a box around the placed arrow, in the marker frame."""
    width = PROFILE[1][0]
    corners = np.array([(x, y, z) for x in (-width, width) for y in (-width, width) for z in (0.0, 1.0)])
    return np.asarray(corners @ placement[:3, :3].T + placement[:3, 3])
