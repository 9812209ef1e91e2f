// Look-up of the shadows on the ground, which render/lights/ground_shadows.py has filtered.
#if LIGHTS > 0
#define MAPS (LIGHTS * CASTERS)

uniform sampler2D ground_shadows;  // fraction of a light that a caster lets through; a tile for each caster and light
uniform mat4 ground_shadow_from_marker[MAPS];
uniform vec2 ground_shadow_lower[MAPS];  // lower left corners of the tiles
uniform vec2 ground_shadow_upper[MAPS];

// Fraction of a light that a caster (0: the model, 1: the real object) lets through to a point of the plane.
float lit_on_ground(int caster, int light, vec2 ground) {
    int map = caster * LIGHTS + light;
    vec4 at = ground_shadow_from_marker[map] * vec4(ground, 0.0, 1.0);
#if LAMPS
    // Nothing is shaded on the ground behind a lamp that sees its caster beside it.
    if (at.w < 1e-3) return 1.0;
    at.xy /= at.w;
#endif
    return texture(ground_shadows, clamp(at.xy, ground_shadow_lower[map], ground_shadow_upper[map])).r;
}

// The light on level ground, as far as the model leaves it, over that at the marker's centre with nothing there.
vec3 light_on_ground(vec2 at) {
    vec3 light = vec3(1.0);
    for (int number = 0; number < LIGHTS; ++number) {
        light += sun_on_ground[number] * (ground_falloff(number, at) * lit_on_ground(0, number, at) - 1.0);
    }
    return light;
}
#else
vec3 light_on_ground(vec2 at) {
    return vec3(1.0);
}
#endif
