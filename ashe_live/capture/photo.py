"""A photo as a source of one frame."""

import io
import math
import os
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import BinaryIO, NamedTuple

import cv2
import numpy as np
import PIL.ExifTags
import PIL.Image

from ashe_live.capture.clips.wide_gamut import srgb_converter, srgb_from_adobe_rgb
from ashe_live.capture.isolated_photo import HEIF, is_heif, read_isolated
from ashe_live.capture.sources import MAX_PIXELS, Source, refuse_too_large, too_many_pixels
from ashe_live.core.arrays import Image
from ashe_live.core.types import Frame
from ashe_live.errors import UserError
from ashe_live.files.pixels import quarter_turns, upright, with_8_bits
from ashe_live.files.reading import opened
from ashe_live.files.slow_pictures import opened_picture, refuse_slow_decoder
from ashe_live.files.tiff import refuse_misread

FORMATS = ("JPEG", "PNG", "BMP", "TIFF", "WEBP", "PPM", "JPEG2000", "AVIF")
# Focal lengths that cameras state for 35 mm film; and shapes that they take: longer ones are cut or stitched.
LEAST_FILM_MM, MOST_FILM_MM = 8.0, 600.0
LONGEST_SHAPE, SAME_SHAPE = 1.8, 0.02
# Shapes of sensors: of phones and small cameras, and that of film. Of a longer or squarer picture (16:9, square) the
# camera has left out a part, and states what its whole sensor sees; the cameras that do so are mostly phones.
PHONE_SHAPE, FILM_SHAPE = 4 / 3, 3 / 2
# EXIF's tag of a photo that keeps to DCF (JEITA CP-3461), and its value for one in Adobe RGB.
INTEROPERABILITY_INDEX, DCF_ADOBE_RGB = 1, "R03"
CONVERTED_ROWS = 256  # at a time: light takes 24 bytes a pixel on the way
# As the largest picture has without compression, with transparency.
MOST_FILE_BYTES = 4 * MAX_PIXELS
# More than a camera's JPEGs and HEICs have. Larger ones are read apart, and known by what they begin with.
LARGE_FILE_BYTES, FIRST_BYTES = 64_000_000, 65_536
# Of these formats, files of several pictures are animations; JPEG has previews beside its picture, TIFF pages.
MAY_MOVE = ("PNG", "WEBP", "AVIF")
# Photos by name, so that a damaged or foreign one is refused as a photo and not as a clip.
SUFFIXES = {
    *(".jpg", ".jpeg", ".jpe", ".jfif", ".mpo", ".png", ".bmp", ".tif", ".tiff", ".webp", ".ppm", ".pgm", ".pnm"),
    *(".jp2", ".j2k", ".jpx", ".avif", ".heic", ".heif", ".hif"),
}
# Their content begins as a photo: they are pictures in JPEG one after the other.
CLIP_SUFFIXES = {".mjpeg", ".mjpg"}


class _Photo(NamedTuple):
    image_bgr: Image  # (h, w, 3) uint8
    focal_px: float | None  # in its pixels, as the EXIF data state it; None: they do not
    quarter_turns: int
    is_first_of_animation: bool


class PhotoSource(Source):
    """The picture in a file, upright as its EXIF data says: frame 0, then the end. Of an animation it is the first."""

    fps = None
    is_live = False
    is_photo = True

    def __init__(self, path: str | Path) -> None:
        """Decodes the file. Raises UserError when it is missing, damaged, too large or of an unknown format."""
        path = Path(path)
        self.name = path.name
        photo = _read(path)
        self.focal_px = photo.focal_px
        self.quarter_turns = photo.quarter_turns  # anticlockwise, by which the sensor's picture was made upright
        self.note: str | None = None
        if photo.is_first_of_animation:
            self.note = f"{self.name} is an animation, of which the first picture is shown: convert it to MP4 or GIF"
        self._frame = Frame(photo.image_bgr, index=0, time_s=0.0)
        self.size = self._frame.size
        self._has_ended = False

    def read(self) -> Frame | None:
        frame = None if self._has_ended else self._frame
        self._has_ended = True
        return frame

    def rewind(self) -> None:
        self._has_ended = False

    def close(self) -> None:
        self._has_ended = True


def looks_like_photo(path: Path) -> bool:
    """Whether the file begins as a photo does, or at least is named as one. Raises UserError as `opened`."""
    if path.suffix.lower() in CLIP_SUFFIXES:
        return False
    try:
        with opened(path) as file:
            if is_heif(file):
                return True  # FFmpeg would show a corner, as iPhones store such photos in tiles
            is_large = _size_bytes(file) > LARGE_FILE_BYTES
            _open(path, io.BytesIO(file.read(FIRST_BYTES)) if is_large else file).close()
    except UserError:
        raise
    except PIL.UnidentifiedImageError:
        return path.suffix.lower() in SUFFIXES
    except Exception:
        return True  # A photo, but damaged or too large, as PhotoSource will say.
    return True


def _open(path: Path, file: BinaryIO) -> PIL.Image.Image:
    """Reads the header only. Raises UserError for a photo that takes very long already there, as `refuse_slow`."""
    with warnings.catch_warnings():
        # Pillow warns of large pictures at a limit of its own; ours is MAX_PIXELS.
        warnings.simplefilter("ignore", PIL.Image.DecompressionBombWarning)
        return opened_picture(path, file, FORMATS)


def _size_bytes(file: BinaryIO) -> int:
    return os.fstat(file.fileno()).st_size


