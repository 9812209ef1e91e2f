"""What a camera makes of radiance, and the truth about it."""
