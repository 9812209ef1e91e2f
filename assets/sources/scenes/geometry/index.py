"""What the object-index pass says of a pixel."""

GROUND, CASTER, CLUTTER, OUTSIDE, SHEET, BEYOND = 1, 2, 3, 4, 5, 6
ROLES = {"caster": CASTER, "clutter": CLUTTER, "outside": OUTSIDE}
