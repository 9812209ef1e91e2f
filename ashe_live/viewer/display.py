"""Turns the session's state into scenes: the bare picture, and the one with the heads-up display over it."""

import math
from dataclasses import dataclass, replace

import numpy as np

from ashe_live.core.arrays import frozen_view
from ashe_live.core.camera import Size
from ashe_live.core.types import TrackedFrame
from ashe_live.render.gl.framing import corners_of, framing, letterbox
from ashe_live.render.hud import Hud, HudText
from ashe_live.render.scene import Overlay, Scene
from ashe_live.render.screen import Screen
from ashe_live.viewer.drawn.estimate_inset import EstimateInset, Span
from ashe_live.viewer.drawn.time_bar import Moment, TimeBar, bar_at
from ashe_live.viewer.session import Session
from ashe_live.viewer.status import source_lines, status_lines

# Numbers that change with every frame are updated this often: to be legible, and because drawing text takes as long as
# tracking does.
READINGS_SHOWN_FOR_S = 0.5
LINE_PT = 1.5  # width of the line between the halves of a split picture
SPLIT_LINE = frozen_view(np.array((246, 246, 242, 160), np.uint8).reshape(1, 1, 4))


def bare_scene(session: Session) -> Scene:
    """Video, models and light, as recordings and snapshots want them."""
    models = [(model, placement) for _, model, placement in session.arrangement.models(session.tracked)]
    (model, placement), *others = models
    parts, lit_in_video = session.view.parts, session.estimated_light
    return Scene(
        session.tracked,
        model if parts.shows_model or parts.casts_shadow else None,
        session.shown,
        session.view.shows_light,
        placement=placement,
        others=tuple(others),
        casts_shadow=parts.casts_shadow,
        shows_model=parts.shows_model,
        covers_marker=session.covers_marker,
        lit_in_video=None if session.shown is lit_in_video else lit_in_video,
        is_split=parts.is_split,
        time_s=session.table.motion_s,
    )


def cut_out(scene: Scene) -> Scene:
    """Models and shadows alone, with their transparency, and without the arrow."""
    return replace(scene, is_cut_out=True, shows_light=False)


@dataclass(frozen=True, slots=True)
class Readings:
    """What is shown beside the session's own state."""

    quality: str
    fps: float | None = None
    source_status: str | None = None
    moment: Moment | None = None  # None: without the time bar


class Display:
    """Composes scenes, and caches what has not changed, so that it is neither drawn nor uploaded again."""

    def __init__(self) -> None:
        self._hud = Hud()
        self._time_bar = TimeBar()
        self._inset = EstimateInset()
        self._name = ""  # of the model in hand, once that is drawn
        self._steady: tuple[float | None, TrackedFrame | None] = (None, None)
        self._read_s = -math.inf

    def scene(self, session: Session, screen: Screen, readings: Readings, now_s: float) -> Scene:
        """The bare scene under status, masks and time bar, or under the help."""
        if session.view.help.is_shown:  # a small window has no room for anything beside it
            overlays = self._hud.overlays(HudText(help=session.view.help.rows(screen)), screen)
        else:
            overlays = self._overlays(session, screen, readings, now_s)
        return replace(bare_scene(session), overlays=overlays, is_mirrored=session.view.is_mirrored)

    def _overlays(self, session: Session, screen: Screen, readings: Readings, now_s: float) -> tuple[Overlay, ...]:
        text = self._text(session, readings, now_s)
        models = _span_of_models(session, screen.size) if session.view.shows_steps else None
        bar: tuple[Overlay, ...] = ()
        if readings.moment is not None and session.view.has_time_bar:
            bar = self._time_bar.overlays(readings.moment, screen)
            height = bar_at(screen, readings.moment.duration_s).height
            screen = screen.without_bottom(height)  # everything else stands above it
        width, height = screen.size
        halves: tuple[Overlay, ...] = ()  # below all text, which it would cross out
        if session.view.parts.is_split:
            line = max(1, screen.px(LINE_PT))
            halves = (Overlay(SPLIT_LINE, (width - line) // 2, 0, (line, height)),)
        masks = self._masks(session, screen.size, models)
        free_width = min((mask.left_px for mask in masks), default=width)
        return (*halves, *masks, *self._hud.overlays(text, screen, free_width), *bar)

    def _text(self, session: Session, readings: Readings, now_s: float) -> HudText:
        fps, marker = self._steady_readings(readings.fps, session.tracked, now_s)
        if not self._name or session.table.is_drawn:
            self._name = session.table.in_hand_text
        # Also while they are hidden: the wait for a model counts from when it was first asked about.
        status = status_lines(session, fps, readings.quality, marker, self._name)
        text = HudText(tuple(status), tuple(source_lines(session, readings.source_status, now_s)))
        return text if session.view.shows_hud else HudText()

    def _steady_readings(
        self, fps: float | None, tracked: TrackedFrame | None, now_s: float
    ) -> tuple[float | None, TrackedFrame | None]:
        """The frame rate and the tracked frame whose numbers are shown; a marker lost or found is shown at once."""
        fps_read, marker_read = self._steady
        is_current = 0 <= now_s - self._read_s < READINGS_SHOWN_FOR_S and (fps_read is None) == (fps is None)
        if not is_current or _has_marker(marker_read) != _has_marker(tracked):
            self._steady, self._read_s = (fps, tracked), now_s
        return self._steady

    def _masks(self, session: Session, size: Size, models: Span | None) -> tuple[Overlay, ...]:
        answer = session.answer
        if not session.view.shows_steps or answer is None:
            return ()
        return self._inset.overlays(answer, size, models, session.view.is_mirrored)


def _span_of_models(session: Session, framebuffer: Size) -> Span | None:
    """Where the picture shows the models, without the lens's distortion; None where none is in view."""
    tracked = session.tracked
    boxes = [corners_of(model, placement) for _, model, placement in session.arrangement.models(tracked) if placement]
    if tracked is None or tracked.marker is None or not boxes:
        return None
    viewport = letterbox(tracked.frame.size, framebuffer)
    seen = framing(tracked.camera, tracked.marker.T_cam_marker, np.concatenate(boxes), viewport)
    if seen is None:
        return None
    left, bottom, width, height = seen.region
    left = framebuffer[0] - left - width if session.view.is_mirrored else left
    return Span(left, framebuffer[1] - bottom - height, left + width, framebuffer[1] - bottom)


def _has_marker(tracked: TrackedFrame | None) -> bool | None:
    return None if tracked is None else tracked.marker is not None
