"""From a file's meshes to a model: placed, with normals, equal ones merged, stood upright."""
