// For each place on the ground around a model: the light, over pi, that the ground reflects onto what is seen of the nearest
// wall from there. Near its foot a wall faces ground in the model's shadow, farther up also ground beyond it.
#version 330 core
#include "lights/lights.glsl"
#include "lights/ground_shadow.glsl"

uniform sampler2D contact;  // as in catchers/ground.frag
uniform vec4 patch_bounds;  // lower x, y and upper x, y of `contact`; metres, the model's own frame
uniform vec4 model_bounds;  // the same for the model itself
uniform float model_height;
uniform mat4 marker_from_placed;
uniform vec3 ground_bounce;

out vec4 on_wall;

void main() {
    vec2 at = gl_FragCoord.xy / vec2(textureSize(contact, 0));
    vec2 ground_placed = mix(patch_bounds.xy, patch_bounds.zw, at);
    vec2 outward = normalize(-texture(contact, at).yz + vec2(1e-9, 0.0));
    vec2 foot = clamp(ground_placed, model_bounds.xy, model_bounds.zw);
    // The direction below which half of the sky hidden by a wall is: its cosine is the mean of 1 and that of the wall's top.
    float away = distance(ground_placed, foot);
    float cosine = 0.5 + 0.5 * away * inversesqrt(max(away * away + model_height * model_height, 1e-12));
    float height = away * sqrt(max(1.0 - cosine * cosine, 0.0)) / cosine;
    float scale = length(marker_from_placed[0].xyz);
    vec3 light = vec3(0.0);
    for (int third = 0; third < 3; ++third) {
        vec2 before = foot + THIRDS[third] * height * outward;
        light += light_on_ground((marker_from_placed * vec4(before, 0.0, 1.0)).xy, WIDTHS[third] * scale * height);
    }
    on_wall = vec4(ground_bounce * light / 3.0, 1.0);
}
