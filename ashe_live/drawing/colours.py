"""The colours in which estimates are drawn everywhere.

They are distinguishable for the colour-blind: Okabe and Ito's sky blue, orange, vermilion and bluish green, and a light
yellow, as theirs is too similar to their orange.
"""

OBJECT_BGR = (233, 180, 86)
SHADOW_BGR = (0, 159, 230)
UNEXPLAINED_BGR, UNSEEN_BGR = (0, 94, 213), (115, 158, 0)
LIGHT_BGR = (180, 248, 255)
PAPER_BGR, INK_BGR, FAINT_BGR = (28, 24, 22), (235, 235, 235), (150, 146, 140)
