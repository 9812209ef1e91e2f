// The composite: the video times the fraction of its light that is left, plus the light of the model, both blurred as the
// video is. Then it is sharpened, its colours are blurred, and noise is added, as the video's own camera does. Pixels that
// nothing was drawn near keep the video as it is.
#version 330 core
#include "screen/srgb.glsl"
#include "compositing/middle.glsl"
#include "compositing/relief.glsl"
#ifdef COVERS
#include "catchers/cover.glsl"
#endif
#ifdef SHADOWS_MEET
#include "catchers/removable.glsl"
#include "compositing/video_borders.glsl"
#endif

uniform sampler2D added_light;  // linear RGB; alpha: fraction of the pixel that the model covers, or as in cover.glsl
uniform sampler2D removed;  // fraction of the video's light that is gone, linear RGB; alpha: as in removable.glsl
uniform sampler2D video;
uniform float weights[REACH + 1];  // of the kernel's middle row or column, and of its neighbours on either side
#ifdef WIDE
uniform float wide_weights[REACH + 1];  // of a blur one pixel wider, as unsharp masking needs
uniform float sharpening;
#endif
#ifdef COARSE
uniform sampler2D coarse_light;  // the layers, blurred as the video's colours are, at half the resolution
#endif
uniform sampler2D coarse_gone;  // alpha: as halved.frag marks it, by the largest difference of the layers near by
#ifdef OVEREXPOSED
uniform vec3 paper;  // linear RGB of what the picture shows as white, beyond 1 where the picture clips it
// CLIPS_FROM and CLIPS_TO: linear brightness at which clipping begins and is complete.
#endif
#ifdef RELIEF
uniform sampler2D ground_mean;  // as ground_mean.frag draws it
uniform vec2 means;  // how many of its texels are across and up the viewport
uniform float contrast_left;  // contrast of the ground's relief in the real shadow over that in the light
uniform float most_relief;  // deviation of the logarithm beyond which it is paint, which shadows leave as it is
uniform float sky_share;  // of the light on lit ground
#endif
uniform float noise_sigmas[4];  // standard deviations in encoded values, at the middles of four ranges of brightness
uniform vec2 grain_px;  // size of a pixel of the video, in pixels of the viewport
uniform int seed;

out vec4 encoded;

const int ACROSS = max(REACH, 2);  // rows plus columns from the kernel's middle; the smallest kernel is a full square
#ifdef COVERS
// Noise that is added to the cover, over the video's: it keeps 0.25 to 0.57 of the noise of the frame that it was made from,
// which stands still, so that both together are 0.9 to 1.02 of it.
const float COVER_NOISE = 0.85;
#endif
const float EVEN = 0.006;  // linear difference within a kernel's reach below which blurring changes nothing visible

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

float noise_sigma(float brightness) {
    float at = clamp(4.0 * brightness - 0.5, 0.0, 3.0);
    int below = min(int(at), 2);
    return mix(noise_sigmas[below], noise_sigmas[below + 1], at - float(below));
}

// Reads a layer a whole number of pixels from `middle`, which lies between pixels if the lens distorts. What the video's
// border cuts off goes on beyond it as it is there.
vec4 read(sampler2D layer, vec2 middle, int column, int row) {
#ifdef BENDS
    vec2 at = clamp(middle + vec2(column, row), viewport.xy + 0.5, viewport.xy + viewport.zw - 0.5);
    return textureLod(layer, at / vec2(textureSize(layer, 0)), 0.0);
#else
    ivec2 lower = ivec2(viewport.xy), upper = ivec2(viewport.xy + viewport.zw) - 1;
    return texelFetch(layer, clamp(ivec2(middle) + ivec2(column, row), lower, upper), 0);
#endif
}

// What is left of the video's light.
vec3 left_of(vec3 seen, vec3 gone) {
#ifdef OVEREXPOSED
    float share = smoothstep(CLIPS_FROM, CLIPS_TO, dot(seen, LUMINANCE));
    // Of clipped light, what exceeds white is lost first.
    return min(mix(seen, max(seen, paper), share) * (1.0 - gone), max(seen, seen * (1.0 - gone)));
#else
    return seen * (1.0 - gone);
#endif
}

#ifdef AT_OBJECT
#include "compositing/object_outline.glsl"
#endif

