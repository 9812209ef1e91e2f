"""What a light may be taken for."""

AUTO = "auto"  # a lamp where the picture tells its distance, else a sun
SUN = "sun"  # as good as infinitely far away, always
LAMP = "lamp"  # near by, wherever the picture tells anything of its distance
KINDS = (AUTO, SUN, LAMP)
