// Adds the lens's blur and the sensor's noise to the model; the video, which has both already, is left unchanged.
#version 330 core

uniform sampler2D picture;  // alpha: 1 where it is the video's, 0 where it is the model's
uniform vec2 blur_step;  // offset to the neighbouring taps of a binomial kernel, in texture coordinates
uniform float noise_sigma;  // standard deviation, of encoded values
uniform vec2 grain_px;  // size of a pixel of the video, in pixels of the viewport
uniform vec2 origin_px;  // the video's lower left corner
uniform int seed;

out vec4 encoded;

// Jarzynski, Olano, "Hash functions for GPU rendering", JCGT 2020: PCG.
uint scrambled(uint value) {
    uint state = value * 747796405u + 2891336453u;
    uint word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return (word >> 22u) ^ word;
}

// Approximately standard normal: the sum of the four bytes of a hash.
float noise(uvec2 at) {
    uint bits = scrambled(at.x + scrambled(at.y + scrambled(uint(seed))));
    vec4 bytes = vec4(bits & 255u, (bits >> 8u) & 255u, (bits >> 16u) & 255u, bits >> 24u);
    return (dot(bytes, vec4(1.0)) / 255.0 - 2.0) * 1.7253;
}

void main() {
    vec2 size = vec2(textureSize(picture, 0));
    vec2 at = gl_FragCoord.xy / size;
    // A lens blurs linear light; squares of encoded values approximate it well enough between two neighbours.
    vec3 model = vec3(0.0);
    vec3 video = vec3(0.0);
    float share = 0.0;
    for (int row = -1; row <= 1; ++row) {
        for (int column = -1; column <= 1; ++column) {
            float weight = (row == 0 ? 0.5 : 0.25) * (column == 0 ? 0.5 : 0.25);
            vec4 tap = texture(picture, at + vec2(column, row) * blur_step);
            vec3 light = weight * tap.rgb * tap.rgb;
            model += light * (1.0 - tap.a);
            video += light * tap.a;
            share += weight * (1.0 - tap.a);
        }
    }
    if (share < 0.004) discard;
    vec4 own = texelFetch(picture, ivec2(gl_FragCoord.xy), 0);
    // The video's pixels are not blurred again.
    vec3 behind = own.a > 0.99 ? own.rgb * own.rgb * (1.0 - share) : video;
    uvec2 grain = uvec2((gl_FragCoord.xy - origin_px) / grain_px);
    encoded = vec4(sqrt(model + behind) + noise_sigma * share * noise(grain), 1.0 - share);
}
