"""The notches on the trade of speed for accuracy: what `--quality` chooses, each with the parts' own presets.

The estimator of the light has presets of the same names, in its own process (`light/estimators/steps.py`).
"""

from dataclasses import dataclass

from ashe_live.render import preset as rendering
from ashe_live.render.preset import RenderPreset
from ashe_live.tracking import preset as tracking
from ashe_live.tracking.preset import TrackingPreset


@dataclass(frozen=True, slots=True)
class Quality:
    """One notch on the trade of speed for accuracy."""

    name: str
    tracking: TrackingPreset
    render: RenderPreset


FAST = Quality("fast", tracking.FAST, rendering.FAST)
BALANCED = Quality("balanced", tracking.BALANCED, rendering.BALANCED)
ACCURATE = Quality("accurate", tracking.ACCURATE, rendering.ACCURATE)

QUALITIES: dict[str, Quality] = {quality.name: quality for quality in (FAST, BALANCED, ACCURATE)}
