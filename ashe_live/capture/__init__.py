"""Where frames come from (webcam, clip, photo) and where recordings go."""
