"""The presets: frozen records of counts and sizes that the code reads, so that no algorithm asks for their names."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class TrackingPreset:
    """How much work the tracker spends on a frame."""

    detection_width_px: int  # wider frames are searched at this width, then refined at full resolution
    edge_samples: int  # along each edge of the marker, for the sub-pixel line fit
    refines_pose: bool  # non-linear refinement after IPPE


@dataclass(frozen=True, slots=True)
class RenderPreset:
    """How much work the renderer spends on a frame."""

    shadow_map_size: int  # texels a side, for each caster and light
    pcf_radius: int  # (2 r + 1)^2 filter taps where the penumbra is not searched for
    blocker_taps: int  # to find how wide the penumbra is; 0: shadows of one softness
    soft_taps: int  # over the penumbra
    msaa_samples: int  # 0: none
    environment_size: int  # texels a side of what polished surfaces mirror, a power of two


@dataclass(frozen=True, slots=True)
class Quality:
    """One notch on the trade of speed for accuracy."""

    name: str
    tracking: TrackingPreset
    render: RenderPreset


FAST = Quality("fast", TrackingPreset(640, 16, False), RenderPreset(512, 1, 0, 0, 0, 32))
BALANCED = Quality("balanced", TrackingPreset(960, 32, True), RenderPreset(1024, 1, 8, 16, 4, 64))
ACCURATE = Quality("accurate", TrackingPreset(1920, 64, True), RenderPreset(2048, 2, 16, 32, 8, 256))

QUALITIES: dict[str, Quality] = {quality.name: quality for quality in (FAST, BALANCED, ACCURATE)}
