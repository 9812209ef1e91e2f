// The radiance from a direction, blurred by the surface's roughness: the ground as seen in the picture, at the point
// where the ray meets it, and the sky. The layouts of the maps are those of render/lights/surroundings.py.

uniform sampler2D ground_map;  // linear RGB of the picture
uniform float half_radius_m;
uniform float environment_size;  // texels a side

// Mean radiance of the ground, as it is in the picture, over about `width_m`.
vec3 ground_seen(vec2 at, float width_m) {
    float far = length(at) + half_radius_m;
    // Size of a texel of the map there in metres.
    float texel_m = 2.0 * far * far / (half_radius_m * environment_size);
    return textureLod(ground_map, 0.5 + 0.5 * at / far, log2(width_m / texel_m + 1e-3)).rgb / exposure;
}

// What the model leaves of the light there, over about `width_m`.
vec3 left_on_ground(vec2 at, float width_m) {
#if LIGHTS > 0
    return light_on_ground(at, width_m) / max(level_at(at), 1e-3);
#else
    return vec3(1.0);
#endif
}

#ifdef MIRRORS
uniform sampler2D sky_map;  // relative to the mean sky

// Half of what a surface of GGX mirrors comes from within 2 alpha of the mirror's direction, as half of its facets are
// tilted by less than alpha (Walter et al. 2007). A Gaussian of which half is within 2 alpha has a standard deviation of
// 1.7 alpha. That is the blur of a map's level whose texels are 2.4 alpha wide, 0.7 of them with the interpolation, and of
// a smooth step of 3.8 alpha to either side.
const float TEXELS = 2.4;
const float STEP = 3.8;

// Radiance from the unit direction `towards`, seen from `from`, as a surface of GGX's `alpha` mirrors it.
vec3 surrounding_radiance(vec3 from, vec3 towards, float alpha) {
    float down = max(-towards.z, 0.02);
    float distance = max(from.z, 0.0) / down;
    vec2 meets = from.xy + towards.xy * distance;
    vec3 ground = ground_seen(meets, TEXELS * alpha * distance * inversesqrt(down));  // the lobe's mean width there
    // A wide lobe would blur the shadow into a gradient, which the surface's shading contains already.
    ground *= mix(left_on_ground(meets, 0.0), vec3(1.0), min(2.0 * alpha, 1.0));
    float up = max(towards.z, 0.0);
    // A texel of the sky's map spans 4 / size radians in its middle, half of that at the horizon.
    vec2 at = 0.5 + 0.5 * normalize(towards.xy + vec2(1e-6, 0.0)) * sqrt((1.0 - up) / (1.0 + up));
    vec3 above = sky * textureLod(sky_map, at, log2(TEXELS * 0.25 * alpha * environment_size)).rgb;
    float width = clamp(STEP * alpha, 0.01, 1.0);
    return mix(ground, above, smoothstep(-width, width, towards.z));
}
#endif
