"""Pictures of a model's materials: decoded within limits, reduced, each once."""

import io
import math
from collections.abc import Callable, Hashable

import numpy as np
from numpy.typing import NDArray
from PIL import Image as PillowImage
from PIL import UnidentifiedImageError

from ashe_live.core.arrays import Image
from ashe_live.errors import UserError
from ashe_live.files.png import readable
from ashe_live.models.parsing import basis
from ashe_live.models.parsing.folder import Folder, MissingFileError
from ashe_live.models.parsing.limits import MAX_TEXTURE_PX, check_decoded, check_picture, check_texels, too_large
from ashe_live.models.parsing.malformed import MalformedError
from ashe_live.models.parsing.notes import NAME_CHARACTERS, Notes
from ashe_live.process.messages import printable

KTX2 = b"\xabKTX 20\xbb"
DEEP_MODES = ("I;16", "I;16B", "I;16L", "I;16N", "I", "F")  # one channel of more than 8 bits


class Pictures:
    """The pictures of one model's file; one that is used several times is a single value."""

    def __init__(self, folder: Folder, notes: Notes) -> None:
        self._model = folder.model
        self._folder = folder
        self._notes = notes
        self._missing: set[str] = set()
        self._texels: dict[Hashable, Image] = {}
        self._filled: dict[int, Image] = {}
        self._decoded = 0  # texels, of all pictures so far

    def named(self, file: str, name: str | None = None, covers: bool = False, beside: str = "") -> Image | None:
        """As `texels`, from a file beside the model's; None, with a note, where there is none.

        name: for messages, where it is not "texture" and the file's name. beside: a folder in the model's, of the file
        that names the picture, in which it is looked for first.
        """
        name = f"texture {file}" if name is None else name
        if beside and (found := self._beside(f"{beside}/{file}", name, covers)) is not None:
            return found
        found = self._beside(file, name, covers)
        if found is None:
            self._notes.add(f"its picture {printable(file, NAME_CHARACTERS)} is not beside it, and is left out")
        return found

    def _beside(self, file: str, name: str, covers: bool) -> Image | None:
        if file in self._missing:
            return None
        try:
            return self.texels(file, lambda: self._folder.get(file), name, covers)
        except MissingFileError:
            self._missing.add(file)
            return None

    def texels(self, key: Hashable, content: Callable[[], bytes], name: str, covers: bool = False) -> Image:
        """(h, w, 4) uint8 as the file has it, no side longer than MAX_TEXTURE_PX; `content` is asked for a new `key`.

        `covers`: its alpha says how much of its colours is seen, and what nobody sees gets the colours beside it; else
        that is a number like the other three. Raises UserError when it is too large or of a kind that is not read,
        MalformedError naming `name` when it is damaged.
        """
        texels = self.made((key, covers), lambda: self._decoded_from(content(), name, covers))
        if max(texels.shape) < MAX_TEXTURE_PX or texels[..., 3].min() == 255:
            self._texels[key, not covers] = texels  # where nothing was reduced, or by nothing, it is the same
        if not covers:
            return texels
        if id(texels) not in self._filled:
            self._filled[id(texels)] = filled_beyond(texels)
        return self._filled[id(texels)]

    def made(self, key: Hashable, make: Callable[[], Image]) -> Image:
        """(h, w, 4) uint8 that is made of the file's pictures; `make` is called for a new `key`.

        Raises UserError when all of the model's pictures are too large together.
        """
        if key not in self._texels:
            self._texels[key] = make()
            each = {id(kept): kept.size // 4 for kept in self._texels.values()}
            check_texels(self._model, sum(each.values()))
        return self._texels[key]

    def _decoded_from(self, content: bytes, name: str, covers: bool) -> Image:
        if content.startswith(KTX2):
            texels = basis.texels_of(self._model, content, name)
            self._decoded += texels.size // 4
            check_decoded(self._model, self._decoded)
            return _reduced(PillowImage.fromarray(texels), covers)
        try:
            picture = PillowImage.open(readable(io.BytesIO(content))[0])
        except PillowImage.DecompressionBombError:
            raise too_large(self._model, "of more than 8192 x 8192") from None
        except UnidentifiedImageError:
            said = f"of the model file {self._model} its {name} cannot be read, as it is no picture of a known kind"
            raise UserError(said, "save that as PNG or JPEG, or copy it again") from None
        except (OSError, ValueError, SyntaxError, TypeError):
            raise MalformedError(f"its {name} cannot be read") from None
        with picture:
            check_picture(self._model, picture)
            # Before the conversion, which would make four channels of the large one.
            if max(picture.size) > MAX_TEXTURE_PX and picture.mode == "RGB":
                picture.draft("RGB", (MAX_TEXTURE_PX, MAX_TEXTURE_PX))
            self._decoded += picture.width * picture.height
            check_decoded(self._model, self._decoded)
            try:
                reduced = _in_8_bits(picture).convert("RGBA")
            except (MemoryError, UserError):
                raise
            except Exception:  # Pillow's decoders raise anything
                raise MalformedError(f"its {name} is damaged") from None
        return _reduced(reduced, covers)


def _reduced(picture: PillowImage.Image, covers: bool) -> Image:
    # Of four channels together Pillow weighs three by the fourth, which makes all black where that is 0.
    channels = (picture,) if covers else picture.split()
    for channel in channels:
        channel.thumbnail((MAX_TEXTURE_PX, MAX_TEXTURE_PX), PillowImage.Resampling.LANCZOS)
    return np.asarray(picture if covers else PillowImage.merge("RGBA", channels), dtype=np.uint8)


def _in_8_bits(picture: PillowImage.Image) -> PillowImage.Image:
    """Scales deeper pictures to 8 bits. Pillow would clip values at 255, which makes nearly all of 16 bits white."""
    if picture.mode not in DEEP_MODES:
        return picture
    given: NDArray[np.float32] = np.asarray(picture).astype(np.float32)
    values = np.where(np.isfinite(given), given, np.float32(0))
    of_one = values if picture.mode == "F" else values / 65535
    grey: NDArray[np.uint8] = np.round(np.clip(of_one, 0, 1) * 255).astype(np.uint8)
    return PillowImage.fromarray(grey)


def filled_beyond(texels: Image) -> Image:
    """(h, w, 4) uint8 whose texels that nobody sees, with an alpha of 0, have the colours of seen ones near by.

    Otherwise filtering would mix in their own, which is black as a rule: a cut-out would have dark rims.
    """
    unseen = texels[..., 3] == 0
    if unseen.all() or not unseen.any():
        return texels
    share = texels[..., 3:].astype(np.float32)
    sums = texels[..., :3] * share
    levels = []
    while (share == 0).any():  # means of ever larger squares
        levels.append((sums, share))
        sums, share = _halved(sums), _halved(share)
    means = sums / share
    for sums, share in reversed(levels):
        height, width = share.shape[:2]
        wider = means.repeat(2, axis=0).repeat(2, axis=1)[:height, :width]
        means = np.where(share > 0, sums / np.maximum(share, 1), wider)
    filled = texels.copy()
    filled[unseen, :3] = np.round(means[unseen])
    return filled


def _halved(values: NDArray[np.float32]) -> NDArray[np.float32]:
    """Sums of squares of two by two (h, w, c); beyond the border is nothing."""
    height, width, channels = values.shape
    even = np.pad(values, ((0, height % 2), (0, width % 2), (0, 0)))
    return np.asarray(even.reshape((height + 1) // 2, 2, (width + 1) // 2, 2, channels).sum(axis=(1, 3)))


def cleared(colours: Image | None, mask: Image, share: float, is_opaque: bool) -> Image:
    """(h, w, 4) uint8 of the larger one's size, white without colours, with an alpha less by `share` of the mask's red.

    is_opaque: the colours' own alpha does not count.
    """
    colours, mask = at_one_size(np.full_like(mask, 255) if colours is None else colours, mask)
    left = 1 - share * mask[..., 0] / 255
    alpha = 255 * left if is_opaque else colours[..., 3] * left
    return np.dstack([colours[..., :3], np.round(alpha).astype(np.uint8)])


def opaque(colours: Image) -> Image:
    """(h, w, 4) uint8, the colours with an alpha of 255."""
    return np.dstack([colours[..., :3], np.full_like(colours[..., 3], 255)])


def at_one_size(*pictures: Image) -> list[Image]:
    """Pictures (h, w, 4) uint8 at the size of the largest of them."""
    size = max(((each.shape[1], each.shape[0]) for each in pictures), key=math.prod)
    return [resized(each, size) for each in pictures]


def resized(texels: Image, size: tuple[int, int]) -> Image:
    """(h, w, 4) uint8 brought to `size`, width and height, each channel by itself."""
    if (texels.shape[1], texels.shape[0]) == size:
        return texels
    channels = PillowImage.fromarray(texels).split()
    return np.dstack([np.asarray(each.resize(size, PillowImage.Resampling.BILINEAR)) for each in channels])
