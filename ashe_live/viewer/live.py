"""The main thread's loop: handles input, takes the latest tracked frame, and draws at the display's own rate."""

import contextlib
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

from ashe_live.errors import UserError
from ashe_live.process.messages import print_answer
from ashe_live.render.renderer import SceneRenderer
from ashe_live.viewer.display import Display, Readings
from ashe_live.viewer.hands.gestures import Gestures
from ashe_live.viewer.hands.menu import Menu, entries_for
from ashe_live.viewer.hands.pointing import in_mirror, in_video
from ashe_live.viewer.hands.requests import Command, Files, Request
from ashe_live.viewer.output.keeping import Keeper
from ashe_live.viewer.output.recording import Recording
from ashe_live.viewer.quality_choice import QualityChoice
from ashe_live.viewer.session import Session
from ashe_live.viewer.sources.followed_marker import FollowedMarker
from ashe_live.viewer.sources.opening import Opener, Opening, of_each_kind, paths_in
from ashe_live.viewer.sources.pipeline import Pipeline
from ashe_live.viewer.sources.played_source import PlayedSource
from ashe_live.viewer.status import light_line
from ashe_live.viewer.stillness import Stillness
from ashe_live.viewer.windows.window import Window
from ashe_live.viewer.windows.x_errors import finished_if_the_display_goes

OF_FIRST_SOURCE = "--estimate-at="  # the flag that counts frames of it, and so says nothing of a later one
IDLE_S = 0.1  # the longest wait for an event, or for a frame of the source, while nothing changes


@dataclass(frozen=True, slots=True)
class ViewerOptions:
    """What a person asked for at the start."""

    quality: str  # one of quality_choice.NAMES
    loop: bool = False
    recording: Recording | None = None  # one that has begun
    opener: Opener | None = None  # of later sources; None: there will be none
    takes_any_marker: bool = False  # follows the only one in view, as nobody has named another
    flags: tuple[str, ...] = ()  # of the command line, as --flag=value, for a command that plays the same again


