"""One picture with all steps of an estimate, for `estimate --debug`."""

from collections.abc import Sequence
from datetime import datetime
from pathlib import Path

from ashe_live.capture.snapshot import write_png
from ashe_live.drawing.contact_sheet import contact_sheet
from ashe_live.drawing.steps import DebugPicture
from ashe_live.files.writing import make_folder, unused_name

ACROSS, STEP_WIDTH_PX = 4, 480


def write_steps(folder: Path, file: Path, pictures: Sequence[DebugPicture]) -> Path:
    """A sheet of the steps that were taken with `file`, under a name that is not taken yet. Raises UserError."""
    titles = [picture.title for picture in pictures]
    sheet = contact_sheet([picture.image_bgr for picture in pictures], titles, ACROSS, STEP_WIDTH_PX)
    make_folder(folder)
    path = unused_name(folder, file.stem, ".png", datetime.now())
    return write_png(path, sheet, beside=True)
