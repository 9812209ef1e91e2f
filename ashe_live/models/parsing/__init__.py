"""Shared by all readers of model files: limits, folders, pictures, and messages for errors."""
