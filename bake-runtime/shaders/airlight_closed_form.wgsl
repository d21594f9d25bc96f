// Air-light of a lamp that shines alike in all directions by exponential integrals; phase functions up to degree 2 (beyond, f32 has no
// digits left). Twin: bake_optics::airlight::ClosedForm, whose poles are constants here. Where two tails cancel, quadrature takes over.
// uses: airlight_quadrature, exponential_integral
// uses: moments // if PHASE_LINEAR|PHASE_RAYLEIGH|PHASE_LEGENDRE

// Share of the endless ray's light below which the difference of two tails has lost its digits. Twin: LEAST_SHARE_SINGLE.
const LEAST_SHARE_LEFT = 0.02;

// Integrals from v to infinity of e^{-H (v' - v)} P_l(cos 2 xi)/(1 + v'^2) for l = 0, 1, 2. Twin: tail.
fn endless_tails(h: f32, v: f32) -> vec3f {
    return vec3f(-scaled_e1(vec2f(h * v, h)).y, 0.0, 0.0); // unless PHASE_LINEAR|PHASE_RAYLEIGH|PHASE_LEGENDRE
    let s = scaled_e123(vec2f(h * v, h)); // if PHASE_LINEAR|PHASE_RAYLEIGH|PHASE_LEGENDRE
    let inverse = complex_reciprocal(vec2f(v, 1.0)); // if PHASE_LINEAR|PHASE_RAYLEIGH|PHASE_LEGENDRE
    let second = complex_product(inverse, s[1]); // if PHASE_LINEAR|PHASE_RAYLEIGH|PHASE_LEGENDRE
    let third = complex_product(complex_product(inverse, inverse), s[2]); // if PHASE_LINEAR|PHASE_RAYLEIGH|PHASE_LEGENDRE
    return vec3f(-s[0].y, -second.x, -0.25 * s[0].y + 0.75 * second.x + 1.5 * third.y); // if PHASE_LINEAR|PHASE_RAYLEIGH|PHASE_LEGENDRE
}

// sigma_s times the first Legendre terms of the phase functions themselves, 1/(m sr).
fn scattering_terms(c: u32) -> vec3f {
    var sum = vec3f(0.0);
    for (var m = 0u; m < MEDIA; m++) {
        sum.x += media[m].sigma_s[c];
        sum.y += 3.0 * media[m].sigma_s[c] * moments[m * ORDERS + 1u]; // if PHASE_LINEAR|PHASE_RAYLEIGH|PHASE_LEGENDRE
        sum.z += 5.0 * media[m].sigma_s[c] * moments[m * ORDERS + 2u]; // if PHASE_LINEAR|PHASE_RAYLEIGH|PHASE_LEGENDRE
    }
    return INVERSE_FOUR_PI * sum;
}

// Whether the ray spans so little of asinh(z/h) that its ends' values cancel. Twin: is_narrow.
fn spans_little(sight: Sight, end: f32) -> bool {
    let ra = sight.eye_distance;
    let rb = distance_at(sight.z + end, sight.h);
    let kappa = (2.0 * sight.z + end) / (ra + rb);
    let grown = select(end * (1.0 - kappa) / (rb - sight.z - end), end * (1.0 + kappa) / (ra + sight.z), kappa >= 0.0);
    return grown < 0.05;
}

fn lamp_airlight_closed(ray: ViewRay, lamp: Lamp) -> vec3f {
    let sight = lamp_sight(ray, lamp);
    let sigma_t = air_sigma_t();
    let depth = sigma_t * sight.h;
    let excess = excess_at(sight, place_at(sight, sight.length));
    let va = sight.behind / sight.h;
    let vb = va + excess / sight.h;
    var difference = vec3f(0.0);
    var cancels = min(depth.x, min(depth.y, depth.z)) < 1e-6 || spans_little(sight, sight.length);
    for (var c = 0u; c < 3u; c++) {
        let terms = scattering_terms(c);
        let whole = endless_tails(max(depth[c], 1e-6), va);
        let rest = fall(sigma_t[c] * excess) * endless_tails(max(depth[c], 1e-6), vb);
        difference[c] = dot(terms, whole - rest);
        cancels = cancels || difference[c] < LEAST_SHARE_LEFT * terms.x * whole.x;
    }
    if cancels {
        return airlight_between(ray, lamp, sight, 0.0, ray.length);
    }
    return 2.0 / sight.h * difference * air_common(sight);
}
