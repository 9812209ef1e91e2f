"""What is drawn into the layers of added and removed light, one pass after the other."""

from dataclasses import dataclass

import moderngl

from ashe_live.core.light import Light
from ashe_live.core.proxy import Proxy
from ashe_live.core.types import TrackedFrame
from ashe_live.render.cover.marker_cover import MarkerCover
from ashe_live.render.gl.programs import Programs
from ashe_live.render.occlusion.drawn_body_maker import DrawnBodyMaker
from ashe_live.render.passes.ground import CatchingGround, ShadowCatcher
from ashe_live.render.passes.light_sign import LightSign, LightSigns
from ashe_live.render.passes.model_pass import ModelPass, ShadingInputs
from ashe_live.render.passes.real_object import RealObject
from ashe_live.render.passes.standing import StandingGroup
from ashe_live.render.scene import Scene


@dataclass(frozen=True, slots=True, eq=False)
class LayerContent:
    """The content of one picture's layers."""

    models: StandingGroup
    inputs: ShadingInputs
    shows_model: bool  # the models themselves, and not their shadows alone
    casts_shadow: bool  # the models, on whatever is real
    signs: tuple[LightSign, ...]
    ground: CatchingGround | None  # None: neither shadows nor a cover lie on it


class LayerPasses:
    """Real object, model, lights' signs and ground, in the order in which depth and blending want them."""

    def __init__(self, ctx: moderngl.Context, programs: Programs, cover: MarkerCover | None) -> None:
        """`cover`: of the window beside which this draws; None: its own."""
        self._ctx = ctx
        self._light_signs = LightSigns(ctx)
        self.model_pass = ModelPass(ctx, programs)
        self.catcher = ShadowCatcher(ctx, programs)
        self.cover = MarkerCover(ctx) if cover is None else cover
        self._is_beside = cover is not None
        self.real: RealObject | None = None
        self._drawn_bodies = DrawnBodyMaker()
        self._programs = programs

    def follow_real_object(
        self, proxy: Proxy | None, seen_in: TrackedFrame | None, lights: tuple[Light, ...], waits: bool
    ) -> bool:
        """Readies the real object that is there now; whether there was another one. `seen_in`, `lights`: `read_body`.

        `waits`: for its outline and shadows, if they take long; else the former one stays until they are found.
        """
        former = self.real
        if former is not None and former.proxy is proxy and former.seen_in is seen_in:
            return False
        real = None
        if proxy is not None:
            read = self._drawn_bodies.body(proxy, seen_in, lights, waits)
            if read is None:
                return False
            real = RealObject(self._ctx, self._programs, proxy, seen_in, read)
        self.real = real
        if former is not None:
            former.release()
        return former is not None

    def follow_sheet(self, scene: Scene, waits: bool) -> MarkerCover | None:
        """The cover of the marker's sheet, once there is one. `waits`: as in `MarkerCover.follow`.

        One that is not shown for a while is kept, so that it is there at once when it is wanted again.
        """
        if not scene.shows_cover or scene.tracked is None:
            return None
        follow = self.cover.follow_beside if self._is_beside else self.cover.follow
        follow(scene.tracked, scene.lit_in_video or scene.illumination, waits)
        return self.cover if len(self.cover.corners) else None

    def draw(self, content: LayerContent, with_models: bool = True, with_ground: bool = True) -> None:
        """Without models and their signs, which are then drawn later, or without ground that was drawn before."""
        models, inputs = content.models, content.inputs
        frame = inputs.framing
        self._ctx.viewport = frame.viewport
        if self.real is not None:
            looked_up = inputs.looked_up
            self.real.draw(frame, inputs.lighting, looked_up.shadows, looked_up.ground_shadows, content.casts_shadow)
        shows_model = content.shows_model and with_models
        if shows_model:
            self.model_pass.draw_opaque(models, inputs)
        for sign in content.signs if with_models else ():
            self._light_signs.draw(frame, sign)
        if content.ground is not None and with_ground:
            self.catcher.draw(models, inputs, content.ground)
        if shows_model:
            self.model_pass.draw_rims(models, inputs)
            self.model_pass.draw_blended(models, inputs)

    def release(self) -> None:
        self.follow_real_object(None, None, (), waits=True)
        self._drawn_bodies.release()
        self.catcher.release()
        if not self._is_beside:
            self.cover.release()
        self._light_signs.release()
