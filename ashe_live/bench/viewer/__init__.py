"""The viewer's loop: frames a second, frame times, first picture.

May import what `bench` may, and the modules that stand in `bench` itself; no other bench.
"""
