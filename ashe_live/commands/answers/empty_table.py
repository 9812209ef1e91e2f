"""The picture of the table without the object, which `--empty` names."""

from dataclasses import dataclass, replace
from pathlib import Path

from ashe_live.capture.opening import open_source
from ashe_live.core.types import Frame, TrackedFrame
from ashe_live.errors import UserError
from ashe_live.light.live.clean_plates import over_empty_table
from ashe_live.tracking.families.in_view import in_view_text, markers_in_view
from ashe_live.tracking.families.layout import the_marker
from ashe_live.tracking.tracker import MarkerTracker


@dataclass(frozen=True, slots=True, eq=False)
class EmptyTable:
    """A photo, the clean plate of those that are estimated."""

    path: Path
    frame: Frame

    @staticmethod
    def read(path: Path) -> "EmptyTable":
        """Raises UserError if it is no photo."""
        with open_source(path) as source:
            if not source.is_photo:
                remedy = "take a photo of it from where the other picture is taken from"
                raise UserError(f"{path} is a clip, and the empty table is shown by a photo", remedy)
            frame = source.read()
        assert frame is not None
        return EmptyTable(path, frame)

    def under(self, tracked: TrackedFrame, tracker: MarkerTracker) -> TrackedFrame:
        """The frame with this picture as its clean plate, if `tracker` found the marker in it.

        Raises UserError if this picture shows another view, or no marker.
        """
        if tracked.marker is None:
            return tracked
        if self.frame.size != tracked.frame.size:
            sizes = " and ".join(f"{width}x{height}" for width, height in (self.frame.size, tracked.frame.size))
            raise UserError(f"{self.path} is of another size ({sizes})", "take both pictures by one camera")
        tracker.reset()
        empty = tracker.track(self.frame)
        if empty.marker is None and (others := markers_in_view(self.frame.image_bgr)):
            said = f"{self.path} does not show {the_marker(tracker.marker.spec)}: {in_view_text(others)}"
            raise UserError(said, "leave the marker where it is, and take only the object away")
        return over_empty_table(tracked, replace(empty, camera=tracked.camera), str(self.path))
