// S_1(z) = e^z E_1(z) for Re z >= 0. Twin: bake_optics::special::scaled_exponential_integral (p = 1); sources there.
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
fn scaled_e1_fraction(z: vec2f) -> vec2f {
    let depth = u32(3.5 + 45.0 / (length(z) + z.x));
    var below = z + vec2f(f32(1u + 2u * depth), 0.0);
    for (var k = depth; k > 0u; k--) {
        below = z + vec2f(f32(2u * k - 1u), 0.0) - complex_reciprocal(below) * f32(k * k);
    }
    return complex_reciprocal(below);
}

fn scaled_e1(z: vec2f) -> vec2f {
    if length(z) + z.x >= 3.0 {
        return scaled_e1_fraction(z);
    }
    return scaled_e1_series(z);
}
