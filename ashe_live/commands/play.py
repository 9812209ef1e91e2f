"""`ashe-live play`: a recorded clip, or a photo."""

import argparse

from ashe_live.capture.opening import open_source
from ashe_live.commands.flags.marker_choice import tracker_maker, with_marker_in
from ashe_live.commands.flags.model_choice import follow_named_marker
from ashe_live.commands.flags.setup import make_tracker
from ashe_live.commands.viewing.setup import ViewerSetup, check_outputs
from ashe_live.commands.viewing.window import show


def run(options: argparse.Namespace) -> int:
    check_outputs(options)
    follow_named_marker(options)
    make_tracker(options)  # reports a wrong --marker before the file is opened
    source = open_source(options.file)
    chosen = with_marker_in(source, options)
    tracker = make_tracker(chosen, source=source)
    return show(ViewerSetup(source, tracker, chosen, tracker_for=tracker_maker(chosen, source=source)))
