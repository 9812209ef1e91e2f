"""From labels to a light: aligns a body with the picture, rates how likely that is right, and how uncertain the light.

May import `core`, `pixels`, `ground`, `shape`, `outline_fit`, `edges` and `labels`.
"""
