"""The outline of a known body's shadow: where its edges are predicted, where the picture has them, and the light that
both agree on.
"""