def _read(path: Path) -> _Photo:
    """Pillow and not OpenCV decodes, as it refuses a truncated picture and OpenCV greys the rest."""
    try:
        with opened(path) as file:
            file_bytes = _size_bytes(file)
            if file_bytes > MOST_FILE_BYTES:
                raise UserError(
                    f"{path} has {file_bytes // 10**6:,} MB, and a photo may have {MOST_FILE_BYTES // 10**6} MB",
                    "save it as JPEG, or copy it again if it should be smaller",
                )
            if file_bytes > LARGE_FILE_BYTES and not is_heif(file):
                return read_isolated(path, FORMATS, _decoded)
            with _open(path, file) as picture:
                refuse_slow_decoder(path, picture, file)
                return _decoded(path, picture)
    except UserError:
        raise
    except PIL.Image.DecompressionBombError:
        raise too_many_pixels(path) from None
    except PIL.UnidentifiedImageError:
        with opened(path) as file:
            if is_heif(file):
                return read_isolated(path, HEIF, _decoded)
        raise UserError(
            f"{path} does not begin as a photo of a known format",
            "copy it again if it is damaged, or convert it to JPEG or PNG",
        ) from None
    # A damaged file can fail anywhere in Pillow's decoders: SyntaxError, ValueError, struct.error, OSError...
    except Exception as error:
        why = f" ({error})" if str(error) else ""
        raise UserError(f"{path} is damaged{why}", "copy it again, or convert it to JPEG or PNG") from None


def _decoded(path: Path, picture: PIL.Image.Image) -> _Photo:
    """As `_read`, of the photo opened from `path`. Raises UserError where it is too large or not read."""
    refuse_too_large(path, picture.size)
    if picture.mode == "F":
        raise UserError(f"{path} has floating-point pixels, which are not read", "convert it to JPEG or PNG")
    refuse_misread(path, picture)
    focal_px, turns = _focal_px(picture), quarter_turns(picture)
    is_animation = picture.format in MAY_MOVE and getattr(picture, "n_frames", 1) > 1
    to_srgb = _srgb_converter(picture)
    image_bgr = np.asarray(cv2.cvtColor(_rgb_8bit(upright(picture)), cv2.COLOR_RGB2BGR), dtype=np.uint8)
    if to_srgb is not None:
        for row in range(0, len(image_bgr), CONVERTED_ROWS):
            image_bgr[row : row + CONVERTED_ROWS] = to_srgb(image_bgr[row : row + CONVERTED_ROWS])
    return _Photo(image_bgr, focal_px, turns, is_animation)


def _focal_px(picture: PIL.Image.Image) -> float | None:
    """By the focal length that sees as much on 35 mm film, whose picture has a diagonal of 43 mm.

    None where the camera did not state it, or the picture was cut out of another one.
    """
    tags = PIL.ExifTags.Base
    try:
        data = picture.getexif().get_ifd(PIL.ExifTags.IFD.Exif)
        millimetres = float(data.get(tags.FocalLengthIn35mmFilm, 0))
        taken = [float(data.get(tag, 0)) for tag in (tags.ExifImageWidth, tags.ExifImageHeight)]
    except Exception:  # Damaged EXIF data can fail anywhere in Pillow, and say nothing against the picture.
        return None
    longer, shorter = max(picture.size), min(picture.size)
    is_whole = min(taken) <= 0 or abs(max(taken) / min(taken) * shorter / longer - 1) <= SAME_SHAPE
    if not (LEAST_FILM_MM <= millimetres <= MOST_FILM_MM and longer <= LONGEST_SHAPE * shorter and is_whole):
        return None
    return millimetres * _sensor_diagonal(longer, shorter) / math.hypot(36, 24)


def _sensor_diagonal(longer: float, shorter: float) -> float:
    """Of all that the sensor sees, in pixels of a picture with these sides."""
    shape = longer / shorter
    if shape > FILM_SHAPE * (1 + SAME_SHAPE):
        return math.hypot(longer, longer / PHONE_SHAPE)
    if shape < PHONE_SHAPE * (1 - SAME_SHAPE):
        return math.hypot(shorter * PHONE_SHAPE, shorter)
    return math.hypot(longer, shorter)


def _srgb_converter(picture: PIL.Image.Image) -> Callable[[Image], Image] | None:
    """Where a photo has no profile that tells its colours, and a number does; None where they are sRGB, or grey.

    Cameras state so the HDR of HEIC (PQ, HLG), and Adobe RGB in the EXIF data.
    """
    if picture.info.get("icc_profile") or picture.mode not in ("RGB", "RGBA"):
        return None
    if (numbers := picture.info.get("nclx_profile")) is not None:
        return srgb_converter(numbers["color_primaries"], numbers["transfer_characteristics"])
    try:
        index = picture.getexif().get_ifd(PIL.ExifTags.IFD.Interop).get(INTEROPERABILITY_INDEX)
    except Exception:  # as above
        return None
    return srgb_from_adobe_rgb() if str(index).rstrip("\0") == DCF_ADOBE_RGB else None


def _rgb_8bit(picture: PIL.Image.Image) -> Image:
    """(h, w, 3) uint8 sRGB: 16 bits reduced to 8, grey repeated, what is transparent laid on white."""
    if picture.mode.startswith("I"):
        return np.asarray(with_8_bits(picture).convert("RGB"))
    profile = picture.info.get("icc_profile")
    if picture.has_transparency_data:
        layer = picture.convert("RGBA")
        picture = PIL.Image.alpha_composite(PIL.Image.new("RGBA", layer.size, "white"), layer)
    if picture.mode not in ("RGB", "L", "CMYK"):
        picture = picture.convert("RGB")
    if profile:
        from ashe_live.capture.photo_colours import in_srgb  # loads a library that most photos do not need

        picture = in_srgb(picture, profile)
    return np.asarray(picture if picture.mode == "RGB" else picture.convert("RGB"))
