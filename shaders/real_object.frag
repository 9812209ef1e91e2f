// Darkens the real object in the video where the model blocks a light from it.
#version 330 core
#include "srgb.glsl"
#include "lights.glsl"
#include "shadow.glsl"

uniform sampler2D video;
uniform vec4 viewport;  // left, bottom, width, height in pixels
uniform vec3 sky;
uniform vec3 ground_bounce;
#if LIGHTS > 0
uniform vec3 sun[LIGHTS];
#endif

in vec3 position;
out vec4 encoded;

void main() {
    vec3 normal = normalize(cross(dFdx(position), dFdy(position)));
    float upward = 0.5 + 0.5 * normal.z;
    vec3 before = sky * upward + ground_bounce * (1.0 - upward);
    vec3 after = before;
#if LIGHTS > 0
    for (int light = 0; light < LIGHTS; ++light) {
        // Parts of the object that face away from a light receive none of it anyway.
        float falloff;
        vec3 seen = sun[light] * max(0.0, dot(normal, towards_light(light, position, falloff)));
        seen *= falloff;
        before += seen;
        after += seen * lit_past(0, light, position);
    }
#endif
    vec3 seen = texture(video, (gl_FragCoord.xy - viewport.xy) / viewport.zw).rgb;
    encoded = vec4(srgb_from_linear(linear_from_srgb(seen) * after / max(before, 1e-3)), 1.0);
}
