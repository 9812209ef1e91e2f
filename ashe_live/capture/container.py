"""The one way to a clip's content: FFmpeg gets a file that is open, and may reach nothing else.

A name could mean an address or a protocol to it (`http:`, `concat:`), and some formats are lists of addresses.
"""

from typing import BinaryIO

import av
from av.container import InputContainer

# FFmpeg's names of what cameras, phones and editors write; none that names other files (HLS, DASH, concat, SDP).
DEMUXERS = (
    "mov,mp4,m4a,3gp,3g2,mj2,matroska,webm,avi,mpegts,mpeg,mpegvideo,flv,ogg,asf,gif,apng,mjpeg,h264,hevc,av1,obu,ivf,"
    "dv,mxf,nut,rm,swf,wtv,yuv4mpegpipe"
)
ALLOWED = {"protocol_whitelist": "none", "format_whitelist": DEMUXERS}


def opened_container(stream: BinaryIO) -> InputContainer:
    """From the start of a file, which stays open for as long as the container is used.

    Raises FFmpegError or OSError when it is not a clip.
    """
    stream.seek(0)
    return av.open(stream, "r", container_options=ALLOWED, metadata_errors="replace")
