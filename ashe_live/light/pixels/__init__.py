"""Pictures as the estimator sees them: a view of the ground, its colours, and areas of pixels.

May import `core`.
"""
