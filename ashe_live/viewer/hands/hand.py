"""Light and model set by hand, in place of the estimate."""

import math
from dataclasses import dataclass, replace

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.colour import REC709_LUMINANCE
from ashe_live.core.light import Illumination, Light
from ashe_live.core.transforms import angles_from_direction, direction_from_angles
from ashe_live.core.types import TrackedFrame
from ashe_live.light.live.moved_marker import FixedInRoom
from ashe_live.models.placement import UNMOVED, PlacedModel, Placement
from ashe_live.render.beside import picture_axes
from ashe_live.render.lights.lighting import SUN_ANGULAR_SIZE_RAD, angular_size, ground_ratio
from ashe_live.viewer.hands.pointing import Pixel, ground_at, pixel_of
from ashe_live.viewer.hands.requests import Command, Drag, Request
from ashe_live.viewer.hands.shadow_end import LOWEST_RAD, light_through, shadow_of

# What one key press, or one notch of the wheel, changes.
LIGHT_STEP_RAD = math.radians(2)
TURN_STEP_RAD = math.radians(5)
SCALE_STEP = 1.1
MOVE_STEP_SIDES = 0.05
# Largest elevation: keys stop before the zenith, where the azimuth would be undefined.
HIGHEST_RAD = math.radians(89)
SMALLEST, LARGEST = 0.1, 5.0  # the model's scale: a camera at arm's length would be inside a larger one
MOST_NOTCHES = 20.0
FARTHEST_SIDES = 50.0
# A light that nobody has estimated comes from the left of the picture, at this height.
FIRST_ELEVATION_RAD = math.radians(45)
# Factors of one key press on the light's angular size, its shadow's depth, and that of red over blue; their limits.
SOFTER_STEP, STRONGER_STEP, WARMER_STEP = 1.25, 1.15, 1.08
SHARPEST_RAD, SOFTEST_RAD = math.radians(0.1), math.radians(40)
FAINTEST = 0.03
# Factor of one notch on a lamp's distance; its limits, in sides of the marker: beyond the farthest it is a sun.
FARTHER_STEP = 1.1
NEAREST_LAMP_SIDES, FARTHEST_LAMP_SIDES = 1.0, 40.0
LEAST_HEIGHT_SIDES = 0.25  # a lower model's shadow is dragged as if the model had this height
NEEDS_MARKER = "no marker in view: without it nobody knows where the table is"


@dataclass(frozen=True, slots=True)
class HandContext:
    """The context of a request by hand: the frame that is shown, the estimated light and the model."""

    tracked: TrackedFrame  # with a marker
    illumination: Illumination  # as estimated
    model: PlacedModel
    anchor: Placement = UNMOVED  # the model's own place on the table, which its placement is relative to

    def at_anchor(self, vector: Float) -> Float:
        """(2,) a vector of the marker frame in the anchor's frame."""
        x, y = self.anchor.turned((float(vector[0]), float(vector[1])), back=True)
        return np.asarray(np.array((x, y)) / self.anchor.scale)


