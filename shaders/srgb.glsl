// sRGB and linear light, IEC 61966-2-1; the same curves as ashe_live/core/colour.py.

vec3 linear_from_srgb(vec3 encoded) {
    return mix(encoded / 12.92, pow((encoded + 0.055) / 1.055, vec3(2.4)), step(0.04045, encoded));
}

vec3 srgb_from_linear(vec3 linear) {
    vec3 value = clamp(linear, 0.0, 1.0);
    return mix(value * 12.92, 1.055 * pow(value, vec3(1.0 / 2.4)) - 0.055, step(0.0031308, value));
}
