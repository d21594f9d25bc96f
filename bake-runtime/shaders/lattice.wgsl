// Light stored at the points of a lattice, as harmonics of incident radiance: probes, and cells of fog.
// Point (ix, iy, iz) is texel x = ix + nx iz, y = iy; layer k holds harmonic k. Places are relative to the eye.

// Real harmonics l <= 2 without Condon-Shortley sign, index l(l+1)+m. Twin: bake_optics::harmonics::real_sh.
fn real_harmonic(k: u32, d: vec3f) -> f32 {
    switch k {
        case 0u: { return 0.282094792; }
        case 1u: { return 0.488602512 * d.y; }
        case 2u: { return 0.488602512 * d.z; }
        case 3u: { return 0.488602512 * d.x; }
        case 4u: { return 1.092548431 * d.x * d.y; }
        case 5u: { return 1.092548431 * d.y * d.z; }
        case 6u: { return 0.315391565 * (3.0 * d.z * d.z - 1.0); }
        case 7u: { return 1.092548431 * d.x * d.z; }
        default: { return 0.546274215 * (d.x * d.x - d.y * d.y); }
    }
}

// Degree l of harmonic k.
fn degree_of(k: u32) -> u32 {
    return select(select(2u, 1u, k < 4u), 0u, k == 0u);
}

// The texel of a point, clamped to the lattice.
fn lattice_texel(lattice: Lattice, point: vec3i) -> vec2i {
    let count = vec3i(i32(lattice.count_x), i32(lattice.count_y), i32(lattice.count_z));
    let at = clamp(point, vec3i(0), count - 1);
    return vec2i(at.x + count.x * at.z, at.y);
}

// Sum over harmonics of weight_l c_k Y_k(dir), trilinear at a place. Points without light of their own (alpha 0) are left out.
fn lattice_light(lattice: Lattice, texels: texture_2d_array<f32>, place: vec3f, dir: vec3f, weights: vec3f) -> vec3f {
    let at = (place - lattice.origin) * lattice.inverse_spacing;
    let low = floor(at);
    let share = at - low;
    var sum = vec3f(0.0);
    var total = 1e-6;
    for (var corner = 0u; corner < 8u; corner++) {
        let step = vec3u(corner & 1u, (corner >> 1u) & 1u, corner >> 2u);
        let near = select(1.0 - share, share, step == vec3u(1u));
        let texel = lattice_texel(lattice, vec3i(low) + vec3i(step));
        let weight = near.x * near.y * near.z * textureLoad(texels, texel, 0, 0).a;
        total += weight;
        if weight <= 0.0 {
            continue;
        }
        for (var k = 0u; k < lattice.harmonics; k++) {
            sum += textureLoad(texels, texel, k, 0).rgb * (weight * weights[degree_of(k)] * real_harmonic(k, dir));
        }
    }
    return sum / total;
}
