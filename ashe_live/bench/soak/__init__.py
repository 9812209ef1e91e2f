"""The viewer's loop for very long: leaks, drift, the age of a picture.

May import what `bench` may, and the modules that stand in `bench` itself; no other bench.
"""
