"""The tracker compared with OpenCV's detector, on frames with known poses.

May import what `bench` may, and the modules that stand in `bench` itself; no other bench.
"""
