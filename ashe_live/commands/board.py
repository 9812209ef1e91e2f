"""`ashe-live board`: the board that calibrates a camera, to print at true size."""

import argparse

from ashe_live.errors import ExitStatus
from ashe_live.process.messages import print_answer
from ashe_live.tracking.boards.calibration_board import CalibrationBoard
from ashe_live.tracking.families.page import larger_than
from ashe_live.tracking.families.printing import write_board_sheet


def run(options: argparse.Namespace) -> int:
    page_mm = write_board_sheet(
        options.out, CalibrationBoard(), options.square_mm / 1000, options.overwrite, options.paper
    )
    on = larger_than(options.paper, page_mm)
    print_answer(f"{options.out}: print it{on}, fix it on something flat, then: ashe-live calibrate --out camera.json")
    return ExitStatus.ANSWERED
