"""The notches on the trade of speed for accuracy: what `--quality` chooses, each with the parts' own presets.

They are values without what they configure: knowing them loads neither OpenCV nor OpenGL.
"""

from dataclasses import dataclass

from ashe_live.core import arguments
from ashe_live.light.estimators import preset as lighting
from ashe_live.light.estimators.preset import ProxyPreset
from ashe_live.render.gl import preset as rendering
from ashe_live.render.gl.preset import RenderPreset
from ashe_live.tracking import preset as tracking
from ashe_live.tracking.preset import TrackingPreset


@dataclass(frozen=True, slots=True)
class Quality:
    """One notch on the trade of speed for accuracy."""

    name: str
    tracking: TrackingPreset
    render: RenderPreset
    light: ProxyPreset  # of the estimator `proxy`, which runs in a process of its own


FAST = Quality("fast", tracking.FAST, rendering.FAST, lighting.FAST)
BALANCED = Quality("balanced", tracking.BALANCED, rendering.BALANCED, lighting.BALANCED)
ACCURATE = Quality("accurate", tracking.ACCURATE, rendering.ACCURATE, lighting.ACCURATE)

QUALITIES: dict[str, Quality] = {quality.name: quality for quality in (FAST, BALANCED, ACCURATE)}
LIGHT_PRESETS: dict[str, ProxyPreset] = {name: quality.light for name, quality in QUALITIES.items()}


def quality_named(name: str) -> Quality:
    """Raises ValueError, which lists the known ones, or TypeError for what is no text."""
    return QUALITIES[arguments.one_of(name, QUALITIES, "quality")]
