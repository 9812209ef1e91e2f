"""What every clip that is written has in common: pictures of an even size, in the colours of ITU-R BT.709."""

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

from av.container import OutputContainer
from av.video.frame import VideoFrame
from av.video.reformatter import ColorPrimaries, ColorRange, Colorspace, ColorTrc, Interpolation
from av.video.stream import VideoStream

from ashe_live.core.camera import Size
from ashe_live.errors import UserError

# The plain conversion darkens every colour by 1.5 levels; rounding rightly costs 0.4 ms at 640x480.
CONVERSION = Interpolation.BILINEAR | Interpolation.ACCURATE_RND


@dataclass(frozen=True, slots=True)
class Encoding:
    """How pictures of a clip are encoded, as FFmpeg names it."""

    encoder: str
    pixels: str
    ticks_per_s: int
    options: Mapping[str, str]  # the encoder's


def even_size(size: Size) -> Size:
    """`size` (width, height) without an odd last column or row. Raises UserError where less than 2 pixels are left."""
    width, height = size[0] // 2 * 2, size[1] // 2 * 2
    if min(width, height) < 2:
        raise UserError(f"pictures of {size[0]}x{size[1]} cannot be recorded", "give a --size of 2x2 or more")
    return width, height


def converted(picture: VideoFrame, pixels: str) -> VideoFrame:
    """`picture`, sRGB, in one of FFmpeg's YUV formats of BT.709 in the range of video (16 to 235 of 8 bits)."""
    return picture.reformat(
        format=pixels,
        dst_colorspace=Colorspace.ITU709,
        dst_color_range=ColorRange.MPEG,
        interpolation=CONVERSION,
        threads=1,
    )


def added_stream(container: OutputContainer, encoding: Encoding, size: Size, fps: float) -> VideoStream:
    """A stream for pictures of a size (width, height) that `converted` has made."""
    rate, options = Fraction(fps).limit_denominator(1001), dict(encoding.options)
    stream = container.add_stream(encoding.encoder, rate=rate, options=options)
    assert isinstance(stream, VideoStream)
    codec = stream.codec_context
    codec.width, codec.height = size
    codec.pix_fmt = encoding.pixels
    codec.time_base = Fraction(1, encoding.ticks_per_s)
    # One thread, as the viewer needs the others.
    codec.thread_count = 1
    codec.colorspace, codec.color_range = Colorspace.ITU709, ColorRange.MPEG
    codec.color_primaries, codec.color_trc = ColorPrimaries.BT709, ColorTrc.BT709
    return stream
