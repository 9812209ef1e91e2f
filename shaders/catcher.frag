// Darkens the video where the model keeps light from the ground, by what the real shadow was measured to be.
#version 330 core
#include "srgb.glsl"
#include "shadow.glsl"

uniform sampler2D video;
uniform vec4 viewport;  // left, bottom, width, height in pixels
uniform vec3 shadow_ratio;  // linear RGB of shadowed over lit ground: what the sky alone gives
uniform bool has_sun;
uniform sampler2D contact;  // share of the sky that the model hides
uniform vec4 patch_bounds;  // lower x, y and upper x, y of `contact`; metres, marker frame

in vec2 ground;
out vec4 encoded;

void main() {
    float sun = has_sun ? lit_fraction(vec3(ground, 0.0)) : 1.0;
    vec2 at = (ground - patch_bounds.xy) / (patch_bounds.zw - patch_bounds.xy);
    // Ends smoothly at the patch's border, so that the video beyond it is untouched.
    vec2 inside = smoothstep(0.0, CONTACT_FADE, 0.5 - abs(at - 0.5));
    float sky = 1.0 - texture(contact, at).r * inside.x * inside.y;
    vec3 ratio = shadow_ratio * sky + (1.0 - shadow_ratio) * sun;
    if (min(ratio.r, min(ratio.g, ratio.b)) > 0.9995) discard;
    vec3 seen = texture(video, (gl_FragCoord.xy - viewport.xy) / viewport.zw).rgb;
    encoded = vec4(srgb_from_linear(linear_from_srgb(seen) * ratio), 1.0);
}
