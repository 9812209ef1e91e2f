"""The light that the ground throws onto the sides of a model, as far as these are seen from the ground around it."""

import moderngl

from ashe_live.core.arrays import Float, same_objects
from ashe_live.render.gl.canvas import Canvas
from ashe_live.render.gl.programs import Programs, set_uniforms
from ashe_live.render.gl.rectangle import WholeRectangle
from ashe_live.render.lights.ground_shadows import GroundShadows
from ashe_live.render.lights.lighting import Lighting
from ashe_live.render.occlusion.contact import PATCH_SIZE, ContactPatch


class WallLight:
    """The light on one model's walls, in a texture over its contact patch; drawn again when anything of it changes."""

    def __init__(self, ctx: moderngl.Context, programs: Programs) -> None:
        self._programs = programs
        self._canvas = Canvas(ctx, 4, "f4")
        self._rectangle = WholeRectangle(ctx)
        self._drawn_for: tuple[object, ...] = ()

    def follow(
        self, contact: ContactPatch, marker_from_placed: Float, lighting: Lighting, shadows: GroundShadows
    ) -> None:
        """`marker_from_placed`: (4, 4), where the model stands. Leaves another framebuffer bound."""
        wanted = contact, marker_from_placed, lighting, shadows.content
        if same_objects(self._drawn_for, wanted):
            return
        self._drawn_for = wanted
        groups = shadows.group_count
        program = self._programs.get("occlusion/walls", groups=groups, casters=groups, **lighting.constants)
        shadows.bind(program)
        contact.bind(program)
        set_uniforms(
            program,
            marker_from_placed=marker_from_placed,
            model_bounds=tuple(contact.model_bounds[:, :2].ravel()),
            model_height=float(contact.model_bounds[1, 2]),
            ground_bounce=lighting.bounce,
            light_ground_share=lighting.ground_shares,
        )
        self._rectangle.fill(self._canvas.of_size((PATCH_SIZE, PATCH_SIZE)), program)

    def bind(self) -> None:
        """For programs that read it as `walls`."""
        self._canvas.of_size((PATCH_SIZE, PATCH_SIZE))
        self._canvas.bind("walls")

    def forget(self) -> None:
        """Drops the reference to the model."""
        self._drawn_for = ()

    def release(self) -> None:
        self.forget()
        self._canvas.release()
        self._rectangle.release()
