// Bright where it faces the eye and dark at its rim, so that the sign looks round and stands out from any video.
#version 330 core

uniform vec3 eye;  // metres, marker frame
uniform vec3 encoded_colour;

in vec3 position;
in vec3 normal;
out vec4 encoded;

void main() {
    float facing = max(0.0, dot(normalize(normal), normalize(eye - position)));
    encoded = vec4(encoded_colour * mix(0.1, 0.85 + 0.15 * facing, smoothstep(0.35, 0.75, facing)), 1.0);
}
