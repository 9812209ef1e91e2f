"""The hull of an object's silhouettes in several views: a body of any shape, and the light whose shadow it casts.

May import `core`, `pixels`, `shape`, `edges`, `labels`, `explanation` and `views`.
"""
