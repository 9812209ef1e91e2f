"""Prints that are hard to see: narrow borders, narrow margins on a bright floor, pictures with another tone curve."""

from collections.abc import Iterator
from dataclasses import replace

import cv2
import numpy as np

from ashe_live.bench.track.contenders import Answer, OpencvReference, Ours, answers, found_share
from ashe_live.bench.track.frames import Flaws
from ashe_live.bench.track.tables import Figure
from ashe_live.bench.track.takes import SIDE_M, SMALL, SPEC, scattered
from ashe_live.core.square import square_corners
from ashe_live.core.transforms import project
from ashe_live.process.temporary import temporary_folder
from ashe_live.tracking.families.markers import parse_marker
from ashe_live.tracking.preset import TrackingPreset

IMAGE_SIDES_PX = 20, 30, 45
FLOOR = Flaws(quiet_zone=0.05, ground_gain=12.0, gain=0.35)
GAMMAS = 1 / 2.2, 2.2


def hard_print_figures(preset: TrackingPreset, frames: int) -> Iterator[Figure]:
    """What is found of small `image:` prints, and how far off corners are."""
    with temporary_folder() as folder:
        path = folder / "print.png"
        cv2.imwrite(str(path), parse_marker(SPEC).bitmap(240))
        for side_px in IMAGE_SIDES_PX:
            take = scattered(f"image {side_px}", side_px, frames)
            given = answers(
                take, {"OpenCV": OpencvReference(SMALL), "ours": Ours(SMALL, preset, cold=True, spec=f"image:{path}")}
            )
            share = {who: 100 * found_share(own) for who, own in given.items()}
            name = f"found, image: print with a border of one cell, {side_px} px"
            yield Figure(name, "%", share["OpenCV"], share["ours"], None, least=share["OpenCV"])
    attacks = {"margin of a twentieth on a bright floor": FLOOR}
    attacks |= {f"encoded picture to the power of {gamma:.2g}": replace(Flaws(), gamma=gamma) for gamma in GAMMAS}
    for name, flaws in attacks.items():
        take = scattered(name, 100, frames, flaws)
        given = answers(take, {"OpenCV": OpencvReference(SMALL), "ours": Ours(SMALL, preset, cold=True)})
        off = {who: _corners_off_px(own) for who, own in given.items()}
        yield Figure(f"corners off, {name}, 100 px", "px", off["OpenCV"], off["ours"], off["OpenCV"])


def _corners_off_px(given: list[Answer]) -> float | None:
    """Median distance of the corners, where each answer's pose has them, from the truth."""
    square = square_corners(SIDE_M)
    off = [
        np.linalg.norm(project(SMALL, one.T_cam_marker, square) - project(SMALL, one.truth, square), axis=1).mean()
        for one in given
        if one.T_cam_marker is not None
    ]
    return float(np.median(off)) if off else None
