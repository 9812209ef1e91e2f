"""`ashe-live play`: a recorded clip, or a photo."""

import argparse

from ashe_live.capture.opening import open_source
from ashe_live.commands.flags.marker_choice import tracker_maker, with_marker_in
from ashe_live.commands.flags.model_choice import refuse_model, with_markers_spelled
from ashe_live.commands.flags.setup import make_tracker
from ashe_live.commands.viewing.setup import ViewerSetup, check_outputs
from ashe_live.commands.viewing.window import show


def run(options: argparse.Namespace) -> int:
    check_outputs(options)
    spelled = with_markers_spelled(options)
    refuse_model(options.file)
    make_tracker(spelled)  # reports a wrong --marker before the file is opened
    source = open_source(options.file)
    notes: list[str] = []
    # Numbers of models are of the followed marker's family, which the file may tell.
    asked = options if spelled.takes_any_marker else spelled
    # A window looks for markers while it plays.
    searched = (0, options.frames and options.frames - 1) if options.headless else None
    chosen = with_markers_spelled(with_marker_in(source, asked, announce=notes.append, searched=searched))
    tracker = make_tracker(chosen, source=source)
    tracker_for = tracker_maker(chosen, source=source)
    return show(ViewerSetup(source, tracker, chosen, tracker_for=tracker_for, notes=tuple(notes)))
