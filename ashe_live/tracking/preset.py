"""The tracker's presets: frozen records of counts and sizes that it reads, whatever they are called."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class TrackingPreset:
    """How much work the tracker spends on a frame."""

    detection_width_px: int  # wider frames are searched at this width, then refined at full resolution
    edge_samples: int  # along each edge of the marker, for the sub-pixel line fit
    refines_pose: bool  # non-linear refinement after IPPE
    filter_rest_s: float = 0.3  # time constant over which a marker at rest is averaged; 0: no filter
    filter_gate: float = 3.0  # standard deviations of the pose's noise beyond which a difference is motion


FAST = TrackingPreset(detection_width_px=640, edge_samples=16, refines_pose=False, filter_rest_s=0.5)
BALANCED = TrackingPreset(detection_width_px=960, edge_samples=32, refines_pose=True)
ACCURATE = TrackingPreset(detection_width_px=1920, edge_samples=64, refines_pose=True)
