// The unit normal of the triangle that is being drawn at `position`, on the side that the camera sees. `otherwise`: for one
// that is seen edge-on, or is so small that the positions of neighbouring pixels do not span a plane.
vec3 triangle_normal(vec3 position, vec3 otherwise) {
    vec3 across = cross(dFdx(position), dFdy(position));
    float size2 = dot(across, across);
    return size2 > 0.0 && size2 < 1e30 ? across * inversesqrt(size2) : otherwise;
}
