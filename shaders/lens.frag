// The camera's original picture, with the changes that were drawn for a pinhole camera distorted as by the lens.
#version 330 core
#include "srgb.glsl"

uniform sampler2D original;  // the frame as captured
uniform sampler2D bare;  // the pinhole camera's picture without the model
uniform sampler2D drawn;  // and with it; alpha: 1 where it is the video's, 0 where it is the model's
uniform sampler2D straight_from_bent;  // undistorted coordinates by those of the video; a coarse grid
uniform vec4 viewport;  // left, bottom, width, height in pixels
uniform vec4 region;  // the pinhole picture's part in which something is drawn, the same

in vec2 at;
out vec4 encoded;

void main() {
    vec2 nodes = vec2(textureSize(straight_from_bent, 0));
    vec2 straight = texture(straight_from_bent, (at * (nodes - 1.0) + 0.5) / nodes).xy;
    vec2 pixel = viewport.xy + straight * viewport.zw;
    encoded = texture(original, at);
    if (all(greaterThan(pixel, region.xy)) && all(lessThan(pixel, region.xy + region.zw))) {
        vec2 place = pixel / vec2(textureSize(drawn, 0));
        vec4 with_model = texture(drawn, place);
        vec3 without = texture(bare, place).rgb;
        if (with_model.a < 0.98) {
            encoded = vec4(with_model.rgb, 1.0);
        } else if (any(greaterThan(abs(with_model.rgb - without), vec3(0.003)))) {
            // A shadow: its ratio is applied to the original, which has not been softened by interpolation.
            vec3 ratio = linear_from_srgb(with_model.rgb) / max(linear_from_srgb(without), 1e-3);
            encoded = vec4(srgb_from_linear(linear_from_srgb(encoded.rgb) * ratio), 1.0);
        }
    }
}
