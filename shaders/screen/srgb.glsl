// sRGB and linear light (IEC 61966-2-1), within 0.00004, a hundredth of a level, of the curves of ashe_live/core/colour.py.
// Chebyshev fits to their powers from 0.04045 and 0.0031308 to 1, as pow takes a software rasteriser twice as long.

const vec3 LUMINANCE = vec3(0.2126, 0.7152, 0.0722);  // of linear RGB (ITU-R BT.709)

vec3 linear_from_srgb(vec3 encoded) {
    vec3 power = 0.05624370 * encoded - 0.23194377;
    power = ((power * encoded + 0.60277282) * encoded + 0.54229380) * encoded;
    power = (power + 0.02961582) * encoded + 0.00103313;
    return mix(encoded / 12.92, power, step(0.04045, encoded));
}

vec3 srgb_from_linear(vec3 linear) {
    vec3 value = clamp(linear, 0.0, 1.0);
    vec3 root = sqrt(sqrt(value));
    vec3 power = ((0.07885704 * root - 0.32937618) * root + 1.11735202) * root;
    power = (power + 0.19803844) * root - 0.06484341;
    return mix(value * 12.92, power, step(0.0031308, value));
}
