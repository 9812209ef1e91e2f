"""glTF 2.0, read by its schema: the JSON is checked first, then arrays, materials and the pose are made from it."""
