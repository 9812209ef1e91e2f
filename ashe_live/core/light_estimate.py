"""What an estimator answers: the light of one frame, or why there is none; and a clock for the times of its stages."""

import time
from collections.abc import Mapping
from dataclasses import dataclass, field

from ashe_live.core import arguments
from ashe_live.core.arrays import Mask, set_frozen
from ashe_live.core.ranges import ANGLE
from ashe_live.core.types import Illumination, Light


@dataclass(frozen=True, slots=True, eq=False)
class LightEstimate:
    """An estimator's answer to one frozen frame: the light, and how it was found; or the `reason` why there is none.

    estimator: its name, "proxy" or "paper".
    frame_index: of the frame that it answers for, as `frame.index` of a TrackedFrame.
    illumination: with `seen_in` None; the caller adds the frame by `Illumination.as_seen_in`.
    reason: a message for the user, e.g. "no shadow found beside the object"; without a light there always is one.
    object_mask, shadow_mask: (h, w) bool at the estimator's working size; None where nothing was found.
    timing_ms: by stage, with "total".
    views: indices of the frames that the answer rests on, `frame_index` first.
    span_rad: the largest angle between their directions of view to the marker; None: one view.
    """

    estimator: str
    frame_index: int
    illumination: Illumination
    reason: str | None = None
    object_mask: Mask | None = None
    shadow_mask: Mask | None = None
    timing_ms: Mapping[str, float] = field(default_factory=dict)
    views: tuple[int, ...] = ()
    span_rad: float | None = None

    def __post_init__(self) -> None:
        arguments.instance(self.illumination, Illumination, "illumination")
        if not self.lights and not self.reason:
            raise ValueError("an estimate without a light needs a reason")
        set_frozen(self, views=tuple(self.views) or (self.frame_index,))
        if self.views[0] != self.frame_index:
            raise ValueError(f"the first view of frame {self.frame_index} is itself, not {self.views[0]}")
        if self.span_rad is not None:
            ANGLE.checked(self.span_rad, "span_rad")

    @property
    def light(self) -> Light | None:
        """The strongest light, or None for "no directional light"."""
        return self.illumination.light

    @property
    def lights(self) -> tuple[Light, ...]:
        """As `Illumination.lights`."""
        return self.illumination.lights


class StageClock:
    """Measures milliseconds by stage from its creation on; the time between two `end`s belongs to the second's."""

    def __init__(self) -> None:
        self._begin = self._last = time.perf_counter()
        self._stages: dict[str, float] = {}

    def end(self, stage: str) -> None:
        """Books the time since the last `end` under `stage`."""
        now = time.perf_counter()
        self._stages[stage] = self._stages.get(stage, 0.0) + 1000 * (now - self._last)
        self._last = now

    def timing_ms(self) -> dict[str, float]:
        """Milliseconds by stage, and as "total" those since the beginning."""
        return {**self._stages, "total": 1000 * (time.perf_counter() - self._begin)}
