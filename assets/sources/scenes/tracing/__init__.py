"""Specifications as Blender scenes (the only modules that need bpy)."""
