"""Clips: reading, seeking and writing video files, also such as were cut short."""
