"""`ashe-live play`: a recorded clip, or a photo."""

import argparse

from ashe_live.capture.sources import open_source
from ashe_live.commands.setup import make_tracker, tell_focal_length
from ashe_live.commands.view import ViewerSetup, check_outputs, show


def run(options: argparse.Namespace) -> int:
    check_outputs(options)
    tracker, source = make_tracker(options), open_source(options.file)
    tell_focal_length(tracker, source)
    return show(ViewerSetup(source, tracker, options))
