"""Lights from the shadows of a body whose shape and place are known, as those of the paper cube: only they are fitted.

Its thresholds were chosen on pictures that `bench/cube/painter.py` paints, and on path-traced ones of the generator's
set `cube_training`, for want of photographs with a known light.
May import `core`, `pixels` and `shape`.
"""
