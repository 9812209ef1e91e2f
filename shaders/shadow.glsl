// Percentage-closer filtering of the light's depth map.

uniform sampler2DShadow shadow_map;
uniform mat4 shadow_from_marker;  // to the depth map's coordinates and depth, all in [0, 1]
uniform float shadow_texel;  // one texel, in those coordinates

// Share of the light that reaches a point of the marker frame, in [0, 1].
float lit_fraction(vec3 position) {
    vec3 at = (shadow_from_marker * vec4(position, 1.0)).xyz;
    // The map ends behind the model, and the ground goes on: what lies behind it all is compared at its end.
    at.z = clamp(at.z, 0.0, 1.0);
    float lit = 0.0;
    for (int row = -PCF_RADIUS; row <= PCF_RADIUS; ++row)
        for (int column = -PCF_RADIUS; column <= PCF_RADIUS; ++column)
            lit += texture(shadow_map, vec3(at.xy + vec2(column, row) * shadow_texel, at.z));
    return lit / float((2 * PCF_RADIUS + 1) * (2 * PCF_RADIUS + 1));
}
