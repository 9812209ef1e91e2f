"""Replays what a person did while a clip was recorded, frame by frame, without a window."""

import math
from bisect import bisect_right
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.contract import SCHEMA, Json, light_by_hand_json
from ashe_live.core.light import Illumination, Light
from ashe_live.core.ranges import INDEX, SHARE, SHIFT, Range
from ashe_live.errors import UserError
from ashe_live.files.reading import read_json
from ashe_live.models.assembly.up import UPS, Y_UP
from ashe_live.models.catalogue import MOST_MODELS
from ashe_live.models.loading import GLTF_SUFFIXES
from ashe_live.models.placement import UNMOVED, Placement
from ashe_live.viewer.session import Session
from ashe_live.viewer.table.shelf import Shelf
from ashe_live.viewer.table.stand import Stand
from ashe_live.viewer.view_options import WHOLE, ShownParts

MOST_LIGHTS = 16  # at once, by hand: more than are drawn
KINDS = ("directional", "lamp")
SEATS = range(100)  # places for models at one marker: more than anybody will see
ANGULAR_SIZE_DEG = Range(0.0, 180.0, "degrees")
INTENSITY = Range(0.0, 1e6)  # of a lamp over all other light: beyond that, its shadow is black in any picture
MOST_BYTES = 100_000_000  # of a file: an hour in which something is moved in every frame


@dataclass(frozen=True, slots=True, eq=False)
class Shown:
    """All that keys and mouse had set when a frame was shown."""

    stands: tuple[Stand, ...]
    by_hand: Illumination | None  # the light set by hand; None: the estimated one is shown
    by_hand_frame: int  # the frame in which it was set
    parts: ShownParts
    wants_cover: bool | None  # None: nobody has chosen

    def is_as(self, other: "Shown") -> bool:
        """Whether nothing was done in between; every light by hand is an object of its own."""
        same_switches = (self.parts, self.wants_cover) == (other.parts, other.wants_cover)
        return self.by_hand is other.by_hand and self.stands == other.stands and same_switches

    @property
    def is_plain(self) -> bool:
        """Whether the same models stand as they come, in the estimated light."""
        moved = any(stand.placement != UNMOVED or _is_turned_up(stand) for stand in self.stands)
        return not (moved or self.by_hand is not None or self.wants_cover is not None or self.parts != WHOLE)


def _is_turned_up(stand: Stand) -> bool:
    """Whether somebody said which axis is up, so that a later run may show another one."""
    model = stand.model.model
    # Of these kinds of files it is known without a word; a shipped model's name has no suffix.
    is_known = Path(stand.name).suffix.lower() in ("", *GLTF_SUFFIXES)
    return not (model.is_up_guessed or (is_known and model.up == Y_UP))


def shown_now(session: Session) -> Shown:
    hand = session.hand
    return Shown(session.arrangement.stands, hand.light, hand.frame_index, session.view.parts, session.view.wants_cover)


class AsShown:
    """The state shown with each frame of the clip, by its index; if a frame was shown twice, the last one."""

    def __init__(self, by_frame: dict[int, Shown] | None = None) -> None:
        self._by_frame = by_frame or {}
        self._last = -1  # index of the frame that was added last

    def add(self, frame: int, shown: Shown) -> None:
        # In a clip that is played again, frames that are skipped this time are taken to look as the one before them.
        for skipped in range(self._last + 1, frame):
            self._by_frame.pop(skipped, None)
        before = self._by_frame.get(self._last)
        # As a rule nothing has changed, and all these frames share one value.
        self._by_frame[frame] = before if before is not None and shown.is_as(before) else shown
        self._last = frame

    @property
    def is_plain(self) -> bool:
        """Whether a command that names the models of the last frame shows the same."""
        return len(self._changes()) <= 1 and all(shown.is_plain for shown in self._by_frame.values())

    def to_json(self) -> Json:
        return {"schema": SCHEMA, "shown": [_shown_json(at, shown) for at, shown in self._changes()]}

    def set_up(self, session: Session) -> None:
        """Has `session` show its present frame as it was shown."""
        if session.tracked is None or not self._by_frame:
            return
        frames = sorted(self._by_frame)
        shown = self._by_frame[frames[max(0, bisect_right(frames, session.tracked.frame.index) - 1)]]
        session.hand.light = None
        if shown.by_hand is not None:
            # The ground and the real object are those that this run has estimated.
            session.hand.light = session.lit_by.relit(shown.by_hand.lights, shown.by_hand.ambient_rgb_ratio)
        session.arrangement.stand_as(shown.stands)
        session.view.parts, session.view.wants_cover = shown.parts, shown.wants_cover
        session.shown = session.lit_by

    def _changes(self) -> list[tuple[int, Shown]]:
        """The frames in which something differs from the frame before."""
        frames = sorted(self._by_frame.items())
        return [
            (at, shown)
            for place, (at, shown) in enumerate(frames)
            if place == 0 or not shown.is_as(frames[place - 1][1])
        ]


