// What relief is measured in: bumps and grain are bright and dark under a sun, and hardly so under the sky alone.

const float DARKEST = 0.002;  // linear brightness that is added, as logarithms of noise about 0 say nothing

float log_brightness(vec3 linear) {
    return log(max(dot(linear, LUMINANCE), 0.0) + DARKEST);
}
