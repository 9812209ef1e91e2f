"""The source that is shown in the window: its frames reach the session, its playback the keys and the time bar."""

from ashe_live.errors import UserError
from ashe_live.process.mailbox import Closed
from ashe_live.process.messages import print_message
from ashe_live.viewer.playback import Playback
from ashe_live.viewer.session import Session
from ashe_live.viewer.sources.pipeline import Pipeline


class PlayedSource:
    """The pipeline of the source, how it is played, and why it has ended if it failed. Used by the main thread only."""

    def __init__(self, pipeline: Pipeline, session: Session, loop: bool) -> None:
        self.pipeline = pipeline
        self.playback = Playback(pipeline, session, loop)
        self._session = session
        self._error: str | None = None
        watch = session.watch
        watch.key_views, watch.camera_may_move = pipeline.key_views, pipeline.is_camera
        watch.is_photo = pipeline.is_photo

    @property
    def status(self) -> str | None:
        """A line on what is wrong with the source or holds it up; None if nothing does."""
        return self._error or self.pipeline.stall or self.pipeline.status

    @property
    def is_at_last_frame(self) -> bool:
        """Whether its last frame is shown: no other comes of a photo, and at a clip's end."""
        return self._session.tracked is not None and (self.pipeline.is_photo or self.pipeline.has_ended)

    def take_frame(self, now_s: float) -> bool:
        """Hands a new frame to the session; returns whether there is one.

        If the source fails after the first one, its last picture stays, and the error is printed. Raises UserError if
        it fails before.
        """
        if self._error is not None:
            return False
        try:
            tracked = self.pipeline.frames.take(0.0)
        except Closed:
            return False
        except UserError as error:
            if self._session.tracked is None:
                raise
            self._error = str(error)
            print_message(error)
            return False
        if tracked is None:
            return False
        self._session.take(tracked, now_s)
        return True
