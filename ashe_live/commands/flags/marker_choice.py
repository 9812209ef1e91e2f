"""Which marker is followed if nobody has named one: the one of a known family that is in view."""

import argparse
from collections.abc import Callable, Iterator
from contextlib import suppress
from functools import partial
from itertools import count, islice

from ashe_live.capture.sources import Seekable, Source
from ashe_live.commands.flags.model_choice import without_model
from ashe_live.commands.flags.setup import camera_chooser, make_tracker
from ashe_live.core.camera import Camera
from ashe_live.core.types import Frame
from ashe_live.errors import UserError
from ashe_live.process.messages import print_message
from ashe_live.tracking.families.in_view import in_view_text, markers_in_view, mirrored_text
from ashe_live.tracking.families.layout import is_of_cube, members_of, parse_target, the_marker
from ashe_live.tracking.families.seen_instead import SeenInstead
from ashe_live.tracking.focal.focal_memory import FocalMemory
from ashe_live.tracking.tracker import MarkerTracker

# Frames of a clip that are searched: in the very first ones the marker may still be half hidden.
LOOKED_AT = 5
# Where no window looks for markers while it plays, one frame of each such step is searched as well, until that time
# after the first: a clip may begin black, or beside the table.
STEP_S, SEARCHED_S = 0.5, 60.0
FrameRange = tuple[int, int | None]  # indices of the first and the last; None: the clip's last
SHOW_IT = "show all of it, or name the one that is there with --marker"


def with_marker(options: argparse.Namespace, spec: str) -> argparse.Namespace:
    """`options` as if that marker had been named."""
    return argparse.Namespace(**{**vars(options), "marker": spec, "takes_any_marker": False})


def tracker_maker(
    options: argparse.Namespace, memory: FocalMemory | None = None, source: Source | None = None
) -> Callable[[str | None, float | None], MarkerTracker]:
    """Makes trackers as `options` say, but for another marker's spec, or with another field of view in degrees.

    Files that `options` name are read now: by the time that a key asks for another tracker they may be gone.
    """
    camera_for, marker = camera_chooser(options), parse_target(options.marker)

    def tracker_for(spec: str | None, hfov_deg: float | None) -> MarkerTracker:
        seen_by = camera_for if hfov_deg is None else partial(Camera.from_hfov, hfov_deg=hfov_deg)
        if spec is None:
            return make_tracker(options, seen_by, memory, source, marker)
        chosen = with_marker(options, spec)
        chosen.caster = None  # a cube that is followed from now on casts the shadow itself
        return make_tracker(chosen, seen_by, memory, source)

    return tracker_for


def with_marker_in(
    source: Source,
    options: argparse.Namespace,
    announced: set[str] | None = None,
    announce: Callable[[str], None] = print_message,
    searched: FrameRange | None = None,
) -> argparse.Namespace:
    """`options` with `marker_in` a photo or clip. A marker that was named is kept.

    Files that are opened later may show another marker.
    `announced`: markers of which a line has said before that they are followed, where there are many sources.
    `announce` gets the lines. `searched`: as there.
    """
    if source.is_live or not options.takes_any_marker:
        return options
    found = marker_in(source, options, set() if announced is None else announced, announce, searched)
    return options if found in (None, options.marker) else argparse.Namespace(**{**vars(options), "marker": found})


def marker_in(
    source: Source,
    options: argparse.Namespace,
    announced: set[str],
    announce: Callable[[str], None] = print_message,
    searched: FrameRange | None = None,
) -> str | None:
    """The only marker in a photo, or in a clip, unless the one in `options` is there; None: no marker.

    Of several, it is the only one that has no model of its own; where that leaves a choice, the user is told of it, and
    the one in `options` is kept. The source is rewound.
    searched: the indices of a clip's frames that are searched until there is a marker; None: its first few.
    """
    named = [member.marker for member in members_of(parse_target(options.marker))]
    try:
        for frame in islice(source, LOOKED_AT) if searched is None else _searched(source, *searched):
            in_view = markers_in_view(frame.image_bgr)
            green = frame.image_bgr[..., 1].copy()
            if options.marker in in_view or (not in_view and any(marker.find(green) for marker in named)):
                return str(options.marker)
            free = in_view if len(in_view) == 1 else without_model(options, in_view)
            if len(free) == 1:
                if free[0] not in announced:
                    announce(f"{source.name}: {in_view_text(free)} and is followed, as no --marker was given")
                announced.add(free[0])
                return free[0]
            if in_view:
                announce(f"{source.name}: {in_view_text(in_view)}: choose one, as by --marker {in_view[0]}")
                return str(options.marker)
    finally:
        source.rewind()
    return None


def _searched(source: Source, first: int, last: int | None) -> Iterator[Frame]:
    """Some consecutive frames from number `first` on, then one of each STEP_S; none behind `last` or a damage."""
    if first and isinstance(source, Seekable):
        source.seek_frame(first)
    next_s = end_s = None
    for number in count(1):
        frame = None
        with suppress(UserError):  # whoever plays the source comes upon it again
            if next_s is not None and isinstance(source, Seekable):
                while source.pass_over(next_s.__le__):
                    pass
            frame = source.read()
        if frame is None or (last is not None and frame.index > last):
            return
        yield frame
        end_s = frame.time_s + SEARCHED_S if end_s is None else end_s
        if frame.time_s >= end_s:
            return
        next_s = None if number < LOOKED_AT else frame.time_s + STEP_S


def not_found_text(marker: str, is_named: bool, instead: SeenInstead) -> str:
    """That `marker`, which a person may have named, was not found, what is seen instead, and what helps."""
    if instead.mirrored:
        said = mirrored_text(instead.mirrored)
        return f"{the_marker(marker)} was not found: {said}" if is_named else said
    if not instead.in_view:
        which = f"{the_marker(marker)} was not" if is_named else "no marker"
        return f"{which} found: {instead.fault or SHOW_IT}"
    # One that is in view is named by the hint.
    which = the_marker(marker) if is_named and marker not in instead.in_view else "the marker"
    return f"{which} was not found: {_hint(instead.in_view, marker)}"


def _hint(in_view: tuple[str, ...], marker: str) -> str:
    """A hint on the markers in view, if none that looks like `marker` was found through the camera."""
    if marker in in_view:
        fold = "fold it if it lies flat, or " if is_of_cube(marker) else ""
        camera = "check --hfov, --focal-px or --camera-file"
        return f"{in_view_text([marker])}, but not as this camera would see it: {fold}{camera}"
    return f"{in_view_text(in_view)}: --marker {in_view[0]}"
