"""Light as shaders want it: sky, suns and lamps by their irradiance, and their shadow maps."""
