"""A frame in a texture: whoever converts it, it is the same."""

import moderngl
import numpy as np
import pytest

from ashe_live.render.passes import frame_texture
from ashe_live.render.passes.frame_texture import FrameTexture


# A row of an odd number of bytes, and one that no multiple of four divides.
@pytest.mark.parametrize("size", [(5, 3), (64, 48), (1, 1), (101, 7)])
@pytest.mark.parametrize("by_gpu", [True, False])
def test_bottom_row_first_as_rgba(
    ctx: moderngl.Context, monkeypatch: pytest.MonkeyPatch, size: tuple[int, int], by_gpu: bool
) -> None:
    monkeypatch.setattr(frame_texture, "is_software", lambda _: not by_gpu)
    frame = np.random.default_rng(5).integers(0, 256, (size[1], size[0], 3)).astype(np.uint8)
    held = FrameTexture(ctx, size)
    for image_bgr in (frame, frame[:, ::-1]):  # the second is not contiguous
        held.write(image_bgr)
        drawn = np.frombuffer(held.texture.read(), np.uint8).reshape(size[1], size[0], 4)
        np.testing.assert_array_equal(drawn[::-1, :, 2::-1], image_bgr)
        assert (drawn[..., 3] == 255).all()
    held.release()
    ctx.detect_framebuffer(0).use()
    assert ctx.error == "GL_NO_ERROR"


def test_a_frame_too_wide_to_be_sent_as_bytes_is_converted_before(
    ctx: moderngl.Context, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(frame_texture, "is_software", lambda _: False)
    width = int(ctx.info["GL_MAX_TEXTURE_SIZE"]) // 3 + 1
    frame = np.random.default_rng(5).integers(0, 256, (2, width, 3)).astype(np.uint8)
    held = FrameTexture(ctx, (width, 2))
    held.write(frame)
    drawn = np.frombuffer(held.texture.read(), np.uint8).reshape(2, width, 4)
    np.testing.assert_array_equal(drawn[::-1, :, 2::-1], frame)
    held.release()
