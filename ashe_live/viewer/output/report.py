"""REPORT.json of a headless run (docs/contract.md): every pose, every estimate, and how long things took."""

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from ashe_live.core.camera import Camera
from ashe_live.core.contract import SCHEMA, Json, camera_json, estimate_json, marker_json
from ashe_live.core.light import LightEstimate
from ashe_live.core.types import TrackedFrame
from ashe_live.files.writing import write_json


def frame_time_percentiles(frame_ms: list[float]) -> Json | None:
    """p50, p95 and p99 in milliseconds; None without a frame."""
    if not frame_ms:
        return None
    p50, p95, p99 = np.percentile(frame_ms, (50, 95, 99))
    return {"p50": float(p50), "p95": float(p95), "p99": float(p99)}


@dataclass(slots=True)
class Report:
    """The report, to which every frame adds an entry."""

    renderer: str
    gl_version: str
    quality: str
    frames: list[Json] = field(default_factory=list)
    estimates: list[Json] = field(default_factory=list)
    camera: Camera | None = None  # of the last frame: the surest, where it was estimated

    def add_frame(self, tracked: TrackedFrame, frame_ms: float) -> None:
        """`frame_ms`: decoding, tracking and rendering of this frame, without recording it."""
        self.camera = tracked.camera
        marker = marker_json(tracked.marker)
        self.frames.append(
            {
                "index": tracked.frame.index,
                "time_s": tracked.frame.time_s,
                "found": marker["found"],
                "T_cam_marker": marker["T_cam_marker"],
                "reprojection_rms_px": marker["reprojection_rms_px"],
                "bridged": marker["bridged"],
                "frame_ms": frame_ms,
            }
        )

    def add_estimate(self, estimate: LightEstimate) -> None:
        record = {"frame": estimate.frame_index, **estimate_json(estimate), "ms": estimate.timing_ms.get("total")}
        self.estimates.append(record)

    def to_json(self) -> Json:
        frame_ms = [frame["frame_ms"] for frame in self.frames]
        total_s = sum(frame_ms) / 1000
        return {
            "schema": SCHEMA,
            "frames": self.frames,
            "estimates": self.estimates,
            "summary": {
                "frames": len(self.frames),
                "found": sum(frame["found"] for frame in self.frames),
                "camera": camera_json(self.camera) if self.camera else None,
                "fps": len(self.frames) / total_s if total_s else None,
                # Playback without a window waits for each estimate: no frame is drawn meanwhile (docs/contract.md).
                "frame_ms": {"idle": frame_time_percentiles(frame_ms), "estimating": None},
                "renderer": self.renderer,
                "gl_version": self.gl_version,
                "quality": self.quality,
            },
        }

    def write(self, path: Path, overwrite: bool = False) -> Path:
        """Writes the whole report or nothing; returns its path, another one if a file has meanwhile appeared at `path`.

        Raises UserError when it cannot be written.
        """
        return write_json(path, self.to_json(), overwrite, beside=True)
