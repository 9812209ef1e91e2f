"""Labels pixels as lit ground, shadow or object by their unary costs, before and after a fit.

May import `core`, `pixels`, `ground` and `shape`.
"""
