"""Bodies, the shadows they cast, and how both project into a picture: geometry without colours.

May import `core` and `pixels`.
"""
