// The BRDF of the metallic-roughness model: glTF 2.0, appendix B, with the approximations that Filament and Unreal use.

// The facets of a surface within a pixel, as GGX has them along and across the way in which the normal turns most: of a thin
// rim, which turns by much within a pixel, the mirrored light would otherwise be dots that sparkle as the camera moves. The
// variance of the normal is added to that of the facets (Tokuyoshi, Kaplanyan, "Improved geometric specular antialiasing",
// I3D 2019).
struct Facets {
    vec3 along, across;  // unit vectors perpendicular to the normal
    vec2 alpha;  // along and across
};

Facets facets_in_pixel(float roughness, vec3 n, float n_v) {
    const float PIXEL_VARIANCE = 0.15915494, MOST = 0.18;  // of a filter as wide as a pixel: 1 / (2 pi)
    const float GRAZED = 0.2, SEEN = 0.6;  // cosines to the eye between which the widening begins and is complete
    vec3 column = dFdx(n), row = dFdy(n);
    float of_columns = dot(column, column), of_rows = dot(row, row), of_both = dot(column, row);
    // The larger eigenvalue of their products, and the way across the picture in which the normal turns by that.
    float middle = 0.5 * (of_columns + of_rows);
    float most = middle + sqrt(max(middle * middle - of_columns * of_rows + of_both * of_both, 0.0));
    vec3 turn = of_columns > of_rows ? (most - of_rows) * column + of_both * row : of_both * column + (most - of_columns) * row;
    turn -= dot(turn, n) * n;
    vec3 some_way = abs(n.z) < 0.7 ? vec3(-n.y, n.x, 0.0) : vec3(0.0, -n.z, n.y);
    Facets facets;
    facets.along = normalize(dot(turn, turn) > 1e-24 ? turn : some_way);
    facets.across = cross(n, facets.along);
    float alpha2 = roughness * roughness * roughness * roughness;
    vec2 turned = min(2.0 * PIXEL_VARIANCE * vec2(most, 2.0 * middle - most), MOST);
    // At an outline the normal turns ever faster, and derivatives say little of how much of the pixel it turns in: widened,
    // it would mirror lights that are far aside.
    facets.alpha = sqrt(min(alpha2 + turned * smoothstep(GRAZED, SEEN, n_v), 1.0));
    return facets;
}

// Microfacet distribution times visibility of GGX (Walter et al. 2007; Heitz 2014, height-correlated), without 1 / pi.
// `tan_half`: the light's radius over its distance. What mirrors its disc are normals within a disc of half its size, which
// is wider where light grazes. The distribution is flat within `reach` of `between`, such that in the middle it is what the
// disc mirrors of a lobe wider or narrower than itself, and that all of it sums up to 1 whatever the light's size. (Karis,
// "Real shading in Unreal Engine 4", 2013, has such a shift with another sum.)
float ggx(Facets facets, vec3 n, vec3 between, float n_v, float n_l, float v_h, float tan_half) {
    const float QUARTER_TURN = 0.78539816;
    float a2 = facets.alpha.x * facets.alpha.y;
    float radius2 = 0.25 * tan_half * tan_half / max(v_h, 0.01), of_lobe = QUARTER_TURN * sqrt(a2);
    float reach = sqrt(of_lobe * of_lobe + radius2) - of_lobe;
    vec2 aside = vec2(dot(between, facets.along), dot(between, facets.across));
    float n_h = max(dot(n, between), 0.0), aside2 = dot(aside, aside);
    float left = max(1.0 - reach * inversesqrt(max(aside2, 1e-12)), 0.0);
    vec2 beyond = left * aside / facets.alpha;
    float d = dot(beyond, beyond) + n_h * n_h + (1.0 - left * left) * aside2;
    // Of the same facets as the distribution: with fewer that hide one another, outlines would sparkle.
    float v = n_l * sqrt(n_v * n_v * (1.0 - a2) + a2) + n_v * sqrt(n_l * n_l * (1.0 - a2) + a2);
    return 0.5 / ((a2 + radius2) * d * d * v);
}

// Schlick 1994.
vec3 fresnel(vec3 f0, float v_h) {
    float side = 1.0 - v_h;
    float side2 = side * side;
    return f0 + (1.0 - f0) * (side2 * side2 * side);
}

uniform sampler2D mirrored_shares;  // computed by render/reflections/reflectance.py

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
