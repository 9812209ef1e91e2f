"""Pictures with a known light that NumPy paints ray by ray: bodies, scenes, light, ground, and the picture."""
