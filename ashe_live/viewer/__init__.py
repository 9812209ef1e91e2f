"""The viewer: threads, scene, keys, window; the only place that knows GLFW."""
