"""The steps to an answer as one sheet of pictures, as key D shows them.

Drawing it takes some fifty milliseconds, so the estimator's process does it and not the window's. Whoever only asks for
it must not wait for the estimator's modules: they are loaded where it is drawn.
"""

from typing import TYPE_CHECKING

from ashe_live.core.arrays import Image
from ashe_live.core.light import LightEstimate
from ashe_live.core.types import TrackedFrame

if TYPE_CHECKING:
    from ashe_live.light.estimators.view_search import Trace

COLUMNS, WIDTH_PX = 2, 320  # of the sheet, and of each of its pictures


def steps_sheet(frozen: TrackedFrame, estimate: LightEstimate, trace: "Trace") -> Image:
    """(h, w, 3) BGR: the trace of an estimate, and its answer.

    frozen: the frame, with a marker, that both were made from.
    """
    from ashe_live.drawing.answer import answer_picture, rose_picture
    from ashe_live.drawing.contact_sheet import contact_sheet
    from ashe_live.drawing.steps import DebugPicture, centred, traced_pictures
    from ashe_live.light.pixels.view import View

    answer = answer_picture(estimate, frozen, WIDTH_PX)
    titled = DebugPicture("answer: object blue, shadow orange", answer)
    pictures = [*traced_pictures(View.of(frozen, WIDTH_PX), trace), titled]
    if estimate.lights:
        rose = rose_picture(estimate, frozen, min(answer.shape[0], WIDTH_PX))  # an upright picture is higher than wide
        height = max(answer.shape[0], rose.shape[0])
        pictures.append(DebugPicture("light: dot, camera: triangle", centred(rose, (height, WIDTH_PX, 3))))
    images, titles = zip(*((picture.image_bgr, picture.title) for picture in pictures), strict=True)
    return contact_sheet(images, titles, COLUMNS, WIDTH_PX)
