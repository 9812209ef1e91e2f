"""What pictures cost, and how far they are from a path tracer's.

May import what `bench` may, and the modules that stand in `bench` itself; no other bench.
"""