#ifdef RELIEF
// The local mean at `at` of the viewport: a cubic B-spline over its texels, by four bilinear looks (Sigg, Hadwiger, "Fast
// third-order texture filtering", GPU Gems 2, 2005).
float ground_mean_at(vec2 at) {
    vec2 size = vec2(textureSize(ground_mean, 0)), place = at * means - 0.5, lower = floor(place), past = place - lower;
    vec2 before = 1.0 - past;
    vec2 first = before * before * before / 6.0, last = past * past * past / 6.0;
    vec2 left = first + 2.0 / 3.0 - 0.5 * past * past * (2.0 - past), right = 1.0 - left;
    vec2 low = (lower + 0.5 - first / left) / size, high = (lower + 1.5 + last / right) / size;
    vec2 below = vec2(textureLod(ground_mean, low, 0.0).r, textureLod(ground_mean, vec2(high.x, low.y), 0.0).r);
    vec2 above = vec2(textureLod(ground_mean, vec2(low.x, high.y), 0.0).r, textureLod(ground_mean, high, 0.0).r);
    vec2 columns = vec2(left.x, right.x);
    return left.y * dot(columns, below) + right.y * dot(columns, above);
}

// The lit ground `seen` with the relief that is left of it where the fraction `gone` of its light is. In full light its
// contrast is 1 = A k + S c under the sky's share A and the lights' S; where V of the lights is left it is
// (A k + V S c) / (A + V S).
vec3 flattened(vec3 seen, vec3 gone, vec2 at) {
    float lights = 1.0 - sky_share, of_sky = sky_share * contrast_left;
    float left = clamp((lights - dot(gone, LUMINANCE)) / lights, 0.0, 1.0);
    float contrast = (of_sky + left * (1.0 - of_sky)) / (sky_share + left * lights);
    float beyond = log_brightness(seen) - ground_mean_at(at);
    return seen * exp((contrast - 1.0) * clamp(beyond, -most_relief, most_relief));
}
#endif

