"""Pictures of an estimate for the user: overlays, the light rose, the estimator's steps.

May import `core` and the rooms of `light`: `pixels`, `ground`, `shape` and `estimators`.
"""
