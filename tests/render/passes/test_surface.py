import moderngl
import numpy as np
import pytest

from ashe_live.render.gl.programs import build_program, set_uniforms
from ashe_live.render.passes.surface import Surface

REGION = (5, 7, 20, 10)


@pytest.mark.parametrize("samples", [0, 4])
def test_only_the_region_is_emptied_and_drawn(ctx: moderngl.Context, samples: int) -> None:
    surface = Surface(ctx, (60, 40), samples)
    white = ctx.texture((1, 1), 4, b"\xff\xff\xff\xff")
    program = build_program(ctx, "screen/screen")
    rectangle = ctx.vertex_array(program, [])
    left, bottom, width, height = REGION
    expected = np.zeros((40, 60), dtype=np.float16)
    for region, is_drawn in (((0, 0, 60, 40), False), (REGION, True), ((0, 0, 10, 10), False)):
        with surface.drawing(region):
            ctx.viewport = (0, 0, 60, 40)
            ctx.enable_only(moderngl.NOTHING)
            white.use(0)
            set_uniforms(program, picture=0, rectangle=(-1.0, -1.0, 1.0, 1.0))
            if is_drawn:
                rectangle.render(moderngl.TRIANGLE_STRIP, vertices=4)
    surface.bind_layers()
    expected[bottom : bottom + height, left : left + width] = 1.0
    expected[:10, :10] = 0.0
    drawn = np.frombuffer(surface.layers[0].read(), np.float16).reshape(40, 60, 4)
    np.testing.assert_array_equal(drawn[..., 0], expected)
    for held in (surface, white, rectangle, program):
        held.release()
    ctx.detect_framebuffer(0).use()
    assert ctx.error == "GL_NO_ERROR"


def test_several_samples_begin_with_what_one_has_drawn(ctx: moderngl.Context) -> None:
    surface = Surface(ctx, (60, 40), 4)
    with surface.drawing((0, 0, 60, 40)):
        pass
    values = np.random.default_rng(3).uniform(-0.5, 1.5, (2, 40, 60, 4)).astype(np.float16)
    for layer, each in zip(surface.layers, values, strict=True):
        layer.write(each.tobytes())
    with surface.drawing(REGION, several_samples=True, over_drawn=True):
        pass
    for layer, each in zip(surface.layers, values, strict=True):
        np.testing.assert_array_equal(np.frombuffer(layer.read(), np.float16).reshape(40, 60, 4), each)
    surface.release()
    ctx.detect_framebuffer(0).use()
    assert ctx.error == "GL_NO_ERROR"
