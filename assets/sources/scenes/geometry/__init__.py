"""Shapes, poses and surroundings in NumPy alone, so that Blender and ashe_live share them."""
