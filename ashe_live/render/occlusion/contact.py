"""Contact: the share of the sky that the model hides from the ground around it, and in which direction.

It darkens the ground even without a sun; where the model's sides are lit, it tells how much of their light the ground
gets.
"""

import math
from collections.abc import Sequence

import cv2
import moderngl
import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float
from ashe_live.models.mesh import Mesh
from ashe_live.render.gl.geometry import GpuModel
from ashe_live.render.gl.programs import Programs, set_uniforms
from ashe_live.render.gl.rectangle import WholeRectangle
from ashe_live.render.gl.texture_units import UNIT_OF
from ashe_live.render.lights.shadow_maps import ShadowMaps
from ashe_live.render.occlusion.surface_samples import LEAST_AREA, samples_on

PATCH_SIZE = 140  # texels a side
# Standard deviations of Gaussians that merge the shadows of single directions: at the model in texels, and farther
# away, beside it or below, over the distance, which is half of the angle between neighbouring directions.
BLUR_TEXELS, SPREAD = 1.5, 0.2
POINTS = 4_000  # on the model, besides one on each triangle, to which that distance is measured
LEAST_BLUR_TEXELS = 0.1  # changes nothing, while OpenCV takes 0 for a width of its own choice
# Reach of the darkening beyond the model's bounds, in heights of the model. On lit ground it is limited, as pixels are
# drawn for its sake alone; in the model's own shadow it shows farther, as no sun outshines it.
REACH_HEIGHTS, REACH_IN_SHADOW = 1.0, 1.5
MIN_HEIGHT_RATIO = 0.1  # least height for that purpose, over the model's width
FADES_FROM = 0.5  # share of the reach from which the darkening fades to nothing


