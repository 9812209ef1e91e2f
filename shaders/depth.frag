// Writes depth only. Discards the holes of a cut-out surface, and of a transparent one the share of texels by which it lets
// light through.
#version 330 core

uniform float base_alpha;
uniform float alpha_cutoff;
#ifdef BASE_MAP
#define HAS_MAPS
uniform sampler2D base_map;
#endif
#include "layout.glsl"

void main() {
#if defined(CUT_OUT) || defined(BLEND)
    float alpha = base_alpha;
#ifdef BASE_MAP
    alpha *= texture(base_map, laid_out(BASE)).a;
#endif
#ifdef CUT_OUT
    if (alpha < alpha_cutoff) discard;
#else
    // Bayer's ordered 4 x 4 dithering, which the shadow filter averages.
    ivec2 at = ivec2(gl_FragCoord.xy);
    ivec2 flip = at ^ at.yy * ivec2(1, 0);
    int rank = (flip.x & 1) << 3 | (at.y & 1) << 2 | (flip.x & 2) | (at.y & 2) >> 1;
    if (alpha < (float(rank) + 0.5) / 16.0) discard;
#endif
#endif
}
