"""Long runs of the viewer's loop: leaks, drift, and the latency of pictures.

May import what `bench` may, and the modules that stand in `bench` itself; no other bench.
"""
