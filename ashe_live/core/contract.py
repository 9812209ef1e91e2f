"""The JSON that leaves the program, version 1 (docs/contract.md): plain dicts from the value types.

What does not apply or was not measured is null. Additions keep the schema's number.
"""

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from ashe_live.core.arrays import Float
from ashe_live.core.camera import Camera
from ashe_live.core.light import Illumination, Light, LightEstimate
from ashe_live.core.proxy import Proxy
from ashe_live.core.types import MarkerPose, TrackedFrame

SCHEMA = 1
SNAPSHOT_KEYWORD = "ashe-live"
BY_HAND = "by hand"  # stands for the estimator's name where a person has set the light
STAGES = ("detect", "segment", "associate", "fit", "judge", "total")

Json = dict[str, Any]


def camera_json(camera: Camera) -> Json:
    return {
        "size": list(camera.size),
        "K": camera.K.tolist(),
        "dist": camera.dist.tolist(),
        "source": camera.source,
        "focal_sigma_px": camera.focal_sigma_px,
    }


def marker_json(marker: MarkerPose | None) -> Json:
    return {
        "found": marker is not None,
        "T_cam_marker": marker.T_cam_marker.tolist() if marker else None,
        "corners_px": marker.corners_px.tolist() if marker else None,
        "reprojection_rms_px": marker.reprojection_rms_px if marker else None,
        "bridged": marker.bridged if marker else None,
    }


def light_json(light: Light | None, reason: str | None = None) -> Json:
    """`light` None is "no directional light", for `reason`."""

    def degrees(radians: float | None) -> float | None:
        return None if radians is None else math.degrees(radians)

    return {
        "kind": light.kind if light else "none",
        "to_light_marker": _listed(light.to_light_marker) if light else None,
        "azimuth_deg": light.azimuth_deg if light else None,
        "elevation_deg": light.elevation_deg if light else None,
        "sigma_deg": degrees(light.sigma_rad) if light else None,
        "covariance_rad2": _listed(light.covariance_rad2) if light else None,
        "confidence": light.confidence if light else None,
        "angular_size_deg": degrees(light.angular_size_rad) if light else None,
        "shadow_rgb_ratio": _listed(light.shadow_rgb_ratio) if light else None,
        "position_marker_m": _listed(light.position_marker_m) if light else None,
        "lamp_covariance": _listed(light.lamp_covariance) if light else None,
        "radius_m": light.radius_m if light else None,
        "intensity_rgb_ratio": _listed(light.intensity_rgb_ratio) if light else None,
        "reason": reason,
    }


def caster_json(caster: Proxy | None) -> Json | None:
    if caster is None:
        return None
    return {"family": caster.family, "spheroids_marker": caster.spheroids_marker.tolist()}


def views_json(estimate: LightEstimate | None, files: Sequence[str] = ()) -> Json | None:
    """The views that an answer rests on; None if that is its own frame alone.

    `files`: the file of each view, if they come from several; the indices are then those within each file.
    """
    if estimate is None or estimate.span_rad is None:
        return None
    return {
        "frames": list(estimate.views),
        "files": list(files) or None,
        "span_deg": math.degrees(estimate.span_rad),
    }


def illumination_json(illumination: Illumination, reason: str | None = None) -> Json:
    """The fields of a record about the lights and what they fall on; without a light, `reason` says why."""
    return {
        "light": light_json(illumination.light, reason),
        "lights": [light_json(light) for light in illumination.lights],
        "ambient_rgb_ratio": _listed(illumination.ambient_rgb_ratio),
        "ground_rgb": _listed(illumination.ground_rgb),
        "sky_slope_rgb": None if illumination.sky_slope_rgb is None else illumination.sky_slope_rgb.tolist(),
        "caster": caster_json(illumination.real_object),
    }


def estimate_json(estimate: LightEstimate) -> Json:
    """The fields of a record that the estimator measured."""
    return {**illumination_json(estimate.illumination, estimate.reason), "views": views_json(estimate)}


def estimated_light_json(estimate: LightEstimate) -> Json:
    """A snapshot's light that was estimated."""
    return {"frame": estimate.frame_index, "estimator": estimate.estimator, **estimate_json(estimate)}


def light_by_hand_json(illumination: Illumination, frame_index: int) -> Json:
    """A snapshot's light that a person has set, in the frame of that index."""
    return {"frame": frame_index, "estimator": BY_HAND, **illumination_json(illumination), "views": None}


def snapshot_json(tracked: TrackedFrame, models: Sequence[tuple[str, Float | None]], light: Json | None) -> Json:
    """What a snapshot carries, under the keyword SNAPSHOT_KEYWORD.

    `models`: at least one, by name, each with its `marker_from_placed` (4, 4), or None where its marker is not in view.
    `light`: of `estimated_light_json` or `light_by_hand_json`; None before there is any.
    """
    first, *others = ({"model": name, "marker_from_placed": _listed(matrix)} for name, matrix in models)
    return {
        "schema": SCHEMA,
        "frame": tracked.frame.index,
        "time_s": tracked.frame.time_s,
        "camera": camera_json(tracked.camera),
        "marker": marker_json(tracked.marker),
        **first,
        "others": others,
        "estimate": light,
    }


def _listed(array: Float | None) -> list[Any] | None:
    return None if array is None else array.tolist()


@dataclass(frozen=True, slots=True)
class FileRecord:
    """One line of `ashe-live estimate --json`."""

    file: str
    quality: str
    estimator: str
    error: str | None = None  # one line, for a person; the rest is then null
    frame: int | None = None
    camera: Camera | None = None
    marker: MarkerPose | None = None
    estimate: LightEstimate | None = None
    timing_ms: Mapping[str, float] | None = None
    in_view: tuple[str, ...] = ()  # specs of other markers, if the one that was looked for is not found
    places: tuple[tuple[str, int], ...] = ()  # file and frame of each of the estimate's views, if of several files
    not_found: str = "no marker found"  # why, for a person, if the marker is not
    is_photo: bool = False  # whether `frame` is all that is in the file; not part of the line
    is_fault: bool = False  # whether the error is the program's own; not part of the line

    def to_json(self) -> Json:
        reason = self.error or self.not_found
        estimate = self.estimate or LightEstimate(self.estimator, self.frame or 0, Illumination(), reason)
        views = views_json(self.estimate, [file for file, _ in self.places])
        if views is not None and self.places:
            views["frames"] = [index for _, index in self.places]
        timing = {stage: (self.timing_ms or {}).get(stage) for stage in STAGES}
        return {
            "schema": SCHEMA,
            "file": self.file,
            "frame": self.frame,
            "error": self.error,
            "camera": camera_json(self.camera) if self.camera else None,
            "marker": marker_json(self.marker) if self.error is None else None,
            "markers_in_view": list(self.in_view),
            **estimate_json(estimate),
            "views": views,
            "quality": self.quality,
            "estimator": self.estimator,
            "timing_ms": timing if self.timing_ms else None,
        }

    def to_line(self) -> str:
        return json.dumps(self.to_json(), allow_nan=False)
