"""A page as a printer puts it on paper, PDF or PNG: its picture, and how long a pixel of that is."""

import re
from collections.abc import Callable
from io import BytesIO
from pathlib import Path

import cv2
import numpy as np
import PIL.Image
import pytest

from ashe_live.core.arrays import Float, Image
from ashe_live.errors import UserError

MM_PER_INCH = 25.4
MM_PER_POINT = MM_PER_INCH / 72  # ISO 32000-1, 8.3.2.3


def as_printed(path: Path) -> tuple[Image, float]:
    """The grey picture (h, w), and millimetres a pixel; of a PDF by the place of its only picture on its only page."""
    if path.suffix.lower() == ".png":
        with PIL.Image.open(path) as page:
            across, down = page.info["dpi"]
            assert across == down
            return np.asarray(page.convert("L")), MM_PER_INCH / across
    content = path.read_bytes()
    (jpeg,) = re.findall(rb"/DCTDecode.*?>>stream\s+(\xff\xd8.*?)\s*endstream", content, re.DOTALL)
    (sheet,) = re.findall(rb"/MediaBox \[ 0 0 ([\d.]+) ([\d.]+) \]", content)
    (placed,) = re.findall(rb"q ([\d.]+) 0 0 ([\d.]+) 0 0 cm /image Do Q", content)
    assert [float(points) for points in placed] == pytest.approx([float(points) for points in sheet]), (
        "it fills the page"
    )
    with PIL.Image.open(BytesIO(jpeg)) as page:
        across, down = (float(points) * MM_PER_POINT / px for points, px in zip(placed, page.size, strict=True))
        assert abs(across - down) < 1e-6
        return np.asarray(page.convert("L")), across


def corners_mm(page: Image, mm_per_px: float) -> dict[int, Float]:
    """(4, 2) by number: what OpenCV finds of the usual markers, their corners from the page's top-left corner."""
    small = cv2.resize(page, None, fx=0.25, fy=0.25, interpolation=cv2.INTER_AREA)
    parameters = cv2.aruco.DetectorParameters()
    parameters.cornerRefinementMethod = cv2.aruco.CORNER_REFINE_SUBPIX
    dictionary = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_4X4_50)
    quads, ids, _ = cv2.aruco.ArucoDetector(dictionary, parameters).detectMarkers(small)
    return {
        int(number): (quad.reshape(4, 2) + 0.5) * 4 * mm_per_px
        for quad, number in zip(quads, np.ravel(ids), strict=True)
    }


def assert_advice_holds(write: Callable[[float], object], named: str) -> None:
    """What `write` (of a side in metres) advises of `named` sizes that fit a page is what it takes, and no more."""
    with pytest.raises(UserError) as caught:
        write(5.0)
    least, most = (int(number) for number in re.findall(r"\d+", caught.value.remedy))
    for refused_mm in (least - 1, most + 1):
        with pytest.raises(UserError, match=f"choose {named} from {least} to {most} mm"):
            write(refused_mm / 1000)
    for mm in (least, most):
        write(mm / 1000)
