"""The renderer's frame times, and its differences from a path tracer.

May import what `bench` may, and the modules that stand in `bench` itself; no other bench.
"""
