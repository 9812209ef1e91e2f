"""Scenes of the folded paper cube: how well it is folded, printed and lit, and from where it is seen."""

import math
from pathlib import Path
from typing import Any

import cv2
import numpy as np

from ashe_live.tracking.cube.faces import FACES, USUAL_EDGE_M
from ashe_live.tracking.cube.sheet import COLUMNS, FLAP_MM, ROWS, write_cube_sheet
from ashe_live.tracking.families.layout import cube_layout
from ashe_live.tracking.families.page import PAPERS_MM
from scenes.drawing.families import Params, Rng, between, log_between
from scenes.drawing.layout import hull_px, neighbour, overlap
from scenes.drawing.lights import lamp, sun
from scenes.geometry.paper_cube import NET
from scenes.geometry.poses import cast, intrinsics, look_at, share_in_frame
from scenes.geometry.shapes import placed_points

SIZE = [640, 480]
NET_PX = 600  # of an edge
FAMILY = "paper_cube"
MOST_OFF_M, MOST_OFF_DEG, MOST_BULGED_M = 1e-3, 1.5, 8e-4  # of a face that was folded by hand
APART_RAD = math.radians(25)  # of two suns
NEIGHBOURS = 0.3  # of the scenes have one or two other things on the table


def write_net(folder: Path) -> None:
    """The net of `ashe-live marker --cube`, as printed."""
    sheet = folder / "cube_sheet.png"
    write_cube_sheet(sheet, cube_layout(), USUAL_EDGE_M, overwrite=True)
    page = cv2.imread(str(sheet), cv2.IMREAD_GRAYSCALE)
    sheet.unlink()
    (width, height), edge = PAPERS_MM["a4"][0], 1000 * USUAL_EDGE_M
    scale = page.shape[1] / width
    left, top = (width - COLUMNS * edge) / 2, (height - ROWS * edge - FLAP_MM) / 2
    rows, columns = (
        slice(round(scale * first), round(scale * (first + count * edge)))
        for first, count in ((top, ROWS), (left, COLUMNS))
    )
    size = COLUMNS * NET_PX, ROWS * NET_PX
    cv2.imwrite(str(folder / NET), cv2.resize(page[rows, columns], size, interpolation=cv2.INTER_AREA))


def layout(rng: Rng, index: int, ground: Params, sealed: bool) -> Params | None:
    """One try at placing everything in scene `index`; None where the picture would be of no use."""
    cube = _folded(rng)
    points = placed_points(cube, 0.0)
    camera = _view(rng)
    if share_in_frame(camera, points, SIZE, 3) < 1:
        return None
    hull = hull_px(camera, points)
    lights = _lights(rng, index, camera)
    objects = [cube]
    sheet = {"card_m": 0.0, "paper_side_m": 0.0}
    for _ in range(int(rng.integers(1, 3)) if rng.random() < NEIGHBOURS else 0):
        other = neighbour(rng, ground, sealed, camera, SIZE, objects, sheet, hull, False)
        if other is None or overlap(hull, hull_px(camera, placed_points(other, 0.0))) > 0:
            return None
        if any(_meet(points, placed_points(other, 0.0), light) for light in lights):
            return None  # in another's shadow it is to be refused, which is another question
        objects.append(other)
    return {
        "size": SIZE, "camera": camera, "ground": ground | {"z_m": 0.0},
        "marker": {"dictionary": "cube", "side_m": USUAL_EDGE_M, "card_m": 0.0, "curl_m": 0.0},
        "objects": objects, "patches": [], "lights": lights, "without_object": False, "partial_kind": None,
    }  # fmt: skip


def pictures(rng: Rng, index: int) -> list[tuple[str, list[int]]]:
    """Category and lights of what is developed."""
    second = ("soft sun", [1]) if is_soft(index) else ("two suns", [0, 1])
    cloudy = [("cloudy sky", [])] if rng.random() < 0.4 else []
    return [("sun", [0]), second, ("lamp", [2]), *cloudy]


def is_soft(index: int) -> bool:
    """Whether the second light of scene `index` is 3 to 10 degrees wide, and stands alone; else both suns shine."""
    return index % 2 == 0


