"""What one picture shows: the only value that the viewer hands to the renderer."""

from dataclasses import dataclass
from functools import cache

import numpy as np

from ashe_live.core.arrays import Image, frozen_view, set_frozen
from ashe_live.core.light import Illumination, Light
from ashe_live.core.proxy import Proxy
from ashe_live.core.types import TrackedFrame
from ashe_live.models.placement import UNMOVED, PlacedModel, Placement

UNLIT = Illumination()


@cache
def one_pixel(srgba: tuple[int, int, int, int]) -> Image:
    """(1, 1, 4) the picture of an overlay of one colour, whatever its size: the same one for the same colour."""
    return frozen_view(np.array(srgba, np.uint8).reshape(1, 1, 4))


@dataclass(frozen=True, slots=True, eq=False)
class Overlay:
    """A picture on top of everything; compared by identity, so keep it as long as its content stays."""

    image_rgba: Image  # (h, w, 4) uint8 sRGB, straight alpha, top row first
    left_px: int  # from the window's left edge, in pixels of the framebuffer
    top_px: int  # from its top edge
    size: tuple[int, int] | None = None  # shown width, height in pixels; None: as many as the picture has

    def __post_init__(self) -> None:
        shape = self.image_rgba.shape
        if len(shape) != 3 or shape[2] != 4 or self.image_rgba.dtype != np.uint8:
            raise ValueError(f"an overlay is (h, w, 4) uint8, not {shape} {self.image_rgba.dtype}")
        set_frozen(self, image_rgba=frozen_view(self.image_rgba))

    @property
    def shown_size(self) -> tuple[int, int]:
        return self.size or (self.image_rgba.shape[1], self.image_rgba.shape[0])


@dataclass(frozen=True, slots=True)
class Scene:
    """Everything in one picture. Objects that were in the last one as well are not uploaded again, and are equal by
    identity.
    """

    tracked: TrackedFrame | None = None  # video, camera and pose; None: black
    model: PlacedModel | None = None  # drawn where there is a marker
    illumination: Illumination = UNLIT
    shows_light: bool = False  # an arrow that comes from each light, or a bulb where it is
    overlays: tuple[Overlay, ...] = ()  # bottom first
    placement: Placement | None = UNMOVED  # of the model; None: it is kept ready and not drawn
    # More models with their placements; none of them is drawn while `model` is None.
    others: tuple[tuple[PlacedModel, Placement | None], ...] = ()
    casts_shadow: bool = True  # the model, on the ground and on the real object
    shows_model: bool = True  # itself, and not its shadow alone
    is_cut_out: bool = False  # without the video: transparent, so that it gives the same picture when put over it
    # The sheet, or the body that it is on, is covered by ground like that around it, where there is a model.
    covers_marker: bool = False
    # What lights the video, where `illumination` was set by hand or is on its way there, as shadows in it lie elsewhere
    # then; None: the same.
    lit_in_video: Illumination | None = None
    time_s: float = 0.0  # since the motion of a model that moves began
    is_split: bool = False  # the video's left half is shown alone
    is_mirrored: bool = False  # left to right, below the overlays

    @property
    def models(self) -> tuple[tuple[PlacedModel, Placement | None], ...]:
        """All of them with their placements; none where `model` is None."""
        return () if self.model is None else ((self.model, self.placement), *self.others)

    @property
    def shows_cover(self) -> bool:
        """Whether the cover itself is drawn.

        Cut out, it belongs to the shadow that lies on it, and not to a model alone, which would hide that shadow once
        it is put over it.
        """
        return self.covers_marker and (self.casts_shadow or not self.is_cut_out)

    def real_object(self, has_cover: bool) -> Proxy | None:
        """The real object beside the model; None for a body with the marker on it that is covered.

        `has_cover`: the ground that covers it is drawn. As long as that is being made, or where none is seen that could
        be laid over it, the body is still there.
        """
        marker = None if self.tracked is None else self.tracked.marker
        is_gone = has_cover or not self.shows_cover
        if self.covers_marker and is_gone and marker is not None and marker.body is not None:
            return None
        return self.illumination.real_object

    @property
    def object_seen_in(self) -> TrackedFrame | None:
        """The frame that shows the real object where it stands; None: there is none, or it stood elsewhere then."""
        read = self.illumination.as_read or self.illumination
        return read.seen_in if read.real_object is self.illumination.real_object else None

    @property
    def object_lit_by(self) -> tuple[Light, ...]:
        """The lights in which the real object's shadows lie in the frame that shows it."""
        return (self.illumination.as_read or self.illumination).lights
