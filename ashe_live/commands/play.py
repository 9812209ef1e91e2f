"""`ashe-live play`: a recorded clip, or a photo."""

import argparse

from ashe_live.capture.sources import open_source
from ashe_live.commands.setup import make_tracker
from ashe_live.commands.view import ViewerSetup, check_outputs, show


def run(options: argparse.Namespace) -> int:
    check_outputs(options)
    tracker = make_tracker(options)
    return show(ViewerSetup(open_source(options.file), tracker, options))
