// Percentage-closer filtering of the light's depth map.
// Reeves, Salesin, Cook, "Rendering antialiased shadows with depth maps", SIGGRAPH 1987.

uniform sampler2DShadow shadow_map;  // compares and interpolates between four texels
uniform mat4 shadow_from_marker;  // to the depth map's coordinates and depth, all in [0, 1]
uniform float shadow_map_size;  // texels a side

// Along one axis the interpolated taps -r..r together weigh 2 r + 2 texels by 1-f, 1, ..., 1, f. Pairs of those are one
// tap each, set between its two texels by their weights: (r + 1)^2 taps give exactly what (2 r + 1)^2 would.
// Returns the weight and the place after the first texel of pair k; PCF_RADIUS is 1 or more.
vec2 tap_pair(int k, float f) {
    return k == 0 ? vec2(2.0 - f, 1.0 / (2.0 - f)) : k == PCF_RADIUS ? vec2(1.0 + f, f / (1.0 + f)) : vec2(2.0, 0.5);
}

// Share of the light that reaches a point of the marker frame, in [0, 1].
float lit_fraction(vec3 position) {
    vec3 at = (shadow_from_marker * vec4(position, 1.0)).xyz;
    // The map ends behind the model, and the ground goes on: what lies behind it all is compared at its end.
    float depth = clamp(at.z, 0.0, 1.0);
    vec2 texels = at.xy * shadow_map_size - 0.5;
    vec2 first = floor(texels);
    vec2 f = texels - first;
    float lit = 0.0;
    for (int row = 0; row <= PCF_RADIUS; ++row) {
        vec2 y = tap_pair(row, f.y);
        for (int column = 0; column <= PCF_RADIUS; ++column) {
            vec2 x = tap_pair(column, f.x);
            vec2 tap = first + vec2(2 * column, 2 * row) - float(PCF_RADIUS) + vec2(x.y, y.y) + 0.5;
            lit += x.x * y.x * texture(shadow_map, vec3(tap / shadow_map_size, depth));
        }
    }
    return lit / float((2 * PCF_RADIUS + 1) * (2 * PCF_RADIUS + 1));
}
