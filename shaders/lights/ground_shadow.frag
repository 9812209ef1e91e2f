// The fraction of a light that a caster lets through to the ground, for one light and one caster.
#version 330 core
#include "lights/lights.glsl"
#include "lights/shadow.glsl"
#include "lights/smoothed.glsl"

uniform int caster;
uniform int light;
#ifdef SEEN
// What a picture says of the shadow: the share of the light that arrives, and how far it says so.
uniform sampler2D seen_shadow;
uniform vec4 seen_bounds;  // lower x, y and upper x, y of it; metres, marker frame
#endif

in vec3 ground;
out vec2 lit;  // and for smoothed_shadow.frag the penumbra's radius across the light in metres; 0 where there is none

void main() {
    lit = vec2(1.0, 0.0);
    if (ground.z < 1e-4) return;  // rays above the horizon of a lamp never meet the ground
    int map = caster * LIGHTS + light;
    float scale;
    // The map's depth range ends behind the caster but the ground goes on: lit_fraction clamps points beyond the range.
    vec3 at = in_map(map, vec3(ground.xy / ground.z, 0.0), scale);
    vec2 ray = first_ray(gl_FragCoord.xy);
    Blockers blockers = blockers_of(map, tan_half_size[map], at, NOT_IN_MAP, ray);
    // Variances add up: what averaging will add to the penumbra is left out here.
    vec2 radius_m = blockers.radius_m * sqrt(1.0 - share_smoothed(blockers.radius_m));
    vec2 radius = max(vec2(LEAST_RADIUS), radius_m * shadow_map_size / shadow_extent[map].xy);
    lit = vec2(lit_fraction(map, at, NOT_IN_MAP, ray, blockers, radius), is_penumbra(blockers) ? blockers.radius_m : 0.0);
#ifdef SEEN
    vec2 seen = texture(seen_shadow, (ground.xy / ground.z - seen_bounds.xy) / (seen_bounds.zw - seen_bounds.xy)).rg;
    lit.r = mix(lit.r, seen.r, seen.g);
#endif
}
