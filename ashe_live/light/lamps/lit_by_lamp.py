"""The lit ground under a lamp: its slow shading is the fall of the lamp's light, which no quadratic follows.

Without that the palette takes the steps of a plain ground's brightness for its colours. It is then wide enough to hold
shadows where the lamp's light is faint, and too narrow for the picture's corners, which are then taken for objects.
What glossy ground mirrors of a sun is estimated and taken out in the same way.
"""

from dataclasses import replace

from ashe_live.core.arrays import Mask
from ashe_live.light.ground.broad_areas import with_broad_areas
from ashe_live.light.ground.lit_ground import LitGround, fit_lit_ground, unlit_mask
from ashe_live.light.ground.preset import GroundPreset
from ashe_live.light.ground.slow_shading import LightFall
from ashe_live.light.lamps.fall.fall_directions import SHARE, UNEVEN_DEVIANCE, FallDirections, with_gloss
from ashe_live.light.lamps.fall.fall_off import FallOff
from ashe_live.light.lamps.fall.lit_samples import clear_of
from ashe_live.light.lamps.kinds import SUN
from ashe_live.light.pixels.view import View

LEAST_PX = 40  # of an unlit area: specks are texture


def lit_ground_of(view: View, preset: GroundPreset, kind: str) -> LitGround | None:
    """The lit ground of a view, as `fit_lit_ground`, in the light of a lamp, or of gloss where it asks for one.

    With the areas that are too broad for its joints. kind: one of KINDS. Plain ground, by a clean plate, has no fall of
    light any more: that is in the ground as the camera took it.
    """
    if view.taken is not None:
        taken, plain = lit_ground_of(view.taken, preset, kind), fit_lit_ground(view.image_bgr, view.is_ground, preset)
        return None if plain is None else replace(plain, taken=taken)
    ground = _ground_in_its_light(view, preset, kind)
    return None if ground is None else with_broad_areas(ground, view)


def _ground_in_its_light(view: View, preset: GroundPreset, kind: str) -> LitGround | None:
    """As `lit_ground_of`, without these areas."""
    ground = fit_lit_ground(view.image_bgr, view.is_ground, preset)
    if ground is None or kind == SUN:
        return ground
    free = clear_of(unlit_mask(ground, view.is_ground, LEAST_PX))
    fall = _fall_of_light(view, ground, free)
    if fall is None:
        return ground
    divided = replace(ground, divided=True)
    if fall.light[2] > 0 and _fall_of_light(view, divided, free) is None:
        return divided
    return fit_lit_ground(view.image_bgr, view.is_ground, preset, fall) or ground


def lit_ground_beside(first: LitGround, view: View, preset: GroundPreset, kind: str) -> LitGround | None:
    """The lit ground of another view of the scene that `first` is the ground of; as `lit_ground_of`, at less cost.

    Whether light falls off over a table, or its gloss shows, depends on the scene more than on who looks: where the
    first view does not ask for it, it is not looked for in others.
    """
    first = first.taken or first
    if first.fall is None and not first.divided:
        kind = SUN
    return lit_ground_of(view, preset, kind)


def _fall_of_light(view: View, ground: LitGround, free: Mask) -> LightFall | None:
    """That of the light that explains the lit ground's brightness best; None where that may be lit alike all over."""
    fall_off = FallOff.of(view, ground, free)
    if fall_off is None:
        return None
    directions = FallDirections(with_gloss(fall_off))
    light, deviance = directions.likeliest
    if deviance < UNEVEN_DEVIANCE:
        return None
    return LightFall.of(view, light, SHARE, directions.reference, directions.fall_off.gloss)
