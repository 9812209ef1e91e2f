// How far the texels of a shadow on the ground are averaged with those around them, which sample other points of the light.

uniform vec2 texels_per_m;  // of the tile that is drawn, across the light
uniform float smoothed_share;  // of a penumbra's variance, at most; 0: nothing is averaged

const float MOST_VARIANCE = 2.0 / 3.0;  // texels squared, of three texels that weigh the same

// The share of a penumbra's variance, a quarter of its squared radius, that averaging adds along both axes.
vec2 share_smoothed(float radius_m) {
    vec2 radius = radius_m * texels_per_m;
    return min(vec2(smoothed_share), 4.0 * MOST_VARIANCE / max(radius * radius, 1e-6));
}
