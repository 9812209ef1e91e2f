"""The estimators' errors, calibration and times on pictures with a known light.

May import what `bench` may, and the modules that stand in `bench` itself; no other bench.
"""