def _folded(rng: Rng) -> Params:
    """The cube, each face turned and shifted by up to so much along and about each axis, and bulged."""
    paper = between(rng, 0.74, 0.86)
    return {
        "family": FAMILY,
        "params": {"edge_m": USUAL_EDGE_M, "faces": [_lying(rng, number) for number in range(len(FACES))]},
        "material": {
            "family": "cube paper",
            "colour": [paper, round(paper * between(rng, 0.97, 1.0), 4), round(paper * between(rng, 0.93, 1.03), 4)],
            "ink": between(rng, 0.03, 0.08), "through": between(rng, 0.08, 0.12), "roughness": between(rng, 0.5, 0.9),
        },
        "xy_m": [0.0, 0.0], "yaw_deg": 0.0, "height_m": USUAL_EDGE_M, "role": "caster",
    }  # fmt: skip


def _lying(rng: Rng, number: int) -> Params:
    face = FACES[number]
    turn = cv2.Rodrigues(np.radians(rng.uniform(-MOST_OFF_DEG, MOST_OFF_DEG, 3)))[0]
    corners = (face.corners() - face.centre) @ turn.T + face.centre
    corners = USUAL_EDGE_M * corners + rng.uniform(-MOST_OFF_M, MOST_OFF_M, 3)
    from_middle = np.array([(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)])
    for _ in range(face.turns):
        from_middle = np.column_stack([from_middle[:, 1], -from_middle[:, 0]])
    net = (from_middle + np.array((face.column + 0.5, face.row + 0.5))) / (COLUMNS, ROWS)
    return {"corners_m": np.round(corners, 7).tolist(), "net": np.round(net, 6).tolist(),
            "bulge_m": between(rng, -MOST_BULGED_M, MOST_BULGED_M)}  # fmt: skip


def _view(rng: Rng) -> Params:
    """A phone's or a webcam's, 35 to 60 cm away and 15 to 65 degrees above the table."""
    hfov, pitch = between(rng, 52, 70), float(rng.uniform(15, 65))
    target = [*rng.normal(0, 0.025, 2), 0.02]
    R, t = look_at(target, rng.uniform(0, 360), pitch, rng.uniform(0.35, 0.6), rng.normal(0, 5))
    return {"K": intrinsics(SIZE, hfov).tolist(), "hfov_deg": hfov, "R": np.round(R, 9).tolist(),
            "t": np.round(t, 7).tolist(), "pitch_deg": round(pitch, 3)}  # fmt: skip


def _lights(rng: Rng, index: int, camera: Params) -> list[Params]:
    """Two suns and a lamp, 12 to 80 degrees high, wherever their shadows fall; every other scene's second is soft."""
    suns = [_sun(rng)]
    while len(suns) < 2:
        other = _sun(rng)
        if _angle(suns[0], other) > APART_RAD:
            soft = {"angular_diameter_deg": between(rng, 3, 10)} if is_soft(index) else {}
            suns.append(other | soft)
    while True:
        near = _lamp(rng)
        if share_in_frame(camera, [near["position_m"]], SIZE) == 0:
            return [*suns, near]


def _sun(rng: Rng) -> Params:
    return sun(rng, "plain") | {"elevation_deg": between(rng, 12, 80), "strength": log_between(rng, 0.8, 6.0)}


def _lamp(rng: Rng) -> Params:
    distance = between(rng, 0.4, 0.6)
    a, e = math.radians(between(rng, 0, 360)), math.radians(between(rng, 12, 80))
    at = [distance * math.cos(e) * math.cos(a), distance * math.cos(e) * math.sin(a), distance * math.sin(e)]
    return lamp(rng, 0.0) | {
        "position_m": [round(v, 5) for v in at], "azimuth_deg": math.degrees(a), "elevation_deg": math.degrees(e),
        "radius_m": between(rng, 0.008, 0.025), "strength": log_between(rng, 0.8, 6.0),
    }  # fmt: skip


def _angle(one: Params, other: Params) -> float:
    (a, e), (b, f) = (np.radians((each["azimuth_deg"], each["elevation_deg"])) for each in (one, other))
    return math.acos(min(1.0, math.sin(e) * math.sin(f) + math.cos(e) * math.cos(f) * math.cos(a - b)))


def _meet(points: Any, others: Any, light: Params) -> bool:
    """Whether shadows on the table meet."""
    if light.get("position_m") is not None and others[:, 2].max() > 0.8 * light["position_m"][2]:
        return True
    hulls = (cv2.convexHull(np.float32(cast(each, light, 0.0)[:, :2])).reshape(-1, 2) for each in (points, others))
    return overlap(*hulls) > 0
