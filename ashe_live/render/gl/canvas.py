"""A texture to draw or copy into, reallocated when another size is needed."""

import moderngl

from ashe_live.core.camera import Size


class Canvas:
    """Allocated when its size is first known and whenever that changes; keeps its content in between."""

    def __init__(self, ctx: moderngl.Context, components: int = 4, dtype: str = "f1") -> None:
        self._ctx = ctx
        self._components = components
        self._dtype = dtype
        self._held: tuple[moderngl.Texture, moderngl.Framebuffer] | None = None

    def of_size(self, size: Size) -> tuple[moderngl.Texture, moderngl.Framebuffer]:
        """The texture, which does not repeat, and the framebuffer that draws into it."""
        if self._held is None or self._held[0].size != size:
            self.release()
            texture = self._ctx.texture(size, self._components, dtype=self._dtype)
            texture.repeat_x = texture.repeat_y = False
            self._held = texture, self._ctx.framebuffer([texture])
        return self._held

    def release(self) -> None:
        if self._held is not None:
            texture, framebuffer = self._held
            framebuffer.release()
            texture.release()
        self._held = None
