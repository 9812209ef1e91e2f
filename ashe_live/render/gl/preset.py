"""The renderer's presets: frozen records of counts and sizes that its passes read, whatever they are called."""

from dataclasses import dataclass, replace


@dataclass(frozen=True, slots=True)
class RenderPreset:
    """How much work the renderer spends on a frame."""

    shadow_map_size: int  # texels a side of a depth map, for each caster and light
    ground_shadow_size: int  # texels a side of its shadow on the ground
    blocker_taps: int  # samples that find how wide a penumbra is
    soft_taps: int  # samples over the penumbra
    soft_on_model: bool  # False: shadows on model and real object have one softness, of (2 r + 1)^2 samples
    pcf_radius: int  # the r of these
    msaa_samples: int  # a pixel, on a GPU; 0: one, and outlines are smoothed afterwards
    software_msaa_samples: int  # the same where the processor draws, which they cost up to twice a picture's time
    environment_size: int  # texels a side of what polished surfaces mirror, a power of two
    matches_blur: bool = True  # whether model and shadow are blurred as the video is
    matches_noise: bool = True  # whether they get its noise
    matches_outline: bool = True  # whether they end at the real object's outline in it

    def with_samples(self, count: int) -> "RenderPreset":
        """The same with `count` samples a pixel, whatever draws."""
        return replace(self, msaa_samples=count, software_msaa_samples=count)

    @property
    def offline(self) -> "RenderPreset":
        """The same for pictures that no display waits for: as many samples a pixel where the processor draws."""
        return self.with_samples(self.msaa_samples)


FAST = RenderPreset(
    shadow_map_size=512,
    ground_shadow_size=256,
    blocker_taps=8,
    soft_taps=16,
    soft_on_model=False,
    pcf_radius=1,
    msaa_samples=0,
    software_msaa_samples=0,
    environment_size=32,
)
BALANCED = RenderPreset(
    shadow_map_size=1024,
    ground_shadow_size=512,
    blocker_taps=12,
    soft_taps=24,
    soft_on_model=True,
    pcf_radius=1,
    msaa_samples=4,
    software_msaa_samples=0,
    environment_size=64,
)
ACCURATE = RenderPreset(
    shadow_map_size=2048,
    ground_shadow_size=1024,
    blocker_taps=16,
    soft_taps=48,
    soft_on_model=True,
    pcf_radius=2,
    msaa_samples=8,
    software_msaa_samples=8,
    environment_size=128,
)
