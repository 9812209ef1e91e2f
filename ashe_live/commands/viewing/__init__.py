"""Shared by all commands that play a source, in a window or without one."""
