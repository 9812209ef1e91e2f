"""Bodies, the shadows they cast, and the projection of both into a picture: geometry without colours.

May import `core` and `pixels`.
"""
