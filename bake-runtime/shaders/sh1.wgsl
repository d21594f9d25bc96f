// Baked light for a bent normal, from harmonics l <= 1 of incident radiance.
// uses: lightmap

@group(1) @binding(1) var sh1_texels: texture_2d_array<f32>;

fn harmonic(around: Around, index: u32) -> vec3f {
    let at = around.corners;
    return blend(
        around,
        textureLoad(sh1_texels, at[0], index, 0).rgb,
        textureLoad(sh1_texels, at[1], index, 0).rgb,
        textureLoad(sh1_texels, at[2], index, 0).rgb,
        textureLoad(sh1_texels, at[3], index, 0).rgb,
    );
}

// e(n) = max(0, 0.886227 c0 + 1.023328 (c1 n_y + c2 n_z + c3 n_x)): the clamped-cosine irradiance of l <= 1.
fn irradiance_l1(c0: vec3f, c1: vec3f, c2: vec3f, c3: vec3f, normal: vec3f) -> vec3f {
    return max(vec3f(0.0), 0.886227 * c0 + 1.023328 * (c1 * normal.y + c2 * normal.z + c3 * normal.x));
}

// E(n') = E e(n')/e(n): equal to E where the normal is not bent.
fn bent_irradiance(around: Around, normal: vec3f, bent: vec3f) -> vec3f {
    let c0 = harmonic(around, 0u);
    let c1 = harmonic(around, 1u);
    let c2 = harmonic(around, 2u);
    let c3 = harmonic(around, 3u);
    let flat = irradiance_l1(c0, c1, c2, c3, normal);
    let ratio = irradiance_l1(c0, c1, c2, c3, bent) / max(flat, vec3f(1e-20));
    return baked_irradiance(around) * select(vec3f(1.0), min(ratio, vec3f(8.0)), flat > vec3f(1e-6) * c0);
}
