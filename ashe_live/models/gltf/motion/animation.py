"""What a glTF file animates, sampled between its keyframes: appendix C of the specification."""

import math
from dataclasses import dataclass

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.models.gltf.arrays import Arrays
from ashe_live.models.parsing.json_kinds import Json
from ashe_live.models.parsing.malformed import MalformedError

PATHS = {"translation": 3, "rotation": 4, "scale": 3}
# An animation is kept as poses, and drawn by interpolation. At fewer than the least, limbs would cut corners.
POSES_PER_S, LEAST_POSES_PER_S = 30.0, 6.0
MOST_POSED_VERTICES = 3_000_000  # of all poses together, 24 bytes each
MOST_POSED_NODES = 300_000  # nodes and channels of all poses together; of each the processor takes some 20 us
ALMOST_ALONG = 0.9995  # cosine above which a straight line between quaternions is the arc

Changes = dict[tuple[int, str], Float]  # by node and path


class Animation:
    """What a file's nodes do over time, from the first keyframe on: nothing if the file animates none.

    It combines the first of a file's animations with those that move nothing that one before them moves. (Exporters
    write an animation for each object, or one for each action of a figure.)
    """

    def __init__(self, header: Json, arrays: Arrays) -> None:
        self._tracks: dict[tuple[int, str], _Track] = {}
        self.left_out = 0  # animations that are alternatives
        self.is_damaged = False  # some of what it says of nodes
        for animation in header["animations"]:
            tracks, is_whole = _tracks(animation, arrays)
            self.is_damaged |= not is_whole
            if tracks.keys() & self._tracks.keys():
                self.left_out += 1
            else:
                self._tracks |= tracks
        self._cost = len(header["nodes"]) + len(self._tracks)
        times = [track.times for track in self._tracks.values()]
        self.begin_s = min((float(each[0]) for each in times), default=0.0)
        self.duration_s = max((float(each[-1]) for each in times), default=0.0) - self.begin_s
        changing = (target for target, track in self._tracks.items() if track.changes)
        self.moving = frozenset(changing)  # nodes and paths that are not the same all the time

    def at(self, time_s: float) -> Changes:
        """Rows of what is moved, `time_s` after the first keyframe."""
        return {target: track.at(self.begin_s + time_s) for target, track in self._tracks.items()}

    def times(self, vertices: int) -> Float | None:
        """(k,) seconds, evenly spaced, of poses of so many moving vertices; None where they would be too few."""
        wanted = math.ceil(min(self.duration_s * POSES_PER_S, MOST_POSED_NODES)) + 1
        count = min(wanted, MOST_POSED_VERTICES // max(1, vertices), MOST_POSED_NODES // self._cost)
        if count < 2 or count - 1 < LEAST_POSES_PER_S * self.duration_s:
            return None
        return np.linspace(0.0, self.duration_s, count)


@dataclass(frozen=True, slots=True)
class _Track:
    """The keyframes of one channel."""

    times: Float  # (k,) seconds, increasing
    values: Float  # (k, n)
    tangents: tuple[Float, Float] | None  # (k, n) into and out of each, of a cubic spline
    is_stepped: bool
    is_rotation: bool

    @property
    def changes(self) -> bool:
        """Whether it is not the same all the time: a spline may also leave a value and come back to it."""
        leaves = self.tangents is not None and (np.any(self.tangents[0][1:]) or np.any(self.tangents[1][:-1]))
        return bool(leaves or np.any(np.ptp(self.values, axis=0)))

    def at(self, time_s: float) -> Float:
        """(n,) the value at a time; before the first keyframe that of the first, after the last that of the last."""
        after = int(np.searchsorted(self.times, time_s, side="right"))
        if after == 0 or after == len(self.times):
            return np.asarray(self.values[min(after, len(self.times) - 1)])
        before = after - 1
        span = float(self.times[after] - self.times[before])
        share = (time_s - float(self.times[before])) / span
        first, last = self.values[before], self.values[after]
        if self.is_stepped:
            return np.asarray(first)
        if self.tangents is not None:
            into, out_of = self.tangents
            t2, t3 = share * share, share * share * share
            hermite = (2 * t3 - 3 * t2 + 1) * first + (3 * t2 - 2 * t3) * last
            return np.asarray(hermite + span * ((t3 - 2 * t2 + share) * out_of[before] + (t3 - t2) * into[after]))
        if self.is_rotation:
            return _slerp(first, last, share)
        return np.asarray(first + share * (last - first))


def _tracks(animation: Json, arrays: Arrays) -> tuple[dict[tuple[int, str], _Track], bool]:
    """Tracks by node and path, and whether these are all channels."""
    found: dict[tuple[int, str], _Track] = {}
    sampled: dict[tuple[int, str], _Track | None] = {}
    for channel in animation["channels"]:
        node, path = channel["target"].get("node"), channel["target"]["path"]
        if node is None or path not in (*PATHS, "weights"):
            continue
        if channel["sampler"] >= len(animation["samplers"]):
            raise MalformedError(f"a channel names sampler {channel['sampler']} of {len(animation['samplers'])}")
        source = channel["sampler"], path
        if source not in sampled:
            sampled[source] = _track(animation["samplers"][channel["sampler"]], path, arrays)
        if (track := sampled[source]) is not None:
            found[node, path] = track
    return found, None not in sampled.values()


def _track(sampler: Json, path: str, arrays: Arrays) -> _Track | None:
    """None for what holds no keyframe, other rows than the path has, no numbers, or times that do not increase."""
    times = arrays.floats(sampler["input"]).ravel()
    values = arrays.floats(sampler["output"])
    # A cubic spline has three values each frame: the tangents are around what is reached.
    kind = sampler.get("interpolation")
    rows = len(times) * (3 if kind == "CUBICSPLINE" else 1)
    each = len(values) // max(1, rows)
    if not each or (path in PATHS and each * values.shape[1] != PATHS[path]):
        return None
    given = values[: rows * each].reshape(len(times), -1, each * values.shape[1])
    if not (np.isfinite(given).all() and np.isfinite(times).all() and np.all(np.diff(times) > 0)):
        return None
    tangents = (given[:, 0], given[:, 2]) if kind == "CUBICSPLINE" else None
    reached = given[:, 0] if tangents is None else given[:, 1]
    return _Track(times, reached, tangents, kind == "STEP", path == "rotation")


def _slerp(first: Float, last: Float, share: float) -> Float:
    """Spherical linear interpolation of quaternions (4,), along the shorter arc."""
    a, b = (each / max(float(np.linalg.norm(each)), 1e-30) for each in (first, last))
    along = float(a @ b)
    b, along = (b, along) if along >= 0 else (-b, -along)
    if along > ALMOST_ALONG:
        return np.asarray(a + share * (b - a))
    angle = math.acos(along)
    return np.asarray((math.sin((1 - share) * angle) * a + math.sin(share * angle) * b) / math.sin(angle))
