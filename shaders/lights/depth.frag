// Writes depth only. Discards the holes of a cut-out surface, and of a transparent one the share of texels by which it lets
// light through: less where light grazes it, so that the rims of a glass are dark in its shadow.
#version 330 core

uniform float base_alpha;
uniform float alpha_cutoff;
#ifdef VERTEX_COLOURS
in vec4 colour;
#endif
#ifdef BASE_MAP
#define HAS_MAPS
uniform sampler2D base_map;
#endif
#include "model/layout.glsl"
#ifdef BLEND
#include "model/triangle.glsl"
#include "model/glass.glsl"
uniform mat4 clip_from_marker;
in vec3 position;

// The share of light that a surface of plastic or glass mirrors (Schlick 1994).
float mirrored_share() {
    // A ray is where two planes of the light's view meet: that of all points with the same x, and of those with the same y.
    mat4 rows = transpose(clip_from_marker);
    vec4 seen = clip_from_marker * vec4(position, 1.0);
    vec3 ray = cross(rows[0].xyz * seen.w - rows[3].xyz * seen.x, rows[1].xyz * seen.w - rows[3].xyz * seen.y);
    float side = 1.0 - abs(dot(normalize(ray), triangle_normal(position, normalize(ray))));
    return GLASS + (1.0 - GLASS) * pow(side, 5.0);
}
#endif

void main() {
#if defined(CUT_OUT) || defined(BLEND)
    float alpha = base_alpha;
#ifdef VERTEX_COLOURS
    alpha *= colour.a;
#endif
#ifdef BASE_MAP
    alpha *= texture(base_map, laid_out(BASE)).a;
#endif
#ifdef CUT_OUT
    if (alpha < alpha_cutoff) discard;
#else
    if (alpha <= 0.0) discard;  // a hole, and no glass
    alpha += (1.0 - alpha) * mirrored_share();
    // Bayer's ordered 4 x 4 dithering, which the shadow filter averages. What the two sides of a body stop adds up.
    ivec2 at = ivec2(gl_FragCoord.xy);
    ivec2 flip = at ^ at.yy * ivec2(1, 0);
    int rank = (flip.x & 1) << 3 | (at.y & 1) << 2 | (flip.x & 2) | (at.y & 2) >> 1;
    if (!gl_FrontFacing) rank = 15 - rank;
    if (alpha < (float(rank) + 0.5) / 16.0) discard;
#endif
#endif
}
