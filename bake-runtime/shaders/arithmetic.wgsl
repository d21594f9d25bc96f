// What shading languages lack: forms that keep their digits near 0 and near ends. Twins: bake_optics::special::{phi1_f32, lam_f32}.

// Largest exponent whose e^-x is not 0 in f32; larger ones are cut here so that no infinity meets a 0.
const DARK = 87.0;

// e^-x for x >= 0, 0 beyond DARK.
fn fall(x: f32) -> f32 {
    return select(exp(-min(x, DARK)), 0.0, x >= DARK);
}

fn fall3(x: vec3f) -> vec3f {
    return select(exp(-min(x, vec3f(DARK))), vec3f(0.0), x >= vec3f(DARK));
}

// (e^x - 1)/x, Taylor for |x| < 0.5.
fn phi1(x: f32) -> f32 {
    if abs(x) >= 0.5 {
        return (exp(min(x, DARK)) - 1.0) / x;
    }
    return 1.0 + x / 2.0 * (1.0 + x / 3.0 * (1.0 + x / 4.0 * (1.0 + x / 5.0 * (1.0 + x / 6.0 * (1.0 + x / 7.0 * (1.0 + x / 8.0))))));
}

// ln(1 + x)/x for x > -1: artanh series for -0.4 < x < 0.7.
fn lam(x: f32) -> f32 {
    if x <= -0.4 || x >= 0.7 {
        return log(1.0 + x) / x;
    }
    let s = x / (2.0 + x);
    let square = s * s;
    return 2.0 / (2.0 + x) * (1.0 + square * (1.0 / 3.0 + square * (1.0 / 5.0 + square * (1.0 / 7.0 + square / 9.0))));
}

// e^x - 1.
fn expm1(x: f32) -> f32 {
    return x * phi1(x);
}

// ln(1 + x).
fn log1p(x: f32) -> f32 {
    return x * lam(x);
}

// High twelve bits of the significand: products of two such parts are exact.
fn high_part(x: f32) -> f32 {
    return bitcast<f32>(bitcast<u32>(x) & 0xfffff000u);
}

// The value itself; compilers that may regroup sums do not look through it.
fn kept(x: f32) -> f32 {
    return max(x, -3e38);
}

// a b - c d with both products split (Dekker 1971), so that nearly equal ones leave their true difference.
fn difference_of_products(a: f32, b: f32, c: f32, d: f32) -> f32 {
    let ah = high_part(a);
    let bh = high_part(b);
    let ch = high_part(c);
    let dh = high_part(d);
    let al = a - ah;
    let bl = b - bh;
    let cl = c - ch;
    let dl = d - dh;
    let high = kept(ah * bh) - kept(ch * dh);
    let middle = (kept(ah * bl) - kept(ch * dl)) + (kept(al * bh) - kept(cl * dh));
    return high + (middle + (al * bl - cl * dl));
}

// Arc tangent of y/x for y >= 0, in [0, pi], by its series below tan(pi/8); the built-in one errs by 2e-5.
fn angle_of(y: f32, x: f32) -> f32 {
    let far = max(y, abs(x));
    if far == 0.0 {
        return 0.0;
    }
    let t = min(y, abs(x)) / far;
    let folded = t > 0.41421356;
    let u = select(t, (t - 1.0) / (t + 1.0), folded);
    let square = u * u;
    let series = u * (1.0 - square * (1.0 / 3.0 - square * (1.0 / 5.0 - square * (1.0 / 7.0 - square * (1.0 / 9.0 - square * (1.0 / 11.0 - square / 13.0))))));
    let small = select(series, series + 0.25 * PI, folded);
    let upright = select(small, 0.5 * PI - small, y > abs(x));
    return select(upright, PI - upright, x < 0.0);
}
