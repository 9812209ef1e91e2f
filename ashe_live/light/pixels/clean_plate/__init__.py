"""Clean plates: pictures of a view without the object, laid over its picture, and what stands there without them."""
