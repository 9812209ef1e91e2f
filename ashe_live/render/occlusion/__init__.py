"""What a model hides: of the sky from the ground around it, and of sky and ground from its own surface."""
