"""Draws docs/cube.jpg: the net of the cube, and a cube in the sun with what was found of its shadow.

    python cube_picture.py [--out ../../docs/cube.jpg]

Needs ashe_live; seconds of one core. The table is painted by the bench's painter.
"""

import argparse
import math
import tempfile
from pathlib import Path

import cv2
import numpy as np

import ashe_live as al
from ashe_live.bench.cube.painted_scene import CubeScene
from ashe_live.bench.cube.painter import painted
from ashe_live.bench.cube.scenes import CAMERA, looking, sun
from ashe_live.light.pixels.view import View
from ashe_live.light.shape.predicted import outlines
from ashe_live.tracking.cube.sheet import write_cube_sheet
from ashe_live.tracking.families.layout import cube_layout

BLUE, ORANGE = (220, 120, 0), (0, 140, 255)
HEIGHT_PX = 480


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=Path(__file__).parents[2] / "docs" / "cube.jpg")
    out = parser.parse_args().out
    table = np.array((0.5, 0.38, 0.26))
    scene = CubeScene(CAMERA, looking(0.45, 55, 35), [sun(190, 38, size_deg=1.5)], seed=5, table_rgb=table)
    picture = painted(scene)
    tracked = al.Tracker(CAMERA, "cube").track(picture)
    light = al.make_estimator().estimate(tracked).light
    assert tracked.marker is not None
    assert tracked.marker.body is not None
    assert light is not None
    off = math.degrees(math.acos(min(1.0, float(light.to_light_marker @ scene.lights[0].point[:3]))))
    print(f"{light.summary(1)}; {off:.2f} degrees off")
    drawn = picture.copy()
    view = View.of(tracked, CAMERA.size[0])
    for outline, colour in zip(
        outlines(tracked.marker.body, light.homogeneous[None], view), (BLUE, ORANGE), strict=True
    ):
        assert outline is not None
        cv2.polylines(drawn, [np.round(outline * 16).astype(np.int32)], True, colour, 1, cv2.LINE_AA, 4)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "net.png"
        write_cube_sheet(path, cube_layout(), 0.06)
        net = cv2.imread(str(path))
    scale = HEIGHT_PX / net.shape[0]
    small = cv2.resize(net, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)
    cv2.imwrite(str(out), np.hstack([small, drawn]), [cv2.IMWRITE_JPEG_QUALITY, 88])


if __name__ == "__main__":
    main()
