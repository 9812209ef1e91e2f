// The fraction of its light that the real object loses where the model blocks a light.
#version 330 core
#define OVER_PIXELS
#include "lights/lights.glsl"
#include "lights/shadow.glsl"
#include "lights/ground_shadow.glsl"

uniform vec3 sky;
uniform vec3 ground_bounce;
#if LIGHTS > 0
uniform vec3 light_irradiance[LIGHTS];
#endif

in vec3 position;
in vec3 smooth_normal;  // by edges of the body's surface sharp
layout(location = 0) out vec4 added_light;  // stays empty
layout(location = 1) out vec4 removed;  // alpha: by which outlines.frag tells its sides from each other and from all else

// From -0.25 down, and hardly ever alike for sides that face different ways.
float number_of_side(vec3 normal) {
    return -0.5 - dot(normal, vec3(0.13, 0.18, 0.11));
}

// The fraction that models leave of the light of the ground on a side with this normal. It comes in thirds from nearer and
// farther ground (ground_shadow.glsl), which may lie in the real object's own shadow.
vec3 left_by_ground(vec3 normal) {
    float height = max(position.z, 0.0);
    vec3 before = vec3(0.0), after = vec3(0.0);
    for (int third = 0; third < 3; ++third) {
        vec2 at = position.xy + THIRDS[third] * height * normal.xy;
        float width_m = WIDTHS[third] * height;
        before += sky;
        after += sky;
#if LIGHTS > 0
        for (int light = 0; light < LIGHTS; ++light) {
            vec3 arriving = light_ground_share[light] * ground_falloff(light, at) * lit_around(GROUPS, light, at, width_m);
            before += arriving;
            after += arriving * lit_around_models(light, at, width_m);
        }
#endif
    }
    return after / max(before, 1e-3);
}

void main() {
    vec3 normal = normalize(smooth_normal);
    float upward = 0.5 + 0.5 * normal.z;
    vec3 from_ground = ground_bounce * bounce_at(position, normal) * (1.0 - upward);
    vec3 before = sky * upward + from_ground;
    vec3 after = sky * upward + from_ground * left_by_ground(normal);
#if LIGHTS > 0
    for (int light = 0; light < LIGHTS; ++light) {
        // Parts of the object that face away from a light receive none of it anyway.
        float falloff;
        vec3 seen = light_irradiance[light] * max(0.0, dot(normal, towards_light(light, position, falloff)));
        seen *= falloff;
        before += seen;
        after += seen * lit_past_models(light, position);
    }
#endif
    added_light = vec4(0.0);
    removed = vec4(1.0 - after / max(before, 1e-3), number_of_side(normal));
}
