import moderngl
import numpy as np
import pytest

from ashe_live.render.programs import build_program, set_uniforms
from ashe_live.render.surface import Surface

REGION = (5, 7, 20, 10)


@pytest.mark.parametrize("samples", [0, 4])
def test_only_the_region_is_drawn_and_copied(ctx: moderngl.Context, samples: int) -> None:
    surface = Surface(ctx, (60, 40), samples)
    surface.colour.clear(0.0, 0.0, 0.0, 1.0)
    white = ctx.texture((1, 1), 4, b"\xff\xff\xff\xff")
    program = build_program(ctx, "screen")
    rectangle = ctx.vertex_array(program, [])
    with surface.drawing(REGION) as multisampled:
        assert multisampled == (surface.samples > 0)
        ctx.viewport = (0, 0, 60, 40)
        ctx.enable_only(moderngl.NOTHING)
        white.use(0)
        set_uniforms(program, picture=0, rectangle=(-1.0, -1.0, 1.0, 1.0))
        rectangle.render(moderngl.TRIANGLE_STRIP, vertices=4)
    expected = np.zeros((40, 60, 3), dtype=np.uint8)
    left, bottom, width, height = REGION
    expected[40 - bottom - height : 40 - bottom, left : left + width] = 255
    np.testing.assert_array_equal(surface.read_bgr(), expected)
    for held in (surface, white, rectangle, program):
        held.release()
    ctx.detect_framebuffer(0).use()
    assert ctx.error == "GL_NO_ERROR"
