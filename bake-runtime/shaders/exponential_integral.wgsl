// S_p(z) = e^z E_p(z) for Re z >= 0. Twins: bake_optics::special::{scaled_exponential_integral, scaled_exponential_integrals};
// sources there.
// uses: arithmetic

fn complex_product(a: vec2f, b: vec2f) -> vec2f {
    return vec2f(a.x * b.x - a.y * b.y, a.x * b.y + a.y * b.x);
}

// 1/z after Smith 1962: |z|^2 does not overflow.
fn complex_reciprocal(z: vec2f) -> vec2f {
    if abs(z.x) >= abs(z.y) {
        let ratio = z.y / z.x;
        let scale = 1.0 / (z.x + z.y * ratio);
        return vec2f(scale, -ratio * scale);
    }
    let ratio = z.x / z.y;
    let scale = 1.0 / (z.x * ratio + z.y);
    return vec2f(ratio * scale, -scale);
}

// E_1 = -gamma - ln z - sum (-z)^k/(k k!), times e^z.
fn scaled_e1_series(z: vec2f) -> vec2f {
    var sum = vec2f(-0.5 * log(dot(z, z)) - 0.5772156649, -angle_of(abs(z.y), z.x) * sign(z.y));
    var term = vec2f(1.0, 0.0);
    for (var k = 1u; k < 20u; k++) {
        term = complex_product(term, -z) / f32(k);
        sum -= term / f32(k);
    }
    return exp(z.x) * complex_product(vec2f(cos(z.y), sin(z.y)), sum);
}

// Backward continued fraction; its depth falls with |z| + Re z.
fn scaled_fraction(p: u32, z: vec2f) -> vec2f {
    let depth = u32(3.0 + 0.5 * f32(p) + 45.0 / (length(z) + z.x));
    var below = z + vec2f(f32(p + 2u * depth), 0.0);
    for (var k = depth; k > 0u; k--) {
        below = z + vec2f(f32(p + 2u * k - 2u), 0.0) - complex_reciprocal(below) * f32(k * (p + k - 1u));
    }
    return complex_reciprocal(below);
}

fn scaled_e1(z: vec2f) -> vec2f {
    if length(z) + z.x >= 3.0 {
        return scaled_fraction(1u, z);
    }
    return scaled_e1_series(z);
}

// S_1 to S_3: p S_{p+1} = 1 - z S_p, walked down from the fraction, up from the series, where errors do not grow.
fn scaled_e123(z: vec2f) -> array<vec2f, 3> {
    let one = vec2f(1.0, 0.0);
    if length(z) + z.x >= 3.0 {
        let third = scaled_fraction(3u, z);
        let second = complex_product(complex_reciprocal(z), one - 2.0 * third);
        return array(complex_product(complex_reciprocal(z), one - second), second, third);
    }
    let first = scaled_e1_series(z);
    let second = one - complex_product(z, first);
    return array(first, second, 0.5 * (one - complex_product(z, second)));
}
