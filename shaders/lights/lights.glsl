// LIGHTS lights as homogeneous points. LAMPS is 1 if any of them is near by.
#if LIGHTS > 0
uniform vec3 light_ground_share[LIGHTS];  // fraction of the light on level ground at the marker's centre, linear RGB
uniform vec4 light_point[LIGHTS];  // unit vector from the marker's centre, and one over the distance in 1/m: 0 for a sun

#if LAMPS
// A real lamp has a size. So nothing is lit more than at a hundredth of the lamp's distance from the marker's centre, as in
// lighting.py.
const float LEAST_DISTANCE2 = 1e-4;
#endif

// The unit vector from a point towards a light. `falloff`: the irradiance on a surface facing the light at that point over
// that at the marker's centre, by the inverse square of the distance.
vec3 towards_light(int light, vec3 position, out float falloff) {
#if LAMPS
    vec3 towards = light_point[light].xyz - light_point[light].w * position;
    float distance2 = max(dot(towards, towards), LEAST_DISTANCE2);
    falloff = 1.0 / distance2;
    return towards * inversesqrt(distance2);
#else
    falloff = 1.0;
    return light_point[light].xyz;
#endif
}

// The irradiance of level ground by the light over that at the marker's centre: h / d^3 by Lambert's law.
float ground_falloff(int light, vec2 ground) {
    float falloff;
    towards_light(light, vec3(ground, 0.0), falloff);
#if LAMPS
    falloff *= sqrt(falloff);
#endif
    return falloff;
}

// All light on unshaded level ground over that at the marker's centre.
vec3 level_at(vec2 ground) {
    vec3 level = vec3(1.0);
#if LAMPS
    for (int light = 0; light < LIGHTS; ++light) {
        level += light_ground_share[light] * (ground_falloff(light, ground) - 1.0);
    }
#endif
    return level;
}
#endif

// The light that the ground reflects onto a surface with this normal, relative to ground lit by suns alone.
vec3 bounce_at(vec3 position, vec3 normal) {
#if LIGHTS > 0 && LAMPS
    // Half of the ground's light on a wall comes from farther away than 1.7 times its height.
    return level_at(position.xy + 1.7 * max(position.z, 0.0) * normal.xy);
#else
    return vec3(1.0);
#endif
}
