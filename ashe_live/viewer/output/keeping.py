"""Snapshots and recordings: what is shown, without text and at the video's own size."""

import json
import shlex
from collections.abc import Callable
from datetime import datetime
from pathlib import Path

from ashe_live.capture.snapshot import write_png
from ashe_live.core.arrays import Image
from ashe_live.core.camera import drawn_size
from ashe_live.core.contract import SNAPSHOT_KEYWORD, Json, estimated_light_json, light_by_hand_json, snapshot_json
from ashe_live.core.types import TrackedFrame
from ashe_live.errors import UserError
from ashe_live.files.writing import unused, unused_name, write_json
from ashe_live.render.lights.light_map import write_light_map
from ashe_live.render.renderer import SceneRenderer
from ashe_live.render.scene import Scene
from ashe_live.viewer.display import bare_scene, cut_out
from ashe_live.viewer.output.as_shown import AsShown, shown_now
from ashe_live.viewer.output.recording import Recording
from ashe_live.viewer.session import Session
from ashe_live.viewer.view_options import NEXT_PARTS

COVER_NOTE = ", with the ground over the marker: C first leaves it out"
NOTHING_SHOWN = f"neither model nor shadow is shown that could be saved alone: {NEXT_PARTS}"


class Keeper:
    """Takes snapshots and recordings; while neither is asked for, it renders nothing."""

    def __init__(
        self,
        shown: SceneRenderer,
        session: Session,
        announce: Callable[[str, float], None],
        recording: Recording | None,
    ) -> None:
        """`shown`: the window's renderer. `recording`: one that has begun.

        `announce` shows a line in the window, at a time in seconds, and prints it.
        """
        self._shown = shown
        self._session = session
        self._announce = announce
        self._recording = recording
        self._renderer: SceneRenderer | None = None
        self.clip_path: Path | None = None  # of the clip that is played, if it is one that can be played again
        self.flags: Callable[[], list[str]] = list  # of the command that would play it again
        self._as_shown = AsShown()

    @property
    def is_recording(self) -> bool:
        return self._recording is not None

    def snapshot(self, now_s: float, is_cut_out: bool = False) -> None:
        """Writes a PNG that carries the estimate into the current folder; does nothing before the first frame.

        `is_cut_out`: without the video, and with transparency.
        """
        session = self._session
        if session.tracked is None:
            return
        scene = bare_scene(session)
        if is_cut_out and not (scene.shows_model or scene.casts_shadow):
            self._announce(NOTHING_SHOWN, now_s)
            return
        scene = cut_out(scene) if is_cut_out else scene
        has_cover = is_cut_out and scene.shows_cover and session.tracked.marker is not None
        texts = {SNAPSHOT_KEYWORD: json.dumps(self._known(session.tracked))}
        try:
            path = write_png(_new_path(".png"), self._picture(scene), texts=texts, beside=True)
            self._announce(f"saved {path}{COVER_NOTE if has_cover else ''}", now_s)
        except UserError as error:
            self._announce(str(error), now_s)

    def light(self, now_s: float) -> None:
        """Writes the light as a radiance map, and what else is known of it as JSON, into the current folder."""
        session = self._session
        if session.tracked is None:
            return
        if session.lit_by.light is None:
            self._announce(f"no light is known yet: {session.watch.how_it_gets_known}, or drag in the picture", now_s)
            return
        try:
            path = write_light_map(_new_path(".hdr"), session.lit_by, beside=True)
            record = write_json(unused(path.with_suffix(".json")), self._known(session.tracked), beside=True)
            self._announce(f"saved {path} and {record.name}", now_s)
        except UserError as error:
            self._announce(str(error), now_s)

    def _known(self, tracked: TrackedFrame) -> Json:
        session, hand = self._session, self._session.hand
        light = None if session.estimate_now is None else estimated_light_json(session.estimate_now)
        if hand.light is not None:
            light = light_by_hand_json(hand.light, hand.frame_index)
        models = [
            (Path(name).name, None if placement is None else placement.marker_from_placed)
            for name, _, placement in session.arrangement.models(tracked)
        ]
        return snapshot_json(tracked, models, light)

    def record(self, fps: float, now_s: float) -> None:
        """Begins a recording in the current folder, or ends the one under way."""
        if self._recording is not None:
            self.finish(now_s)
            return
        if self._session.tracked is None:
            return
        try:
            path = _new_path(".mp4")
            self._recording = Recording(path, drawn_size(self._session.tracked.frame.size), fps)
            self._session.say(f"recording {path}: V stops", now_s)
        except UserError as error:
            self._announce(str(error), now_s)

    def take(self, is_new: bool, now_s: float) -> bool:
        """Adds what is shown to the recording if a picture is due; returns whether it was added.

        `is_new`: it has a frame of the source that was not shown before.
        """
        if self._recording is None or self._session.tracked is None:
            return False
        # All frames of a clip have one size, so another source ends the recording.
        if self._recording.size == drawn_size(self._session.tracked.frame.size):
            frame = self._session.tracked.frame.index
            if self.clip_path is not None:
                self._as_shown.add(frame, shown_now(self._session))
            new_frame = frame if is_new else None
            is_taken = self._recording.take(lambda: self._picture(bare_scene(self._session)), new_frame, now_s)
            if self._recording.failure is None:
                return is_taken
        self.finish(now_s)
        return False

    def finish(self, now_s: float) -> None:
        """Ends the recording, if there is one."""
        if self._recording is not None:
            recording, self._recording = self._recording, None
            as_shown, self._as_shown = self._as_shown, AsShown()
            said = recording.finish()
            # A full disk, or a folder that has gone, would not take the command's file either.
            if self.clip_path is not None and recording.failure is None and recording.has_gaps:
                said += f"; all frames of the clip: {self._command(self.clip_path, recording.path, as_shown)}"
            self._announce(said, now_s)

    def _command(self, clip: Path, recorded: Path, as_shown: AsShown) -> str:
        """The command that plays the clip with models and light as they were; writes the file that it reads."""
        # A clip with a known light is the shipped one: it is played by `demo`, as nobody has its file at hand.
        is_demo = self._session.true_to_light_marker is not None
        words = ["demo"] if is_demo else ["play", str(clip)]
        for chosen in self._session.arrangement.chosen:
            words += ["--model", chosen.name if chosen.marker is None else f"{chosen.marker}={chosen.name}"]
        words += [*self.flags(), *(["--auto"] if self._session.automatic else [])]
        if is_demo or not as_shown.is_plain:  # without the file the demo would draw its text into the picture
            try:
                path = write_json(unused(recorded.with_suffix(".json")), as_shown.to_json(), beside=True)
                words += ["--as-shown", str(path)]
            except UserError as error:
                return f"not as it was moved by hand: {error}"
        return shlex.join(["ashe-live", *words, "--headless", "--out", "FILE.mp4"])

    def _picture(self, scene: Scene) -> Image:
        """(h, w, 3) uint8 BGR, or BGRA where it is cut out."""
        assert self._session.tracked is not None
        size = drawn_size(self._session.tracked.frame.size)
        if self._renderer is None:
            self._renderer = self._shown.beside(size)
        if self._renderer.size != size:
            self._renderer.resize(size)
        self._renderer.preset = self._shown.preset
        # A snapshot must show the model that was chosen; a recording must not stall the window.
        self._renderer.render(scene, waits=self._recording is None)
        return self._renderer.read_bgra() if scene.is_cut_out else self._renderer.read_bgr()


def _new_path(suffix: str) -> Path:
    """An unused name in the current folder. Raises UserError where that is gone."""
    try:
        folder = Path.cwd()
    except OSError:
        raise UserError("the current folder has been deleted", "start in one that is there") from None
    return unused_name(folder, "ashe-live", suffix, datetime.now())
