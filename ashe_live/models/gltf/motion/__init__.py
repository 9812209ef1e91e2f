"""Where a file's nodes, joints and vertices are, at a moment of an animation or without one."""