class ContactPatch:
    """A texture of the ground around a model: hidden share of the sky, and its mean direction's x and y times that.

    All of these are as far as they count in the model's shadow; the fourth channel is the part of them that counts on
    lit ground.
    """

    def __init__(self, ctx: moderngl.Context, programs: Programs, model: GpuModel) -> None:
        lower, upper = model.placed.bounds
        self._height = max(float(upper[2]), MIN_HEIGHT_RATIO * float((upper - lower)[:2].max()))
        reach = REACH_IN_SHADOW * self._height
        # (2, 2) least, largest x, y; metres, the model's own frame, before it is moved by hand
        self.bounds: Float = np.array([lower[:2] - reach, upper[:2] + reach])
        self._texel = float((self.bounds[1] - self.bounds[0]).max()) / PATCH_SIZE
        # No wider than the model is high: beside what is flat nothing is hidden.
        self._blur_texels = float(np.clip(upper[2] / self._texel, LEAST_BLUR_TEXELS, BLUR_TEXELS))
        self.model_bounds: Float = np.array([lower, upper])  # (2, 3) likewise
        self._programs = programs
        self._rectangle = WholeRectangle(ctx)
        self._texture = ctx.texture((PATCH_SIZE, PATCH_SIZE), 4, dtype="f2")
        self._texture.repeat_x = self._texture.repeat_y = False
        self._framebuffer = ctx.framebuffer([self._texture])
        self._framebuffer.clear()

    @property
    def corners(self) -> Float:
        """(8, 2) metres, the model's own frame: an octagon around the lit ground within reach of the model's bounds."""
        reach = REACH_HEIGHTS * self._height
        (x0, y0), (x1, y1) = self.model_bounds[0, :2] - reach, self.model_bounds[1, :2] + reach
        cut = (2 - math.sqrt(2)) * reach
        sides = [(x0 + cut, y0), (x1 - cut, y0), (x1, y0 + cut), (x1, y1 - cut)]
        return np.array([*sides, *((x0 + x1 - x, y0 + y1 - y) for x, y in sides)])

    def add(self, depth_map: ShadowMaps, weight: float) -> None:
        """Adds what the model hides of the directions, above the horizon, from which `depth_map` shows it.

        weight: of a direction straight above, as a share of the sky; others have it times their sine.
        """
        constants = depth_map.constants
        if not constants["dithered"]:
            constants["blocker_taps"] = 0  # `smoothed` makes these shadows soft
        program = self._programs.get("occlusion/contact", **constants)
        depth_map.bind(program)
        points = np.zeros(int(constants["lights"]))
        # All patches share one program: another may have used it between two steps.
        set_uniforms(program, weight=weight, patch_bounds=tuple(self.bounds.ravel()), tan_half_size=points)
        self._rectangle.fill(self._framebuffer, program, adds=True)

    def smoothed(self, distances: Float) -> NDArray[np.float16]:
        """(PATCH_SIZE, PATCH_SIZE, 4) what the patch is to hold, once every direction of the sky has been added.

        `distances`: (PATCH_SIZE, PATCH_SIZE) metres from each place to the model.
        """
        halves = np.frombuffer(self._texture.read(), dtype=np.float16).reshape(PATCH_SIZE, PATCH_SIZE, 4)
        occlusion = halves.astype(np.float32)
        away = self._away()
        doublings = np.log2(np.maximum(SPREAD * distances / (self._texel * self._blur_texels), 1.0))
        smooth = np.zeros_like(occlusion)
        for doubling in range(int(np.ceil(doublings.max())) + 1):
            sigma = self._blur_texels * 2**doubling
            blurred = cv2.GaussianBlur(occlusion, (0, 0), sigma, borderType=cv2.BORDER_REPLICATE)
            smooth += np.maximum(1 - np.abs(doublings - doubling), 0.0)[..., None] * blurred
        on_lit_ground, in_shadow = (self._left(away, each) for each in (REACH_HEIGHTS, REACH_IN_SHADOW))
        smooth[..., :3] *= in_shadow[..., None]
        smooth[..., 3] = on_lit_ground / np.maximum(in_shadow, 1e-6)
        return smooth.astype(np.float16)

    def _left(self, away: Float, reach: float) -> Float:
        """Share of the darkening left `away` from the model's bounds if it ends at `reach`, in heights of the model."""
        left = np.clip((1 - away / (reach * self._height)) / (1 - FADES_FROM), 0.0, 1.0)
        return np.asarray(left**2 * (3 - 2 * left))

    def _away(self) -> Float:
        """(PATCH_SIZE, PATCH_SIZE) metres from the model's bounds; rows along y."""
        shares = (np.arange(PATCH_SIZE)[:, None] + 0.5) / PATCH_SIZE
        places = self.bounds[0] + shares * (self.bounds[1] - self.bounds[0])
        beyond = np.maximum(np.maximum(self.model_bounds[0, :2] - places, places - self.model_bounds[1, :2]), 0.0)
        return np.asarray(np.hypot(beyond[None, :, 0], beyond[:, None, 1]))

    def distances(self, meshes: Sequence[Mesh]) -> Float:
        """(PATCH_SIZE, PATCH_SIZE) metres from places of the ground to the model's `meshes`, at rest; rows along y."""
        size = self.bounds[1] - self.bounds[0]
        per_area = POINTS / max(sum(float(mesh.areas.sum()) for mesh in meshes), LEAST_AREA)
        points = np.concatenate([samples_on(mesh, per_area).places_and_normals()[0] for mesh in meshes])
        texels = (points[:, :2] - self.bounds[0]) / size * PATCH_SIZE
        columns, rows = texels.clip(0, PATCH_SIZE - 1).astype(int).T
        squared = np.full((PATCH_SIZE, PATCH_SIZE), np.inf)
        np.minimum.at(squared, (rows, columns), np.square(points[:, 2].astype(np.float64)))
        # The least over a row's places, then over a column's: squares of distances along both axes add up.
        between = np.square(np.subtract.outer(np.arange(PATCH_SIZE), np.arange(PATCH_SIZE)) / PATCH_SIZE)
        for side_m in size:
            squared = np.array([(side_m**2 * between + line).min(axis=1) for line in squared]).T
        return np.asarray(np.sqrt(squared))

    def fill(self, smooth: NDArray[np.float16]) -> None:
        """Has it hold what `smoothed` gave."""
        self._texture.write(np.ascontiguousarray(smooth))

    def bind(self, program: moderngl.Program) -> None:
        """Gives `program` the patch and where it is."""
        self._texture.use(UNIT_OF["contact"])
        set_uniforms(program, patch_bounds=tuple(self.bounds.ravel()))

    def release(self) -> None:
        for held in (self._framebuffer, self._texture, self._rectangle):
            held.release()