class LiveViewer:
    """All that needs the window: drawing, recording, and the requests that the session does not handle."""

    def __init__(
        self, window: Window, renderer: SceneRenderer, pipeline: Pipeline, session: Session, options: ViewerOptions
    ) -> None:
        self._window = window
        self._renderer = renderer
        self._session = session
        self._display = Display()
        self._gestures = Gestures(window.screen.content_scale)
        self._menu = Menu()
        self._interval_s = 1 / window.refresh_rate_hz
        self._quality = QualityChoice(options.quality, self._interval_s, renderer, session)
        self._keeper = Keeper(renderer, session, self._announce, options.recording)
        self._opening = Opening(options.opener)
        self._loop = options.loop
        self._quit = False
        self._take_up(pipeline)
        self.followed = FollowedMarker(pipeline, session, renderer, self._announce, options.takes_any_marker)
        self._flags = options.flags
        self._keeper.flags = lambda: self.followed.flags(self._flags)
        self._stillness = Stillness(window.refresh_rate_hz)
        self._commands: dict[Command, Callable[[float], None]] = {
            Command.SNAPSHOT: self._keeper.snapshot,
            Command.CUT_OUT: lambda now_s: self._keeper.snapshot(now_s, is_cut_out=True),
            Command.KEEP_LIGHT: self._keeper.light,
            Command.RECORD: lambda now_s: self._keeper.record(self._source.pipeline.fps, now_s),
            Command.QUALITY: lambda _now: self._quality.step(self._source.pipeline),
            Command.FULLSCREEN: lambda _now: self._window.toggle_fullscreen(),
            Command.LEAVE: lambda _now: self._leave(),
            Command.FOLLOW_OTHER: self.followed.follow_other,
            Command.FIELD_OF_VIEW: self.followed.next_field_of_view,
            Command.NEXT_CAMERA: lambda _now: self._opening.begin(None),
        }

    def run(self, frame_limit: int | None = None, end_if_asked: Callable[[], None] = lambda: None) -> None:
        """Runs until the window is closed or left, or for `frame_limit` frames; always finishes a recording.

        Frames are those of the recording while there is one, or else the source's, whose last one counts as often as it
        is drawn: of a photo, and at a clip's end, no other comes.
        `end_if_asked`: called before each picture; what it raises ends the viewer.
        """
        self._quality.begin(self._source.pipeline)
        frames_left = frame_limit
        due_s = time.monotonic()
        with contextlib.ExitStack() as ending:  # the last first, and each also where one before it fails
            ending.callback(lambda: self._source.pipeline.close())
            ending.callback(self._opening.close)
            ending.callback(self._session.arrangement.keep_places)
            ending.callback(lambda: self._keeper.finish(time.monotonic()))
            ending.enter_context(finished_if_the_display_goes(ending.close))
            while not (self._quit or self._window.is_closing):
                end_if_asked()
                now_s, begun_s = time.monotonic(), time.perf_counter()
                due_s = max(due_s + self._interval_s, now_s)
                for request in self._window.take_requests(0.0):
                    self._obey(request, now_s)
                self._follow_mouse(now_s)
                self.followed.look(now_s)
                is_new = self._take_opened(now_s) or self._source.take_frame(now_s)
                self._draw(now_s)
                if not self._is_idle:  # which says nothing of how long a picture takes
                    self._quality.adapt(self._source.pipeline, begun_s)
                self._window.swap()
                self._stillness.shown()
                is_counted = is_new or self._source.is_at_last_frame
                if self._keeper.is_recording:
                    is_counted = self._keeper.take(is_new, now_s)
                if is_counted and frames_left is not None:
                    frames_left -= 1
                    self._quit = self._quit or frames_left <= 0
                self._idle_until(max(due_s, now_s + IDLE_S) if self._is_idle else due_s)

    def _idle_until(self, due_s: float) -> None:
        """Waits until the next picture is due, as `swap` does not wait without vertical sync (a virtual display)."""
        while (left_s := due_s - time.monotonic()) > 0 and not self._window.is_closing:
            for request in self._window.take_requests(left_s):
                self._obey(request, time.monotonic())
            # Any event ends the wait for an idle picture: a key is obeyed, and the mouse followed, at once.
            if self._is_idle and time.monotonic() < due_s:
                return

    def _draw(self, now_s: float) -> None:
        if self._source.pipeline.has_ended:
            self._session.settle_for_last(now_s)
        # An estimate that agrees with those before it is not printed again.
        if (new := self._session.poll(now_s)) is not None and new.is_news:
            print_answer(light_line(self._session))
        screen = self._window.screen
        if screen.is_minimised:
            return
        if screen.size != self._renderer.size:
            self._renderer.resize(screen.size)
        status = self._opening.progress or self._source.status
        moment = self._source.playback.moment(self._session.tracked, now_s)
        recording = "recording" if self._keeper.is_recording else ""
        manner = "   ".join(filter(None, (self._quality.shown, self._source.playback.pace_shown, recording)))
        self._session.table.drawn = self._renderer.shown_models
        self._session.view.cover_is_drawn = self._renderer.covers_marker
        readings = Readings(manner, self._stillness.fps(self._is_idle), status, moment)
        scene = self._display.scene(self._session, screen, readings, now_s)
        if menu := self._menu.overlays(screen):
            scene = replace(scene, overlays=menu)  # without the other text, over which it could not be read
        self._stillness.add(scene, screen.size, self._renderer.preset, self._renderer.is_settled)
        # Nothing changes (a pause, a photo, the end of a clip): the last picture is shown again.
        if not self._is_idle:
            self._renderer.render(scene, waits=False)
        self._window.present(self._renderer)

    @property
    def _is_idle(self) -> bool:
        """Whether the picture has not changed for some time, or the window is minimised."""
        return self._stillness.is_still or self._window.screen.is_minimised

    def _obey(self, request: Request, now_s: float) -> None:
        framebuffer = self._window.screen.size
        if self._session.view.is_mirrored:
            request = in_mirror(request, framebuffer)
        request = in_video(request, framebuffer, self._session.tracked)
        if request.command is Command.OPEN:
            dropped = request.argument
            self._open(dropped.paths if isinstance(dropped, Files) else paths_in(self._window.clipboard), now_s)
            return
        if not (self._session.handle(request, now_s) or self._source.playback.handle(request, now_s)):
            self._commands[request.command](now_s)

    def _follow_mouse(self, now_s: float) -> None:
        screen = self._window.screen
        for event in self._window.take_mouse():
            if self._menu.take_mouse(event, lambda: entries_for(*self._session.table.offered), screen):
                if (chosen := self._menu.take_request()) is not None:
                    self._obey(chosen, now_s)
                continue
            if self._source.playback.take_mouse(event, screen, now_s):
                continue
            if (request := self._gestures.add(event, now_s)) is not None:
                self._obey(request, now_s)

    def _open(self, paths: tuple[str, ...], now_s: float) -> None:
        if not paths:
            self._session.say("nothing to open: copy a file, or its path, and press Ctrl+V", now_s)
        models, sources = of_each_kind(paths)
        if models:
            self._session.table.shelf.add(*models)
        if len(models) > 1:
            self._session.say(f"{len(models)} models joined the others: Left and Right choose", now_s)
        if sources:
            self._opening.begin(Path(sources[0]))
        if len(sources) > 1:
            self._session.say(f"of {len(sources)} clips and photos the first one is opened", now_s)

    def _take_opened(self, now_s: float) -> bool:
        """Switches to a newly opened source; returns whether there was one. A recording ends with the old source."""
        try:
            opened = self._opening.take()
        except UserError as error:
            self._announce(str(error), now_s)
            return False
        if opened is None:
            return False
        self._keeper.finish(now_s)
        self._source.pipeline.close(0.0)
        self._flags = tuple(flag for flag in self._flags if not flag.startswith(OF_FIRST_SOURCE))
        self.followed.begin_anew(opened.pipeline)
        self._session.begin_anew(opened.pipeline.is_photo)  # forgets views, of which the new one may have some by now
        self._take_up(opened.pipeline)
        self._renderer.begin_anew()
        self._source.pipeline.track_with(self._quality.now.tracking)
        self._session.take(opened.first, now_s)
        self._window.set_title(f"ashe-live: {opened.name}")
        return True

    def _take_up(self, pipeline: Pipeline) -> None:
        self._source = PlayedSource(pipeline, self._session, self._loop)
        self._keeper.clip_path = pipeline.clip_path

    def _leave(self) -> None:
        """Leaves one of these, the first that applies: the menu, the help, fullscreen, the program."""
        if self._menu.is_open:
            self._menu.close()
        elif self._session.view.help.is_shown:
            self._session.view.help.close()
        elif self._window.is_fullscreen:
            self._window.toggle_fullscreen()
        else:
            self._quit = True

    def _announce(self, text: str, now_s: float) -> None:
        """Shows a line in the window for a while, and prints it on the terminal."""
        self._session.say(text, now_s)
        print_answer(text)
