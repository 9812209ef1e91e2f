"""The quality that a person has chosen, applied to whatever tracks, draws and estimates."""

import time

from ashe_live.quality import BALANCED, QUALITIES, Quality
from ashe_live.render.renderer import SceneRenderer
from ashe_live.viewer.auto_quality import AutoQuality
from ashe_live.viewer.session import Session
from ashe_live.viewer.sources.pipeline import Pipeline

AUTO = "auto"
NAMES = (*QUALITIES, AUTO)


class QualityChoice:
    """The choice, one of NAMES, and the preset that follows from it now."""

    def __init__(self, name: str, interval_s: float, renderer: SceneRenderer, session: Session) -> None:
        """`interval_s`: the time between two pictures of the display."""
        self.name = name
        self._interval_s = interval_s
        self._renderer = renderer
        self._session = session
        self._auto: AutoQuality | None = None

    @property
    def now(self) -> Quality:
        return QUALITIES.get(self.name, BALANCED) if self._auto is None else self._auto.quality

    @property
    def shown(self) -> str:
        """The choice in words; with `auto` also the preset in force."""
        return self.name if self._auto is None else f"{AUTO} ({self.now.name})"

    def begin(self, pipeline: Pipeline) -> None:
        """Puts the choice into force; `auto` begins with the preset in the middle."""
        self._auto = AutoQuality(self._interval_s * 1e3, BALANCED) if self.name == AUTO else None
        # The estimator has a process of its own: its preset need not step down when the renderer's does.
        watch = self._session.watch
        watch.preset = self.now.light.assuming(watch.preset.light, watch.preset.caster)
        self._apply(pipeline)

    def step(self, pipeline: Pipeline) -> None:
        """Goes on to the next of NAMES."""
        self.name = NAMES[(NAMES.index(self.name) + 1) % len(NAMES)]
        self.begin(pipeline)

    def adapt(self, pipeline: Pipeline, begun_s: float) -> None:
        """With `auto`, adapts the preset to how long tracking or drawing took for the picture begun at `begun_s`.

        By `time.perf_counter`, as Windows' monotonic clock goes on every 16 ms only, up to Python 3.12.
        """
        if self._auto is None:
            return
        # Commands that are only queued have cost nothing yet.
        self._renderer.finish()
        draw_ms = (time.perf_counter() - begun_s) * 1e3
        detect_ms = self._session.tracked.detect_ms if self._session.tracked is not None else 0.0
        if self._auto.add(max(draw_ms, detect_ms)):
            self._apply(pipeline)

    def _apply(self, pipeline: Pipeline) -> None:
        self._renderer.preset = self.now.render
        pipeline.track_with(self.now.tracking)
