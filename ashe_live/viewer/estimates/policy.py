"""Decides when the light is estimated without a request."""

from dataclasses import dataclass

from ashe_live.core.types import TrackedFrame


@dataclass(frozen=True, slots=True)
class EstimatePolicy:
    """When the light is estimated without a request."""

    on_first_steady: bool = False
    at_frame: int | None = None
    automatic: bool = False  # the light is watched, and estimated anew when it changes

    def wants(self, tracked: TrackedFrame, is_steady: bool) -> bool:
        if self.at_frame is not None:
            return tracked.frame.index >= self.at_frame  # that one may have come too late to be tracked
        return self.on_first_steady and is_steady
