// Numbers as sums of two f32, high and low part: some 45 bits of significand, for the few differences that need them.
// Source: Dekker 1971, "A floating-point technique for extending the available precision".
// uses: arithmetic

fn two_sum(a: f32, b: f32) -> vec2f {
    let sum = kept(a + b);
    let other = kept(sum - a);
    return vec2f(sum, kept(a - kept(sum - other)) + kept(b - other));
}

fn two_product(a: f32, b: f32) -> vec2f {
    let product = kept(a * b);
    let ah = high_part(a);
    let bh = high_part(b);
    let al = a - ah;
    let bl = b - bh;
    return vec2f(product, ((kept(ah * bh) - product) + kept(ah * bl) + kept(al * bh)) + al * bl);
}

fn two_add(a: vec2f, b: vec2f) -> vec2f {
    let sum = two_sum(a.x, b.x);
    return two_sum(sum.x, sum.y + (a.y + b.y));
}

fn two_times(a: vec2f, b: vec2f) -> vec2f {
    let product = two_product(a.x, b.x);
    return two_sum(product.x, product.y + (a.x * b.y + a.y * b.x));
}

// a/b for b >= 0; 0 where b is too small to be divided by.
fn two_over(a: vec2f, b: vec2f) -> vec2f {
    if b.x < 1e-30 {
        return vec2f(0.0);
    }
    let high = a.x / b.x;
    let rest = two_add(a, -two_times(b, vec2f(high, 0.0)));
    return two_sum(high, rest.x / b.x);
}

// The dot product, rounded once or twice.
fn exact_dot(a: vec3f, b: vec3f) -> f32 {
    return two_add(two_add(two_product(a.x, b.x), two_product(a.y, b.y)), two_product(a.z, b.z)).x;
}
