"""The parts of the picture that key B shows in turn, to compare it with the video alone."""

WHOLE, VIDEO_ALONE = "the model and its shadow", "the video alone"
SPLIT = "the video alone in one half"
SHADOW_ALONE = "the shadow without its model"
PARTS = WHOLE, "the model without its shadow", SHADOW_ALONE, VIDEO_ALONE, SPLIT
