"""Cubes painted by the bench's painter, as tests want them."""

from ashe_live.bench.cube.painted_scene import CubeScene, Folds, PaintedLight
from ashe_live.bench.cube.painter import painted
from ashe_live.bench.cube.scenes import CAMERA, EDGE_M, lamp, looking, sun
from ashe_live.core.types import Frame

__all__ = ["CAMERA", "EDGE_M", "CubeScene", "Folds", "PaintedLight", "frame_of", "lamp", "looking", "painted", "sun"]


def frame_of(scene: CubeScene, index: int = 0) -> Frame:
    return Frame(painted(scene), index, index / 30)
