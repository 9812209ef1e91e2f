"""Textures to draw or copy into, reallocated when another size is needed."""

import moderngl

from ashe_live.core.camera import Size
from ashe_live.render.gl.texture_units import UNIT_OF


class Canvas:
    """One texture or more, allocated when their size is first known and whenever that changes."""

    def __init__(self, ctx: moderngl.Context, components: int = 4, dtype: str = "f1", count: int = 1) -> None:
        self._ctx = ctx
        self._count = count
        self._components = components
        self._dtype = dtype
        self.textures: list[moderngl.Texture] = []  # which do not repeat; none before the first `of_size`
        self._framebuffer: moderngl.Framebuffer | None = None

    def of_size(self, size: Size) -> moderngl.Framebuffer:
        """The framebuffer that draws into all `textures`, which keep what they hold while the size stays."""
        if self._framebuffer is None or self._framebuffer.size != size:
            self.release()
            self.textures = [self._ctx.texture(size, self._components, dtype=self._dtype) for _ in range(self._count)]
            for texture in self.textures:
                texture.repeat_x = texture.repeat_y = False
            self._framebuffer = self._ctx.framebuffer(self.textures)
        return self._framebuffer

    def bind(self, *names: str) -> None:
        """For programs that read the textures by these names; does nothing before the first `of_size`."""
        for texture, name in zip(self.textures, names, strict=False):
            texture.use(UNIT_OF[name])

    def release(self) -> None:
        if self._framebuffer is not None:
            self._framebuffer.release()
        for texture in self.textures:
            texture.release()
        self.textures, self._framebuffer = [], None
