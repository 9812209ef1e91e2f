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


FAST = TrackingPreset(640, 16, False, filter_rest_s=0.5)
BALANCED = TrackingPreset(960, 32, True)
ACCURATE = TrackingPreset(1920, 64, True)
