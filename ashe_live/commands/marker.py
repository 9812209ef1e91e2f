"""`ashe-live marker`: a marker to print at true size."""

import argparse

from ashe_live.errors import ExitStatus
from ashe_live.tracking.layout import parse_target
from ashe_live.tracking.printing import write_marker_sheet


def run(options: argparse.Namespace) -> int:
    write_marker_sheet(options.out, parse_target(options.marker), options.size_mm / 1000, options.overwrite)
    print(f"{options.out}: print it at 100 %, then the ruler line on it is true")
    return ExitStatus.ANSWERED
