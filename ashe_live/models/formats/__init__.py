"""Readers of OBJ, PLY and STL."""