void main() {
    vec2 at = (gl_FragCoord.xy - viewport.xy) / viewport.zw;
    vec2 middle = middle_of_blurs();
#ifdef BENDS
    if (any(lessThan(middle, region.xy)) || any(greaterThan(middle, region.xy + region.zw))) discard;
#endif
    vec4 coarse_removed = textureLod(coarse_gone, in_coarse(middle, coarse_gone), 0.0);
    // Most of a picture is even, or changes steadily over a kernel's width, and needs no blur.
    bool is_even = coarse_removed.a < 1.0 + EVEN;
#ifdef COARSE
    vec4 coarse_added = textureLod(coarse_light, in_coarse(middle, coarse_light), 0.0);
#endif
    float as_it_is = is_even ? 1.0 : 0.0;
    vec4 light = as_it_is * read(added_light, middle, 0, 0);
    vec3 gone = as_it_is * read(removed, middle, 0, 0).rgb;
#ifdef WIDE
    // Cameras clip before they sharpen: what is far beyond white darkens its surroundings no more than white does.
    vec4 wide_light = min(light, 1.0);
    vec3 wide_gone = gone;
#endif
    // A software rasteriser saves time when a loop ends early, but not when a branch is not taken.
    int rows = is_even ? -REACH - 1 : REACH;
    for (int row = -REACH; row <= rows; ++row) {
        // A diamond has half of the square's pixels but nearly all of the kernel's weight.
        int columns = min(REACH, ACROSS - abs(row));
        float row_weight = weights[abs(row)];
#ifdef WIDE
        float wide_row_weight = wide_weights[abs(row)];
#endif
        for (int column = -columns; column <= columns; ++column) {
            float weight = row_weight * weights[abs(column)];
            vec4 light_there = read(added_light, middle, column, row);
            vec3 gone_there = read(removed, middle, column, row).rgb;
            light += weight * light_there;
            gone += weight * gone_there;
#ifdef WIDE
            float wide_weight = wide_row_weight * wide_weights[abs(column)];
            wide_light += wide_weight * min(light_there, 1.0);
            wide_gone += wide_weight * gone_there;
#endif
        }
    }
#ifdef SHADOWS_MEET
    float removable = removable_in(read(added_light, middle, 0, 0), read(removed, middle, 0, 0));
    OfGround of_ground = OfGround(vec4(0.0), 0.0, 0.0);
#ifdef WIDE
    OfGround wide_of_ground = of_ground;
#endif
    // Again, where there is such a border: few pixels.
    rows = coarse_removed.a < 1.5 ? -REACH - 1 : REACH;
    for (int row = -REACH; row <= rows; ++row) {
        int columns = min(REACH, ACROSS - abs(row));
        for (int column = -columns; column <= columns; ++column) {
            vec4 gone_there = read(removed, middle, column, row);
            float removable_there = removable_in(read(added_light, middle, column, row), gone_there);
            float weight = weights[abs(row)] * weights[abs(column)];
            of_ground = adding(of_ground, weight, gone_there.rgb, removable_there);
#ifdef WIDE
            weight = wide_weights[abs(row)] * wide_weights[abs(column)];
            wide_of_ground = adding(wide_of_ground, weight, gone_there.rgb, removable_there);
#endif
        }
    }
    float factor = factor_at(removable, of_ground);
    vec3 own_gone = read(removed, middle, 0, 0).rgb;
    gone += gone_at_border(own_gone, removable, factor, of_ground) - of_ground.gone.rgb;
#ifdef WIDE
    float wide_factor = factor_at(removable, wide_of_ground);
    wide_gone += gone_at_border(own_gone, removable, wide_factor, wide_of_ground) - wide_of_ground.gone.rgb;
#endif
    // The border of the video's colours is theirs already, however wide.
    coarse_removed.rgb = mix(coarse_removed.rgb, gone, of_ground.weight);
#endif
#ifdef AT_OBJECT
    AcrossOutline across = across_outline(middle, at, linear_from_srgb(textureLod(video, at, 0.0).rgb));
    light = mix(light, across.light, across.nearness);
    gone = mix(gone, across.gone, across.nearness);
#ifdef WIDE
    // The video's own border has been sharpened.
    wide_light = mix(wide_light, min(across.light, 1.0), across.nearness);
    wide_gone = mix(wide_gone, across.gone, across.nearness);
#endif
    coarse_removed.rgb = mix(coarse_removed.rgb, across.gone, across.nearness);
#ifdef COARSE
    // Else the model's colour would be left where the object's outline is beside its body's.
    coarse_added = mix(coarse_added, min(across.light, 1.0), across.nearness);
#endif
#endif
    vec3 change = abs(gone);
#ifdef WIDE
    change = max(change, abs(wide_gone));
#endif
#ifdef COARSE
    change = max(change, max(abs(coarse_removed.rgb), coarse_added.aaa));
#endif
    if (max(light.a, max(change.r, max(change.g, change.b))) < 0.0005) discard;
    vec3 seen = linear_from_srgb(texture(video, at).rgb);
#ifdef COVERS
    vec4 covering = cover_in(middle);
    // The model's part of the pixel, beside or in front of the cover.
    float of_cover = COVER_ALPHA * covering.a;
    float of_model = clamp((light.a - of_cover) / (1.0 - of_cover), 0.0, 1.0);
    covering.a *= min(light.a / COVER_ALPHA, 1.0);  // as much of it as is visible
    seen = mix(seen, covering.rgb, covering.a);
#endif
#ifdef RELIEF
    seen = flattened(seen, gone, at);
#endif
    vec3 composed = srgb_from_linear(left_of(seen, gone) + light.rgb);
    float luma = dot(composed, LUMINANCE);
#ifdef WIDE
    vec3 wide = srgb_from_linear(left_of(seen, wide_gone) + wide_light.rgb);
    float sharpened = sharpening * (luma - dot(wide, LUMINANCE));
#else
    float sharpened = 0.0;
#endif
#ifdef COARSE
    vec3 coarse = srgb_from_linear(left_of(seen, coarse_removed.rgb) + coarse_added.rgb);
    composed = luma + coarse - dot(coarse, LUMINANCE);
#endif
    composed += sharpened;
    uvec2 grain = uvec2((gl_FragCoord.xy - viewport.xy) / grain_px);
#ifdef COVERS
    // In the model's shadow the cover's noise is darkened with its light, as the video's own is beside it: by sRGB's power of
    // 1 / 2.4, for which a mean of two roots will do.
    float root = sqrt(clamp(1.0 - dot(gone, LUMINANCE), 1e-6, 1.0));
    float darker_by = mix(root, sqrt(root), 1.0 / 3.0);
    float of_noise = mix(COVER_NOISE * covering.a * darker_by, 1.0, of_model);
    composed += noise_sigma(luma / mix(darker_by, 1.0, of_model)) * of_noise * noise(grain);
#else
    composed += noise_sigma(luma) * light.a * noise(grain);
#endif
#ifdef CUT_OUT
    // The layer that gives this picture when it is put over the video: as transparent as possible, but opaque where the
    // model or the cover is.
    vec3 behind = texture(video, at).rgb;
    vec3 wanted = clamp(composed, 0.0, 1.0);
    vec3 darker = (behind - wanted) / max(behind, 0.5 / 255.0);
    vec3 brighter = (wanted - behind) / max(1.0 - behind, 0.5 / 255.0);
    vec3 least = max(darker, brighter);
    float opaque = light.a;
#ifdef COVERS
    opaque = max(opaque, covering.a);
#endif
    float alpha = clamp(max(opaque, max(least.r, max(least.g, least.b))), 0.0, 1.0);
    if (alpha < 0.5 / 255.0) discard;
    // Alpha is rounded to the byte that will be stored, so that the colour can make up for the rounding.
    alpha = ceil(alpha * 255.0) / 255.0;
    encoded = vec4((wanted - (1.0 - alpha) * behind) / alpha, alpha);
#else
    encoded = vec4(composed, 1.0);
#endif
}
