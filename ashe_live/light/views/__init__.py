"""Several views of one unmoved scene: what lies on the plane, and one body with its lights seen in all of them.

May import `core`, `pixels`, `ground`, `shape`, `outline_fit`, `labels` and `explanation`.
"""
