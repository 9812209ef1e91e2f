// Averages texels of a shadow on the ground where its penumbra is wider than they are. Each of them has sampled the light at
// other points, so that nine have sampled it nine times as finely: a wide penumbra has no dots.
#version 330 core
#include "lights/smoothed.glsl"

uniform sampler2D noisy_shadow;  // one tile, as ground_shadow.frag draws it
uniform ivec2 corner;  // of the tile that is drawn

out float lit;

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy) - corner, last = textureSize(noisy_shadow, 0) - 1;
    float radius_m = 0.0;
    mat3 around;
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) {
            vec2 there = texelFetch(noisy_shadow, clamp(at + ivec2(column, row) - 1, ivec2(0), last), 0).rg;
            around[row][column] = there.r;
            radius_m = max(radius_m, there.g);
        }
    }
    vec2 radius = radius_m * texels_per_m;
    vec2 beside = 0.125 * share_smoothed(radius_m) * radius * radius, within = 1.0 - 2.0 * beside;
    lit = dot(vec3(beside.x, within.x, beside.x) * around, vec3(beside.y, within.y, beside.y));
}
