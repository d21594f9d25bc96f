// Series of Legendre polynomials by Clenshaw's recurrence. Twin: bake_optics::legendre::series.
// uses: coefficients

// Sum over j < count of coefficients[first + j] P_j(x).
fn legendre(first: u32, count: u32, x: f32) -> f32 {
    var above = 0.0;
    var current = 0.0;
    for (var i = count; i > 0u; i--) {
        let j = f32(i - 1u);
        let next = coefficients[first + i - 1u] + (2.0 * j + 1.0) / (j + 1.0) * x * current - (j + 1.0) / (j + 2.0) * above;
        above = current;
        current = next;
    }
    return current;
}
