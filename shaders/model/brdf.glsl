// The BRDF of the metallic-roughness model: glTF 2.0, appendix B, with the approximations that Filament and Unreal use.

// Microfacet distribution times visibility of GGX (Walter et al. 2007; Heitz 2014, height-correlated), without 1 / pi.
float ggx(float n_h, float n_v, float n_l, float alpha) {
    float a2 = alpha * alpha;
    float d = (n_h * a2 - n_h) * n_h + 1.0;
    float v = n_l * sqrt(n_v * n_v * (1.0 - a2) + a2) + n_v * sqrt(n_l * n_l * (1.0 - a2) + a2);
    return 0.5 * a2 / (d * d * v);
}

// Schlick 1994.
vec3 fresnel(vec3 f0, float v_h) {
    float side = 1.0 - v_h;
    float side2 = side * side;
    return f0 + (1.0 - f0) * (side2 * side2 * side);
}

uniform sampler2D mirrored_shares;  // computed by render/gl/reflectance.py

// Of even light from all around, f0 * x + y is mirrored in a single reflection. z is the mean of x + y over all directions.
vec3 mirrored_share(float roughness, float n_v) {
    vec2 knots = vec2(textureSize(mirrored_shares, 0));
    return textureLod(mirrored_shares, (vec2(n_v, roughness) * (knots - 1.0) + 0.5) / knots, 0.0).rgb;
}

// The factor by which single reflections become all reflections, those between facets too: Kulla and Conty, "Revisiting
// physically based shading at Imageworks", 2017. Each reflection leaves the mean of Schlick's term of the light.
vec3 energy_compensation(vec3 f0, vec3 share) {
    vec3 mean = f0 + (1.0 - f0) / 21.0;
    vec3 leaves = mean * share.z / (1.0 - mean * (1.0 - share.z));
    return 1.0 + leaves * (1.0 / (share.x + share.y) - 1.0);
}