def read_as_shown(path: Path, shelf: Shelf) -> AsShown:
    """Reads what `AsShown.to_json` wrote, and the models that it names. Raises UserError where that is not possible."""
    content = read_json(path, MOST_BYTES)
    try:
        if not isinstance(content, dict):
            raise ValueError("it is no object in braces")
        if content["schema"] != SCHEMA or not content["shown"]:
            raise ValueError("nothing of this version is in it")
        return AsShown({_index(each): _shown(each, shelf) for each in _objects(content, "shown")})
    except (KeyError, TypeError, ValueError, AttributeError, ArithmeticError) as error:
        said = f"it lacks {error}" if isinstance(error, KeyError) else error
        raise UserError(f"{path} does not say how a recording was shown ({said})", "record again") from error


def _shown_json(frame: int, shown: Shown) -> Json:
    light = None if shown.by_hand is None else light_by_hand_json(shown.by_hand, shown.by_hand_frame)
    return {
        "frame": frame,
        "models": [
            {
                "model": stand.name,
                "up": stand.model.model.up,
                "marker": stand.marker,
                "seat": stand.seat,
                "scale": stand.placement.scale,
                "turn_rad": stand.placement.turn_rad,
                "shift_m": list(stand.placement.shift_m),
            }
            for stand in shown.stands
        ],
        "estimate": light,
        "parts": shown.parts.value,
        "hides_marker": shown.wants_cover,
    }


def _objects(known: Json, name: str) -> list[Json]:
    """What is under `name`: a list of objects."""
    value = known[name]
    if not (isinstance(value, list) and all(isinstance(each, dict) for each in value)):
        raise TypeError(f"{name} is no list of objects in braces: {value!r:.40}")
    return value


def _index(known: Json) -> int:
    """The frame's."""
    return int(INDEX.checked(known["frame"], "frame"))


def _shown(known: Json, shelf: Shelf) -> Shown:
    parts = next((each for each in ShownParts if each.value == known["parts"]), None)
    if parts is None or not known["models"]:
        raise ValueError("a frame shows nothing")
    models = _objects(known, "models")
    if len(models) > MOST_MODELS:
        raise ValueError(f"a frame shows {len(models)} models, and {MOST_MODELS} are the most")
    light = known["estimate"]
    if not (light is None or isinstance(light, dict)):
        raise TypeError(f"{light!r:.40} is no light")
    by_hand = None
    if light is not None:
        by_its_fields = _objects(light, "lights")
        if len(by_its_fields) > MOST_LIGHTS:
            raise ValueError(f"{len(by_its_fields)} lights were set by hand, and {MOST_LIGHTS} are the most")
        lights = tuple(map(_light, by_its_fields))
        by_hand = Illumination(lights, ambient_rgb_ratio=_ratio(light, "ambient_rgb_ratio", SHARE))
    stands = tuple(_stand(each, shelf) for each in models)
    frame = 0 if light is None else _index(light)
    covers = known["hides_marker"]
    if not (covers is None or isinstance(covers, bool)):
        raise TypeError(f"hides_marker is {covers!r:.40}, not true, false or null")
    return Shown(stands, by_hand, frame, parts, covers)


def _stand(known: Json, shelf: Shelf) -> Stand:
    if not isinstance(known["model"], str):
        raise ValueError(f"no model is called {known['model']!r:.40}")
    x, y = _numbers(known, "shift_m", SHIFT, 2).tolist()
    placement = Placement(known["scale"], known["turn_rad"], (x, y))
    if known["seat"] not in SEATS:
        raise ValueError(f"seat {known['seat']!r:.40} is too far away")
    marker = known["marker"]
    if not (marker is None or isinstance(marker, str)):
        raise TypeError(f"no marker is called {marker!r:.40}")
    up = known.get("up")  # files of older versions lack it
    if up not in (None, *UPS):
        raise ValueError(f"no axis is called {up!r:.40}")
    return Stand(known["model"], shelf.loaded(known["model"], up), placement, known["seat"], marker)


def _light(known: Json) -> Light:
    if known["kind"] not in KINDS:
        raise ValueError(f"a light by hand is of no kind {known['kind']!r:.40}")
    place = _numbers(known, "position_marker_m", SHIFT, 3) if known["position_marker_m"] is not None else None
    if place is not None and not place.any():
        raise ValueError("a lamp stands at the marker's centre")
    size_deg = known["angular_size_deg"]
    if size_deg is not None:
        ANGULAR_SIZE_DEG.checked(size_deg, "angular_size_deg")
    return Light(
        _numbers(known, "to_light_marker", SHIFT, 3),
        angular_size_rad=None if size_deg is None else math.radians(size_deg),
        shadow_rgb_ratio=_ratio(known, "shadow_rgb_ratio", SHARE),
        inverse_distance=0.0 if place is None else 1 / math.hypot(*place),
        radius_m=known["radius_m"],
        intensity_rgb_ratio=_ratio(known, "intensity_rgb_ratio", INTENSITY),
    )


def _ratio(known: Json, name: str, allowed: Range) -> Any:
    """The field's values, one for each colour, or null."""
    return None if known[name] is None else _numbers(known, name, allowed, 3)


def _numbers(known: Json, name: str, allowed: Range, count: int) -> Float:
    """The field's values (count,)."""
    values = known[name]
    if not (isinstance(values, list) and len(values) == count):
        raise TypeError(f"{name} is no list of {count} numbers: {values!r:.40}")
    return np.array([allowed.checked(value, name) for value in values], dtype=np.float64)
