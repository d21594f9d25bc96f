// sRGB transfer function (IEC 61966-2-1).
fn srgb(linear: vec3f) -> vec3f {
    let low = 12.92 * linear;
    let high = 1.055 * pow(max(linear, vec3f(1e-6)), vec3f(1.0 / 2.4)) - 0.055;
    return select(high, low, linear <= vec3f(0.0031308));
}
