"""What a light may be taken for."""

AUTO = "auto"  # a lamp where the picture shows its distance, else a sun
SUN = "sun"  # as good as infinitely far away, always
LAMP = "lamp"  # near by, wherever the picture constrains its distance at all
KINDS = (AUTO, SUN, LAMP)
