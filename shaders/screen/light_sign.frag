// The light's sign: bright where it faces the eye and dark at its rim, so that it looks round and stands out from any video.
#version 330 core
#include "screen/srgb.glsl"

uniform vec3 eye;  // metres, marker frame
uniform vec3 encoded_colour;  // sRGB

in vec3 position;
in vec3 normal;
layout(location = 0) out vec4 added_light;
layout(location = 1) out vec4 removed;

void main() {
    float facing = max(0.0, dot(normalize(normal), normalize(eye - position)));
    vec3 shaded = encoded_colour * mix(0.1, 0.85 + 0.15 * facing, smoothstep(0.35, 0.75, facing));
    added_light = vec4(linear_from_srgb(shaded), 1.0);
    removed = vec4(1.0);
}
