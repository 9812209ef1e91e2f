"""Short hand-held takes: a camera that turns about the scene by a few degrees, and trembles."""

import math

import numpy as np

from scenes.drawing.families import Params, Rng
from scenes.geometry.poses import look_at, share_in_frame, square
from scenes.geometry.shapes import placed_points

SPANS_DEG = (3, 6, 12, 25, 40)
FRAMES, FPS = 12, 6
TRIES = 200


def frames(rng: Rng, scene: Params) -> Params:
    """`fps`, `span_deg` and for each frame `R` and `t`; the marker stays in view. Raises RuntimeError if it cannot."""
    camera, size = scene["camera"], scene["size"]
    is_sheet = "id" in scene["marker"]  # else the cube, which comes first of the objects
    marker = square(scene["marker"]["side_m"]) if is_sheet else placed_points(scene["objects"][0], 0.0)
    eye = -np.asarray(camera["R"]).T @ np.asarray(camera["t"])
    forward = np.asarray(camera["R"])[2]
    target = eye + forward * (-(eye[2] - 0.02) / forward[2])
    away = eye - target
    distance, pitch = float(np.linalg.norm(away)), math.degrees(math.asin(away[2] / np.linalg.norm(away)))
    azimuth = math.degrees(math.atan2(away[1], away[0]))
    wanted = float(SPANS_DEG[scene["index"] % len(SPANS_DEG)]) * rng.uniform(0.85, 1.15)
    for _ in range(TRIES):
        turn = rng.uniform(-0.4, 0.4) + (0 if rng.random() < 0.5 else math.pi)  # mostly sideways
        u = np.linspace(-0.5, 0.5, FRAMES)
        across = wanted * np.cos(turn) * u / max(math.cos(math.radians(pitch)), 0.25)
        above = np.clip(pitch + wanted * np.sin(turn) * u, 14, 82)
        shake = lambda amount: amount * np.cumsum(rng.normal(size=FRAMES)) / math.sqrt(FRAMES)  # noqa: E731
        nearer, roll = 1 + shake(0.02), shake(1.0)
        aims = target + np.column_stack([shake(0.006), shake(0.006), shake(0.003)])
        poses = [look_at(aims[k], azimuth + across[k], above[k], distance * nearer[k], roll[k]) for k in range(FRAMES)]
        seen = [share_in_frame(camera | {"R": R, "t": t}, marker, size, 4) for R, t in poses]
        if min(seen) == 1:
            ways = np.array([_away(pose, target) for pose in poses])
            span = math.degrees(math.acos(np.clip((ways @ ways.T).min(), -1, 1)))  # of the two farthest apart
            rounded = [{"R": np.round(R, 9).tolist(), "t": np.round(t, 7).tolist()} for R, t in poses]
            return {"fps": FPS, "span_deg": round(span, 2), "frames": rounded}
    raise RuntimeError(f"no motion found for {scene['id']}")


def _away(pose: tuple[np.ndarray, np.ndarray], target: np.ndarray) -> np.ndarray:
    R, t = pose
    way = -R.T @ t - target
    return np.asarray(way / np.linalg.norm(way))
