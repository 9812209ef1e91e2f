// Matt surfaces under a sky, a sun, and the light that the ground sends back; encoded once, last.
#version 330 core
#include "srgb.glsl"
#include "shadow.glsl"

uniform sampler2D base_texture;  // decoded to linear by the sampler
uniform vec4 base_colour;
uniform vec3 sky;  // irradiance on level ground over pi, linear RGB
uniform vec3 sun;  // the same across its direction; zero without a light
uniform vec3 to_light;
uniform vec3 ground_bounce;
uniform float exposure;
uniform float shadow_texel_m;

in vec3 position;
in vec3 normal;
in vec2 uv;
in vec4 colour;
out vec4 encoded;

void main() {
    vec4 albedo = base_colour * colour * texture(base_texture, uv);
    if (albedo.a < 0.5) discard;
    vec3 n = normalize(gl_FrontFacing ? normal : -normal);
    float upward = 0.5 + 0.5 * n.z;
    vec3 irradiance = sky * upward + ground_bounce * (1.0 - upward);
    float cosine = dot(n, to_light);
    if (cosine > 0.0 && sun != vec3(0.0)) {
        // A tap t texels aside compares with a depth t tan(theta) off; moving along the normal by t sin(theta)
        // makes up for exactly that on a plane, at every slope.
        float reach = 1.5 * float(PCF_RADIUS + 1) * shadow_texel_m;
        float sine = sqrt(max(0.0, 1.0 - cosine * cosine));
        irradiance += sun * cosine * lit_fraction(position + n * (reach * sine) + to_light * (0.5 * shadow_texel_m));
    }
    encoded = vec4(srgb_from_linear(albedo.rgb * irradiance * exposure), 1.0);
}
