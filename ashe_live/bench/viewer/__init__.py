"""The viewer's loop: frames per second, frame times, time to the first picture.

May import what `bench` may, and the modules that stand in `bench` itself; no other bench.
"""
