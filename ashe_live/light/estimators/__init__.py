"""The estimators by name: each takes a tracked frame and returns lights, or the reason why there are none.

May import `core`, `errors`, `pixels`, `ground`, `outline_fit`, `labels`, `explanation`, `views`, `hull`, `lamps`,
`known_body` and `paper`.
"""
