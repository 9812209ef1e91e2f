"""What is shown of models and shadows, part by part, so that a person sees what they add to the video."""

WHOLE, VIDEO_ALONE = "the model and its shadow", "the video alone"
SPLIT = "the video alone in one half"
SHADOW_ALONE = "the shadow without its model"
PARTS = WHOLE, "the model without its shadow", SHADOW_ALONE, VIDEO_ALONE, SPLIT
