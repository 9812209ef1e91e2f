// The radiance from a direction, blurred by the surface's roughness: of the sky, or of the ground as the picture shows it
// where the ray meets it. The maps' layouts are those of render/reflections/surroundings.py.

uniform sampler2D ground_map;  // linear RGB of the picture
uniform vec3 ground_white;  // value in it of a radiance of 1, by that picture's own exposure
uniform float half_radius_m;
uniform float environment_size;  // texels a side

// The mean radiance of the ground over about `width_m`, as the picture shows it.
vec3 ground_seen(vec2 at, float width_m) {
    float far = length(at) + half_radius_m;
    // The size of the map's texels there, in metres.
    float texel_m = 2.0 * far * far / (half_radius_m * environment_size);
    return textureLod(ground_map, 0.5 + 0.5 * at / far, log2(width_m / texel_m + 1e-3)).rgb / ground_white;
}

// The fraction of the ground's light that the model leaves, averaged over about `width_m`.
vec3 left_on_ground(vec2 at, float width_m) {
#if LIGHTS > 0
    return light_on_ground(at, width_m) / max(level_at(at), 1e-3);
#else
    return vec3(1.0);
#endif
}

#ifdef MIRRORS
uniform sampler2D sky_map;  // relative to the mean sky

// Half of the facets of a GGX surface are tilted by less than alpha (Walter et al. 2007), so that half of what it mirrors
// comes from within 2 alpha of the mirrored direction. A Gaussian with half of its weight within 2 alpha has a standard
// deviation of 1.7 alpha. A mipmap level with texels 2.4 alpha wide blurs as much, as texel and interpolation together have
// a standard deviation of 0.7 texels; so does a smooth step that reaches 3.8 alpha to either side.
const float TEXELS = 2.4;
const float STEP = 3.8;
// Radians, of what a pixel mirrors. At an outline the neighbouring pixel's normal may be any, as it lies beside the triangle.
const float MOST_TURNED = 0.5;

// A shadow's border shows the kinks of an interpolation between texels as wide as the lobe. So two looks at finer ones blur it
// together, farther along the ray than across it, as the lobe meets the ground aslant.
const float ASIDE = 0.56;
const float FINER = 0.8;

// The fraction of the ground's light that the model leaves where a lobe, `lobe_m` wide and horizontally in the direction
// `along`, meets it, averaged over `least_m` at least.
vec3 left_in_lobe(vec2 at, vec2 along, float lobe_m, float least_m) {
    vec2 aside = ASIDE * lobe_m * along;
    float texel_m = max(FINER * lobe_m, least_m);
    return 0.5 * (left_on_ground(at + aside, texel_m) + left_on_ground(at - aside, texel_m));
}

// The radiance from the unit direction `towards` at the point `from`, as a GGX surface of this `alpha` mirrors it.
vec3 surrounding_radiance(vec3 from, vec3 towards, float alpha) {
    float down = max(-towards.z, 0.02);
    float distance = max(from.z, 0.0) / down;
    vec2 meets = from.xy + towards.xy * distance;
    // What a pixel mirrors, which a curved surface spreads wide, is averaged: borders in it would be staircases otherwise.
    float mirrored_m = min(max(length(dFdx(meets)), length(dFdy(meets))), MOST_TURNED * distance);
    float mirrored_z = length(vec2(dFdx(towards.z), dFdy(towards.z)));
    // The lobe's mean width there.
    float lobe_m = TEXELS * alpha * distance * inversesqrt(down);
    vec2 along = normalize(towards.xy + vec2(1e-6, 0.0));
    vec3 ground = ground_seen(meets, max(lobe_m, mirrored_m)) * left_in_lobe(meets, along, lobe_m, mirrored_m);
    float up = max(towards.z, 0.0);
    // A texel of the sky's map spans 4 / size radians in the middle of the map, half of that at the horizon.
    vec2 at = 0.5 + 0.5 * along * sqrt((1.0 - up) / (1.0 + up));
    vec3 above = sky * textureLod(sky_map, at, log2(TEXELS * 0.25 * alpha * environment_size)).rgb;
    float width = clamp(max(STEP * alpha, mirrored_z), 0.01, 1.0);
    return mix(ground, above, smoothstep(-width, width, towards.z));
}
#endif
