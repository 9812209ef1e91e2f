"""What draws: a GPU, or the processor in its place."""

SOFTWARE = ("llvmpipe", "softpipe", "swrast", "software")  # in what rasterisers without a GPU call themselves


def is_software(info: dict[str, str]) -> bool:
    """Whether a context with this `info` uses no GPU, so that every sample of a pixel costs the processor's time."""
    renderer = info["GL_RENDERER"].lower()
    return any(word in renderer for word in SOFTWARE)
