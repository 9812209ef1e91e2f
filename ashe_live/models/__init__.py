"""Virtual models: meshes, and the files they come from."""
