from collections.abc import Iterator

import moderngl
import numpy as np
import pytest

from ashe_live.render.gl.chosen import ChosenPixels
from ashe_live.render.gl.driver import clear_part
from ashe_live.render.gl.framing import Rectangle
from ashe_live.render.gl.programs import WHOLE_FRAMEBUFFER, shader_source

SIDE = 48
CHOOSING = "#version 330 core\nvoid main() { if ((int(gl_FragCoord.x) + 2 * int(gl_FragCoord.y)) % 7 > 2) discard; }"
WHITE = "#version 330 core\nout vec4 colour;\nvoid main() { colour = vec4(1.0); }"


@pytest.fixture
def drawn(ctx: moderngl.Context) -> Iterator:
    """A function: which pixels (SIDE, SIDE) are white after choosing in one rectangle and drawing in another."""
    pixels, texture = ChosenPixels(ctx, (SIDE, SIDE)), ctx.texture((SIDE, SIDE), 4)
    choice, target = pixels.framebuffer([]), pixels.framebuffer([texture])
    programs = [
        ctx.program(vertex_shader=shader_source(WHOLE_FRAMEBUFFER), fragment_shader=each) for each in (CHOOSING, WHITE)
    ]
    choosing, white = (ctx.vertex_array(program, []) for program in programs)

    def draw(chosen_in: Rectangle, drawn_in: Rectangle) -> np.ndarray:
        texture.write(bytes(4 * SIDE * SIDE))
        with pixels.choosing(choice, chosen_in):
            choosing.render(moderngl.TRIANGLE_STRIP, vertices=4)
        with pixels.restricted(target, drawn_in):
            white.render(moderngl.TRIANGLE_STRIP, vertices=4)
        return np.frombuffer(texture.read(), np.uint8).reshape(SIDE, SIDE, 4)[..., 0] == 255

    yield draw
    ctx.detect_framebuffer(0).use()  # what is bound must not be released
    for held in (choice, target, pixels, texture, choosing, white, *programs):
        held.release()
    assert ctx.error == "GL_NO_ERROR"


def _within(rectangle: Rectangle) -> np.ndarray:
    left, bottom, width, height = rectangle
    inside = np.zeros((SIDE, SIDE), bool)
    inside[bottom : bottom + height, left : left + width] = True
    return inside


def test_what_was_chosen_is_drawn_and_nothing_else(drawn) -> None:
    y, x = np.mgrid[:SIDE, :SIDE]
    wanted = (x + 2 * y) % 7 <= 2
    whole, part, other = (0, 0, SIDE, SIDE), (5, 9, 21, 30), (13, 2, 30, 19)
    np.testing.assert_array_equal(drawn(whole, whole), wanted)
    # A later choice replaces the former one where it was made.
    np.testing.assert_array_equal(drawn(part, part), wanted & _within(part))
    np.testing.assert_array_equal(drawn(other, whole) & _within(other), wanted & _within(other))


@pytest.mark.parametrize("region", [(3, 4, 6, 7), (2, 2, 40, 30)])
def test_a_part_is_cleared_whatever_was_drawn_within_another(ctx: moderngl.Context, region: Rectangle) -> None:
    framebuffer = ctx.simple_framebuffer((SIDE, SIDE))
    framebuffer.clear(1.0, 1.0, 1.0, 1.0)
    framebuffer.scissor = (30, 30, 4, 4)
    framebuffer.use()
    clear_part(framebuffer, region)
    left = np.frombuffer(framebuffer.read(components=4), np.uint8).reshape(SIDE, SIDE, 4)
    assert not left[_within(region)].any()
    ctx.detect_framebuffer(0).use()
    framebuffer.release()
