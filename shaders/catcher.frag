// Darkens the video where the model keeps light from the ground, by what the real shadow was measured to be, and only
// where the real object's shadow has not done so already.
#version 330 core
#include "srgb.glsl"
#include "ground_shadow.glsl"

uniform sampler2D video;
uniform vec4 viewport;  // left, bottom, width, height in pixels
uniform vec3 sky;  // of lit level ground's light, linear RGB; with the suns' shares it makes 1
#if LIGHTS > 0
uniform vec3 sun_on_ground[LIGHTS];
#endif
uniform sampler2D contact;  // share of the sky that the model hides
uniform vec4 patch_bounds;  // lower x, y and upper x, y of `contact`; metres, the model's own frame

in vec2 ground;
in vec2 ground_placed;
out vec4 encoded;

void main() {
    vec2 at = (ground_placed - patch_bounds.xy) / (patch_bounds.zw - patch_bounds.xy);
    // Ends smoothly at the patch's border, so that the video beyond it is untouched.
    vec2 inside = smoothstep(0.0, CONTACT_FADE, 0.5 - abs(at - 0.5));
    vec3 before = sky;
    vec3 after = sky * (1.0 - texture(contact, at).r * inside.x * inside.y);
#if LIGHTS > 0
    for (int light = 0; light < LIGHTS; ++light) {
        vec3 seen = sun_on_ground[light];
#if CASTERS > 1
        seen *= lit_on_ground(1, light, ground);
#endif
        before += seen;
        after += seen * lit_on_ground(0, light, ground);
    }
#endif
    vec3 ratio = after / max(before, 1e-3);
    if (min(ratio.r, min(ratio.g, ratio.b)) > 0.9995) discard;
    vec3 seen = texture(video, (gl_FragCoord.xy - viewport.xy) / viewport.zw).rgb;
    encoded = vec4(srgb_from_linear(linear_from_srgb(seen) * ratio), 1.0);
}
