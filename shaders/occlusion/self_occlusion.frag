// How much of sky and ground the model hides from points on its own surface, in front of it and behind it: the sum over
// a few directions at a time.
#version 330 core
#include "lights/lights.glsl"
#include "lights/shadow.glsl"

uniform sampler2D sample_places;  // metres, the model's own frame
uniform sampler2D sample_normals;
uniform float weight;

out vec4 hidden;

void main() {
    vec3 position = texelFetch(sample_places, ivec2(gl_FragCoord.xy), 0).xyz;
    vec3 normal = texelFetch(sample_normals, ivec2(gl_FragCoord.xy), 0).xyz;
    hidden = vec4(0.0);
    for (int light = 0; light < LIGHTS; ++light) {
        vec3 direction = light_point[light].xyz;
        float cosine = dot(normal, direction);
        float lit = lit_past_itself(0, light, position, cosine < 0.0 ? -normal : normal, direction);
        float here = weight * abs(cosine) * (1.0 - lit);
        vec2 of = direction.z > 0.0 ? vec2(here, 0.0) : vec2(0.0, here);
        hidden += cosine < 0.0 ? vec4(0.0, 0.0, of) : vec4(of, 0.0, 0.0);
    }
}
