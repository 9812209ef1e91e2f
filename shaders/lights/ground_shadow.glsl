// Looks up the shadows on the ground, prefiltered by render/lights/ground_shadows.py.

// Of the light that a point at height h on a wall gets from the ground, the part 1 - h / sqrt(h^2 + d^2) comes from within a
// distance d of the wall: a third from nearer than 1.1 h, a third from farther than 2.8 h. In units of h, the middles of the
// three thirds, and half of the widths over which each is averaged.
const float THIRDS[3] = float[](0.66, 1.73, 5.92);
const float WIDTHS[3] = float[](0.55, 0.85, 2.9);

#if LIGHTS > 0
#define MAPS (LIGHTS * CASTERS)

uniform sampler2D ground_shadows;  // fraction of a light that a caster lets through; a tile for each caster and light
uniform mat4 ground_shadow_from_marker[MAPS];
uniform vec2 ground_shadow_lower[MAPS];  // lower left corners of the tiles
uniform vec2 ground_shadow_upper[MAPS];
uniform float ground_shadow_levels;  // mipmap levels in which a tile still has several texels

// Finds the texture coordinates of a point of the plane. False where the map has no such point, as it is behind the lamp,
// where nothing is shaded.
bool is_on_map(int map, vec2 ground, out vec2 at) {
    vec4 seen = ground_shadow_from_marker[map] * vec4(ground, 0.0, 1.0);
    at = seen.xy;
#if LAMPS
    if (seen.w < 1e-3) return false;
    at /= seen.w;
#endif
    return true;
}

// How many texels of the texture, of `size` (2,) in texels, a metre of the plane has at a point that the map shows.
float texels_per_m(int map, vec2 ground, vec2 size) {
    mat4 seen_from_ground = ground_shadow_from_marker[map];
    vec2 along_x = seen_from_ground[0].xy, along_y = seen_from_ground[1].xy;
#if LAMPS
    vec4 seen = seen_from_ground * vec4(ground, 0.0, 1.0);
    vec2 at = seen.xy / seen.w;
    along_x = (along_x - at * seen_from_ground[0].w) / seen.w;
    along_y = (along_y - at * seen_from_ground[1].w) / seen.w;
#endif
    return sqrt(abs(determinant(mat2(along_x * size, along_y * size))));
}

// The fraction of a light that a caster, in the order of shadow.glsl, lets through to a point of the plane.
float lit_on_ground(int caster, int light, vec2 ground) {
    int map = caster * LIGHTS + light;
    vec2 at;
    if (!is_on_map(map, ground, at)) return 1.0;
    return textureLod(ground_shadows, clamp(at, ground_shadow_lower[map], ground_shadow_upper[map]), 0.0).r;
}

// The same for all models together.
float lit_past_models(int light, vec2 ground) {
    float lit = 1.0;
    for (int group = 0; group < GROUPS; ++group) lit *= lit_on_ground(group, light, ground);
    return lit;
}

// The mean of that fraction over about `width_m` of the plane.
float lit_around(int caster, int light, vec2 ground, float width_m) {
    int map = caster * LIGHTS + light;
    vec2 at;
    if (!is_on_map(map, ground, at)) return 1.0;
    vec2 size = vec2(textureSize(ground_shadows, 0));
    float texels = max(width_m * texels_per_m(map, ground, size), 1.0);
    vec2 width = texels / size, tile = ground_shadow_upper[map] - ground_shadow_lower[map];
    // From the tile's border to the middle of such a width there, or to the tile's own middle.
    vec2 within = min(0.5 * (width - 1.0 / size), 0.5 * tile);
    vec2 nearest = clamp(at, ground_shadow_lower[map] + within, ground_shadow_upper[map] - within);
    // Nothing beyond the tile is shaded: a width that exceeds it is lit but for the tile's part of it.
    vec2 beyond = abs(at - nearest) / width, inside = min(tile / width, 1.0);
    float lit = textureLod(ground_shadows, nearest, min(log2(texels), ground_shadow_levels)).r;
    lit = mix(1.0, lit, inside.x * inside.y);
    return mix(lit, 1.0, min(max(beyond.x, beyond.y), 1.0));
}

// The same for all models together.
float lit_around_models(int light, vec2 ground, float width_m) {
    float lit = 1.0;
    for (int group = 0; group < GROUPS; ++group) lit *= lit_around(group, light, ground, width_m);
    return lit;
}

// The light that the models leave on level ground, averaged over about `width_m`, relative to the unshaded light at the
// marker's centre.
vec3 light_on_ground(vec2 at, float width_m) {
    vec3 light = vec3(1.0);
    for (int number = 0; number < LIGHTS; ++number) {
        light += light_ground_share[number] * (ground_falloff(number, at) * lit_around_models(number, at, width_m) - 1.0);
    }
    return light;
}
#else
vec3 light_on_ground(vec2 at, float width_m) {
    return vec3(1.0);
}
#endif
