"""The lit ground under a lamp: its slow shading is the fall of the lamp's light, which no quadratic follows.

Without that the palette takes the steps of a plain ground's brightness for its colours. It is then wide enough to hold
shadows where the lamp's light is faint, and too narrow for the corners of the picture, which stand out as objects do.
"""

from ashe_live.light.ground.lit_ground import LitGround, fit_lit_ground, unlit_mask
from ashe_live.light.ground.slow_shading import LightFall
from ashe_live.light.ground.steps import GroundSteps
from ashe_live.light.lamps.agreement import SHARE, UNEVEN_DEVIANCE, FallDirections, fall_of_light
from ashe_live.light.lamps.fall_off import clear_of
from ashe_live.light.lamps.kinds import SUN
from ashe_live.light.pixels.view import View

LEAST_PX = 40  # of what stands out from the ground: specks are texture


def lit_ground_of(view: View, steps: GroundSteps, kind: str) -> LitGround | None:
    """The lit ground of a view, as `fit_lit_ground`, in the light of a lamp where the fall of light asks for one.

    kind: one of KINDS.
    """
    ground = fit_lit_ground(view.image_bgr, view.is_ground, steps)
    if ground is None or kind == SUN:
        return ground
    fall = _fall_of_light(view, ground)
    return ground if fall is None else fit_lit_ground(view.image_bgr, view.is_ground, steps, fall) or ground


def _fall_of_light(view: View, ground: LitGround) -> LightFall | None:
    """That of the lamp which explains the brightness of the lit ground best; None where a sun may have caused it."""
    fall_off = fall_of_light(view, ground, clear_of(unlit_mask(ground, view.is_ground, LEAST_PX)))
    if fall_off is None:
        return None
    directions = FallDirections(fall_off)
    light, deviance = directions.likeliest
    if deviance < UNEVEN_DEVIANCE:
        return None
    if light[2] > 0:
        light = directions.sharpened(light)
    return LightFall.of(view, light, SHARE, directions.reference, None if light[2] > 0 else fall_off.gloss)
