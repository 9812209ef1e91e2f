// How much of the light on the ground a model can take: all of the lights', and what it hides of the sky. It is kept in the
// alpha of the layer `removed`, between the numbers of a real object's sides and those of models' surfaces, so that
// outlines.frag tells the ground from both.

const float NONE_REMOVABLE = -0.02, ALL_REMOVABLE = -0.12;
// Of another model's contact, which is blended over it: next to nothing, but ground where there was none.
const float SAME_GROUND = -0.0005;

// Difference of what is removable in neighbouring pixels, from which on they are at the border of a shadow in the video.
const float AT_BORDER = 0.03;

bool is_ground(float number) {
    return number < 0.5 * NONE_REMOVABLE && number > 1.02 * ALL_REMOVABLE;
}

float number_of_ground(float removable) {
    return mix(NONE_REMOVABLE, ALL_REMOVABLE, clamp(removable, 0.0, 1.0));
}
