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

// The specular reflectance for uniform light from all around is f0 * x + y: Karis, "Physically based shading on
// mobile", 2014.
vec2 mirrored_share(float roughness, float n_v) {
    vec4 r = roughness * vec4(-1.0, -0.0275, -0.572, 0.022) + vec4(1.0, 0.0425, 1.04, -0.04);
    float a004 = min(r.x * r.x, exp2(-9.28 * n_v)) * r.x + r.y;
    return vec2(-1.04, 1.04) * a004 + r.zw;
}
