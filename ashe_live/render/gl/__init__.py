"""OpenGL without a scene: programs, textures, framebuffers, meshes on the graphics card."""
