"""A page of thumbnails with the light drawn into them: many estimates at a glance, in a single HTML file."""

import base64
import html
from pathlib import Path

import cv2
import numpy as np

from ashe_live.core.arrays import Image
from ashe_live.core.light import LightEstimate
from ashe_live.core.transforms import project
from ashe_live.core.types import TrackedFrame
from ashe_live.drawing.colours import LIGHT_BGR, PAPER_BGR
from ashe_live.drawing.overlays import with_body, with_masks
from ashe_live.files.writing import written_whole
from ashe_live.light.pixels.view import View

WIDTH_PX = 480
JPEG_QUALITY = 85
# Where the arrow begins and ends: distances from the marker's centre towards the light, in sides of the marker.
ARROW_FROM, ARROW_TO = 1.8, 0.5
FARTHEST_PX = 1e4  # coordinate of an end of an arrow that is drawn

PAGE = """<!doctype html>
<html lang="en">
<meta charset="utf-8">
<meta name="viewport" content="width=device-width">
<title>{title}</title>
<style>
  :root {{ color-scheme: light dark; font: 15px/1.4 system-ui, sans-serif; }}
  body {{ margin: 1.5rem; }}
  main {{ display: grid; grid-template-columns: repeat(auto-fill, minmax(20rem, 1fr)); gap: 1.5rem; }}
  figure {{ margin: 0; }}
  img {{ width: 100%; height: auto; }}
  figcaption {{ overflow-wrap: anywhere; }}
</style>
<h1>{title}</h1>
<p>Yellow: where the light comes from. Blue: the object. Orange: its shadow, and the fitted body's.</p>
<main>
{figures}
</main>
</html>
"""
FIGURE = "<figure>{image}<figcaption><strong>{name}</strong><br>{said}</figcaption></figure>"
IMAGE = '<img src="data:image/jpeg;base64,{data}" width="{width}" height="{height}" alt="{alt}">'


class LightPage:
    """Collects the figures, each picture already encoded as JPEG."""

    def __init__(self) -> None:
        self._figures: list[str] = []

    def add(self, name: str, said: str, picture_bgr: Image | None) -> None:
        """A file's name, what is said about it, and its picture (h, w, 3) uint8, if it has one."""
        image = "" if picture_bgr is None else _embedded(picture_bgr, f"{name}: {said}")
        self._figures.append(FIGURE.format(image=image, name=html.escape(name), said=html.escape(said)))

    @property
    def has_figures(self) -> bool:
        return bool(self._figures)

    def write(self, path: Path, overwrite: bool) -> Path:
        """Writes the whole page or nothing; returns its path. Raises UserError when it cannot be written."""
        title = f"Light in {len(self._figures)} {'picture' if len(self._figures) == 1 else 'pictures'}"
        page = PAGE.format(title=title, figures="\n".join(self._figures))
        with written_whole(path, overwrite, beside=True) as file:
            file.stream.write(page.encode("utf-8", "backslashreplace"))
        return file.path


def picture_of(tracked: TrackedFrame, estimate: LightEstimate | None) -> Image:
    """(h, w, 3): the frame at a thumbnail's size, with the light of the estimate if there is one."""
    if tracked.marker is None or estimate is None:
        image = tracked.frame.image_bgr
        scale = min(1.0, WIDTH_PX / image.shape[1])
        size = max(1, round(scale * image.shape[1])), max(1, round(scale * image.shape[0]))
        return np.asarray(cv2.resize(image, size, interpolation=cv2.INTER_AREA), dtype=np.uint8)
    view = View.of(tracked, WIDTH_PX)
    picture = with_masks(view.image_bgr, estimate)
    if (body := estimate.illumination.real_object) is not None:
        picture = with_body(picture, view.camera, view.T_cam_marker, body, estimate.lights)
    return _with_arrows(picture, view, estimate)


def _with_arrows(picture_bgr: Image, view: View, estimate: LightEstimate) -> Image:
    picture = picture_bgr.copy()
    for light in estimate.lights:
        along = view.side_m * np.outer((ARROW_FROM, ARROW_TO), light.to_light_marker)
        ends = project(view.camera, view.T_cam_marker, along)
        if not np.isfinite(ends).all() or np.abs(ends).max() > FARTHEST_PX:
            continue
        start, end = (tuple(int(value) for value in np.round(point)) for point in ends)
        for width, colour in ((5, PAPER_BGR), (2, LIGHT_BGR)):
            cv2.arrowedLine(picture, start, end, colour, width, cv2.LINE_AA, tipLength=0.25)
    return picture


def _embedded(picture_bgr: Image, alt: str) -> str:
    encoded_well, jpeg = cv2.imencode(".jpg", picture_bgr, [cv2.IMWRITE_JPEG_QUALITY, JPEG_QUALITY])
    assert encoded_well
    data = base64.b64encode(jpeg.tobytes()).decode("ascii")
    height, width = picture_bgr.shape[:2]
    return IMAGE.format(data=data, width=width, height=height, alt=html.escape(alt))
