// Texture coordinates of a material's maps (MapLayout in ashe_live/models/material.py). Uses the including file's macros.

const int BASE = 0;
const int METALLIC_ROUGHNESS = 1;
const int NORMAL = 2;
const int OCCLUSION = 3;
const int EMISSIVE = 4;

#ifdef LAID_OUT
in vec4 uvs;  // two sets of texture coordinates
uniform vec4 map_rows[10];  // two for each map: how its u and its v follow from both sets
uniform vec2 map_offsets[5];

vec2 laid_out(int map) {
    return vec2(dot(map_rows[2 * map], uvs), dot(map_rows[2 * map + 1], uvs)) + map_offsets[map];
}
#elif defined(HAS_MAPS)
in vec2 uv;

vec2 laid_out(int map) {
    return uv;
}
#endif
