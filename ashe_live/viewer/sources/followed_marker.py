"""Which marker is followed, and with what field of view: found, offered, and chosen by keys."""

from collections.abc import Callable, Sequence

from ashe_live.core.camera import Camera, Size
from ashe_live.render.renderer import SceneRenderer
from ashe_live.tracking.families.layout import in_words, is_of_cube
from ashe_live.viewer.session import Session
from ashe_live.viewer.sources.marker_hunt import MarkerHunt
from ashe_live.viewer.sources.pipeline import Pipeline

CAMERA_FLAGS = ("--camera-file", "--focal-px", "--hfov")  # of which a command takes one
FIELDS_OF_VIEW_DEG = (50.0, 60.0, 70.0, 80.0)  # of webcams and phones, across the longer side of their pictures


class FollowedMarker:
    """The marker and the field of view for the source that is played. Used by the main thread only."""

    def __init__(
        self,
        pipeline: Pipeline,
        session: Session,
        renderer: SceneRenderer,
        announce: Callable[[str, float], None],
        takes_any_marker: bool,
    ) -> None:
        """`announce` shows a line in the window, at a time in seconds, and prints it.

        takes_any_marker: whether the only one in view is followed, as nobody has named another.
        """
        self._takes_any_marker = takes_any_marker
        self._session = session
        self._renderer = renderer
        self._announce = announce
        self.begin_anew(pipeline)

    def begin_anew(self, pipeline: Pipeline) -> None:
        """Forgets what was chosen for the last source."""
        self._pipeline = pipeline
        self._session.arrangement.followed = pipeline.marker
        self._hunt = MarkerHunt()
        self._fov_deg: float | None = None  # a person's choice of FIELDS_OF_VIEW_DEG
        self._size: Size | None = None  # of the last picture

    def flags(self, given: Sequence[str]) -> list[str]:
        """The flags that make the same choices from the start: those `given`, as --flag=value, and what replaces some.

        Nothing replaces them for a clip whose marker is known anyway.
        """
        if not self._pipeline.may_follow_others:
            return [*given]
        chosen, replaced = [f"--marker={self._pipeline.marker}"], ["--marker"]
        if self._hfov_deg is not None:
            chosen.append(f"--hfov={self._hfov_deg:g}")
            replaced += CAMERA_FLAGS
        if is_of_cube(self._pipeline.marker):  # which casts the shadow itself
            replaced.append("--caster")
        return [*(flag for flag in given if flag.partition("=")[0] not in replaced), *chosen]

    @property
    def _hfov_deg(self) -> float | None:
        """The horizontal field of view, in whole degrees, that follows from a person's choice; None without one."""
        if self._fov_deg is None or self._size is None:
            return None
        return float(round(Camera.from_longer_side(self._size, self._fov_deg).hfov_deg))

    def look(self, now_s: float) -> None:
        """Says which other markers are in view; follows the only one if nobody has named any."""
        session = self._session
        if not self._pipeline.may_follow_others:
            return
        is_news = self._hunt.look(session.tracked, now_s)
        session.seen_instead = self._hunt.seen_instead
        if (answer := self._hunt.take_answer()) is not None:
            self._take_next(answer, now_s)
        elif is_news and self._takes_any_marker and not session.room_light.has_seen_marker:
            # The first frames after a change are still those in which the new marker was not looked for.
            own = {self._pipeline.marker, *(stand.marker for stand in session.arrangement.stands)}
            free = [spec for spec in self._hunt.seen_instead.in_view if spec not in own]
            if len(free) == 1:
                self._follow(free[0], now_s)

    def follow_other(self, now_s: float) -> None:
        """Follows another marker in view; while the one that is followed is there, others are looked for first."""
        others = [spec for spec in self._hunt.seen_instead.in_view if spec != self._pipeline.marker]
        if others:
            self._follow(others[0], now_s)
        elif not self._pipeline.may_follow_others:
            self._session.say("the demo's marker is known: there is no other to follow", now_s)
        else:
            self._hunt.ask()
            self._session.say("looking for other markers", now_s)

    def next_field_of_view(self, now_s: float) -> None:
        """Assumes the next of FIELDS_OF_VIEW_DEG; after the last, what is known or estimated without a choice."""
        if not self._pipeline.may_follow_others:
            self._session.say("the demo's camera is known, and so its field of view", now_s)
            return
        tracked = self._session.tracked
        self._size = self._size if tracked is None else tracked.frame.size
        if self._size is None:
            return
        choices = (None, *FIELDS_OF_VIEW_DEG)
        self._fov_deg = choices[(choices.index(self._fov_deg) + 1) % len(choices)]
        self._pipeline.see_by(self._hfov_deg)
        self._begin_session_anew()
        if self._hfov_deg is None:
            self._announce("the field of view is as it was at the start", now_s)
        else:
            said = f"--hfov {self._hfov_deg:g} sets this from the start"
            self._announce(f"the field of view is taken for {self._hfov_deg:g}° now: {said}, G goes on", now_s)

    def _take_next(self, in_view: tuple[str, ...], now_s: float) -> None:
        """Follows the next marker in the order of their names, so that asking again and again goes round."""
        present = self._pipeline.marker
        others = sorted(spec for spec in in_view if spec != present)
        if not others:
            self._session.say("no other marker is in view", now_s)
            return
        later = [spec for spec in others if spec > present]
        self._follow((later or others)[0], now_s)

    def _follow(self, spec: str, now_s: float) -> None:
        self._pipeline.follow(spec)
        self._session.arrangement.followed = spec
        self._begin_session_anew()
        self._hunt = MarkerHunt()
        self._announce(f"{in_words(spec)} is followed now: --marker {spec} names it from the start", now_s)

    def _begin_session_anew(self) -> None:
        if self._session.room_light.has_seen_marker:
            self._session.begin_anew(self._pipeline.is_photo)
            self._renderer.begin_anew()  # the ground over the last marker is not that around another