class Hand:
    """The state that drags and keys change; `light` is None while the estimate is in force."""

    def __init__(self) -> None:
        self.set_light: FixedInRoom | None = None  # as it was set, which undoing gives back
        self.frame_index = 0  # the frame in which `light` was last set
        self.placement = UNMOVED
        self._tracked: TrackedFrame | None = None  # the frame that is shown
        self._shadow_end_px: Pixel = (0.0, 0.0)  # in the video, when the drag of the light began
        self._held: tuple[Float, Float] | None = None  # the plane's point that a drag grabbed, and the shift then

    @property
    def light(self) -> Illumination | None:
        """The illumination that was set, which stays in the room, in the frame of the marker as it is shown lying."""
        return None if self.set_light is None else self.set_light.seen_by(self._tracked)

    @light.setter
    def light(self, light: Illumination | None) -> None:
        T_room_marker = None if self._tracked is None else self._tracked.T_room_marker
        self.set_light = None if light is None else FixedInRoom(light, T_room_marker)

    def see(self, tracked: TrackedFrame) -> None:
        """The frame that is shown from now on."""
        self._tracked = tracked

    def take_up(self, placement: Placement) -> None:
        """Another model, as it stands: a drag that grabbed the one before has nothing to move any more."""
        self.placement, self._held = placement, None

    def reset(self) -> None:
        self.set_light, self.placement, self._held = None, UNMOVED, None

    def obey(self, request: Request, context: HandContext | None) -> str | None:
        """Changes light or model as the request asks; returns a message when that is not possible.

        context: None while no marker is in view.
        """
        match request:
            case Request(Command.SCALE_MODEL, int() | float() as notches):
                return self._scale(notches)
            case Request(Command.TURN_MODEL, int() | float() as notches):
                turned = (self.placement.turn_rad + notches * TURN_STEP_RAD) % math.tau
                self.placement = replace(self.placement, turn_rad=turned)
                return None
        if context is None:
            return NEEDS_MARKER
        match request:
            case Request(Command.LIGHT_STRENGTH | Command.LIGHT_SOFTNESS | Command.LIGHT_COLOUR, int() as notches):
                return self._change_light(context, request.command, notches)
            case Request(Command.LIGHT_DISTANCE, int() | float() as notches):
                return self._change_distance(context, notches)
            case Request(Command.MOVE_LIGHT, (right, up)):
                self._step_light(context, right, up)
            case Request(Command.MOVE_LIGHT, Drag() as drag):
                self._drag_light(context, drag)
            case Request(Command.MOVE_MODEL, (right, up)):
                to_right, away = picture_axes(context.tracked)
                step = MOVE_STEP_SIDES * context.tracked.pose.side_m
                self._move(context, self.placement.shift_m + context.at_anchor(step * (right * to_right + up * away)))
            case Request(Command.MOVE_MODEL, Drag() as drag):
                self._drag_model(context, drag)
        return None

    def _scale(self, notches: float) -> str | None:
        wanted = self.placement.scale * SCALE_STEP ** min(max(notches, -MOST_NOTCHES), MOST_NOTCHES)
        scale = min(max(wanted, SMALLEST), LARGEST)
        self.placement = replace(self.placement, scale=scale)
        if scale == wanted:
            return None
        return f"the model goes from {100 * SMALLEST:.0f} % to {100 * LARGEST:.0f} % of its size"

    def _move(self, context: HandContext, to_m: Float) -> None:
        length, longest = float(np.linalg.norm(to_m)), FARTHEST_SIDES * context.tracked.pose.side_m
        x, y = to_m * min(1.0, longest / max(length, longest))
        self.placement = replace(self.placement, shift_m=(float(x), float(y)))

    def _drag_model(self, context: HandContext, drag: Drag) -> None:
        if drag.is_first:
            point = ground_at(context.tracked, drag.begin_px)
            self._held = None if point is None else (point, np.array(self.placement.shift_m))
        now = ground_at(context.tracked, drag.now_px)
        if self._held is not None and now is not None:
            point, shift_m = self._held
            self._move(context, shift_m + context.at_anchor(now - point))

    def _step_light(self, context: HandContext, right: float, up: float) -> None:
        base = self._light_to_move(context)
        azimuth, elevation = angles_from_direction(base.lights[0].to_light_marker)
        elevation = min(max(elevation + up * LIGHT_STEP_RAD, LOWEST_RAD), HIGHEST_RAD)
        self._turn_light(context, base, direction_from_angles(azimuth + right * LIGHT_STEP_RAD, elevation))

    def _drag_light(self, context: HandContext, drag: Drag) -> None:
        """The end of the model's shadow follows the mouse; if it is outside the picture it jumps to the mouse first."""
        base = self._light_to_move(context)
        standing = context.anchor @ self.placement
        foot = np.array(standing.shift_m)
        least_height = LEAST_HEIGHT_SIDES * context.tracked.pose.side_m
        height = max(least_height, float(context.model.bounds[1, 2])) * standing.scale
        if drag.is_first:
            end = shadow_of(base.lights[0], foot, height)
            end_px = None if end is None else pixel_of(context.tracked, end)
            self._shadow_end_px = drag.begin_px if end_px is None else end_px
        end_now = ground_at(context.tracked, _brought(drag, self._shadow_end_px))
        if end_now is None:
            return
        to_light = light_through(end_now, foot, height, base.lights[0].inverse_distance)
        if to_light is not None:
            self._turn_light(context, base, to_light)

    def _change_light(self, context: HandContext, command: Command, notches: int) -> str:
        """Strength, softness or colour of the strongest light; returns what it is now."""
        base = self._light_to_move(context)
        light = base.lights[0]
        size = angular_size(light)
        # How often the light is dimmed in its shadow, as exponents: 0 casts none.
        depth = -np.log(np.clip(ground_ratio(light), FAINTEST, 1 - FAINTEST))
        if command is Command.LIGHT_SOFTNESS:
            size = min(max(size * SOFTER_STEP**notches, SHARPEST_RAD), SOFTEST_RAD)
        elif command is Command.LIGHT_STRENGTH:
            depth = depth * STRONGER_STEP**notches
        else:
            depth = depth * WARMER_STEP ** (notches * np.array((1.0, 0.0, -1.0)))
        ratio = np.clip(np.exp(-depth), FAINTEST, 1 - FAINTEST)
        changed = replace(light.with_angular_size(size), shadow_rgb_ratio=ratio, intensity_rgb_ratio=None)
        # The measured ambient light is the shadow's ratio seen otherwise: kept, it would undo the change.
        self._replace_strongest(context, base, changed, None)
        if command is Command.LIGHT_SOFTNESS:
            return f"light: {math.degrees(size):.1f}° wide (the sun is {math.degrees(SUN_ANGULAR_SIZE_RAD):.1f}°)"
        share = 100 * (1 - ratio)
        if command is Command.LIGHT_STRENGTH:
            return f"light: {share @ REC709_LUMINANCE:.0f} % of what lights the table"
        red, green, blue = (f"{value:.0f} %" for value in share)
        return f"light: {red} of the red, {green} of the green and {blue} of the blue on the table"

    def _change_distance(self, context: HandContext, notches: float) -> str:
        """Moves the strongest light nearer or farther; at the marker it stays as large and strong. Says where it is."""
        base = self._light_to_move(context)
        light = base.lights[0]
        farthest, nearest = (sides * context.tracked.pose.side_m for sides in (FARTHEST_LAMP_SIDES, NEAREST_LAMP_SIDES))
        was_lamp = light.inverse_distance > 0
        distance = min(1 / light.inverse_distance, farthest) if was_lamp else farthest
        radius = distance * math.tan(angular_size(light) / 2)
        if was_lamp:
            distance *= FARTHER_STEP ** min(max(notches, -MOST_NOTCHES), MOST_NOTCHES)
        if distance > farthest * (1 + 1e-9) or (not was_lamp and notches >= 0):
            size = 2 * math.atan(radius / farthest)
            changed = replace(light, inverse_distance=0.0, angular_size_rad=size, radius_m=None)
            said = "a sun, far away"
        else:
            distance = max(distance, nearest)
            radius = min(radius, distance * math.tan(SOFTEST_RAD / 2))
            changed = replace(light, inverse_distance=1 / distance).with_angular_size(2 * math.atan(radius / distance))
            said = f"a lamp, {100 * distance:.0f} cm from the marker"
        self._replace_strongest(context, base, changed, base.ambient_rgb_ratio)
        return f"light: {said}"

    def _light_to_move(self, context: HandContext) -> Illumination:
        """The illumination that was set last, or else the estimated one, or else a default."""
        if self.light is not None:
            return self.light
        if context.illumination.lights:
            return context.illumination
        right, _ = picture_axes(context.tracked)
        first = direction_from_angles(math.atan2(-right[1], -right[0]), FIRST_ELEVATION_RAD)
        return Illumination(seen_in=context.illumination.seen_in).relit((Light(first),), None)

    def _turn_light(self, context: HandContext, base: Illumination, to_light: Float) -> None:
        """Turns the strongest light of `base`; measured colours are kept."""
        turned = replace(base.lights[0], to_light_marker=to_light)
        self._replace_strongest(context, base, turned, base.ambient_rgb_ratio)

    def _replace_strongest(
        self, context: HandContext, base: Illumination, light: Light, ambient_rgb_ratio: Float | None
    ) -> None:
        """Sets the lights of `base` with another strongest one, of whose error nothing is known any more."""
        light = replace(light, covariance_rad2=None, sigma_rad=None, confidence=None, lamp_covariance=None)
        self.light = base.relit((light, *base.lights[1:]), ambient_rgb_ratio)
        self.frame_index = context.tracked.frame.index


def _brought(drag: Drag, pixel: Pixel) -> Pixel:
    """`pixel`, moved as far as the mouse has moved since the drag began."""
    (x0, y0), (x, y) = drag.begin_px, drag.now_px
    return pixel[0] + x - x0, pixel[1] + y - y0
