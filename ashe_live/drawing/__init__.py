"""Pictures of an estimate for a person: overlays, the light rose, its steps.

May import `core` and the rooms of `light`: `pixels`, `ground`, `shape` and `estimators`.
"""
