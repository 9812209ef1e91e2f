"""The clock of moving models, which a person can stop."""


class MotionClock:
    """Counts seconds of the caller's clock, which may be a clip's."""

    def __init__(self) -> None:
        self.is_stopped = False
        self.time_s = 0.0  # since the motion began, without the time for which it was stopped
        self._last_s: float | None = None

    def tick(self, now_s: float) -> None:
        """Advances to `now_s`; does nothing while it is stopped, or if the caller's clock went back."""
        if self._last_s is not None and not self.is_stopped:
            self.time_s += max(0.0, now_s - self._last_s)
        self._last_s = now_s

    def toggle(self) -> None:
        self.is_stopped = not self.is_stopped
