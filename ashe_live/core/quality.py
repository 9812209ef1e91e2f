"""The presets: frozen records of counts and sizes that the code reads, so that no algorithm asks for their names."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class TrackingPreset:
    """How much work the tracker spends on a frame."""

    detection_width_px: int  # wider frames are searched at this width, then refined at full resolution
    edge_samples: int  # along each edge of the marker, for the sub-pixel line fit
    refines_pose: bool  # non-linear refinement after IPPE
    filter_rest_s: float = 0.3  # time constant over which a marker at rest is averaged; 0: no filter
    filter_gate: float = 3.0  # standard deviations of the pose's noise beyond which a difference is motion


@dataclass(frozen=True, slots=True)
class RenderPreset:
    """How much work the renderer spends on a frame."""

    shadow_map_size: int  # texels a side of a depth map, for each caster and light
    ground_shadow_size: int  # texels a side of its shadow on the ground
    blocker_taps: int  # to find how wide a penumbra is
    soft_taps: int  # over the penumbra
    soft_on_model: bool  # False: shadows on model and real object have one softness, of (2 r + 1)^2 taps
    pcf_radius: int  # that r
    msaa_samples: int  # 0: none
    matches_blur: bool  # the model is blurred as the video is
    matches_noise: bool  # and gets its noise
    matches_lens: bool  # and bends as its lens does; False: the lens is taken off the video
    environment_size: int  # texels a side of what polished surfaces mirror, a power of two


@dataclass(frozen=True, slots=True)
class Quality:
    """One notch on the trade of speed for accuracy."""

    name: str
    tracking: TrackingPreset
    render: RenderPreset


FAST = Quality(
    "fast",
    TrackingPreset(640, 16, False, filter_rest_s=0.5),
    RenderPreset(
        shadow_map_size=512,
        ground_shadow_size=256,
        blocker_taps=8,
        soft_taps=16,
        soft_on_model=False,
        pcf_radius=1,
        msaa_samples=0,
        matches_blur=False,
        matches_noise=False,
        matches_lens=True,
        environment_size=32,
    ),
)
BALANCED = Quality(
    "balanced",
    TrackingPreset(960, 32, True),
    RenderPreset(
        shadow_map_size=1024,
        ground_shadow_size=512,
        blocker_taps=12,
        soft_taps=24,
        soft_on_model=True,
        pcf_radius=1,
        msaa_samples=4,
        matches_blur=True,
        matches_noise=True,
        matches_lens=True,
        environment_size=64,
    ),
)
ACCURATE = Quality(
    "accurate",
    TrackingPreset(1920, 64, True),
    RenderPreset(
        shadow_map_size=2048,
        ground_shadow_size=1024,
        blocker_taps=16,
        soft_taps=48,
        soft_on_model=True,
        pcf_radius=2,
        msaa_samples=8,
        matches_blur=True,
        matches_noise=True,
        matches_lens=True,
        environment_size=128,
    ),
)

QUALITIES: dict[str, Quality] = {quality.name: quality for quality in (FAST, BALANCED, ACCURATE)}
