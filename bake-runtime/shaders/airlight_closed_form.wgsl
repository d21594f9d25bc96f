// Air-light of isotropic air and lamp by exponential integrals (Sun et al. 2005 in the scaled form). Twin: ClosedForm.
// Where two tails cancel, quadrature takes over.
// uses: airlight_quadrature, exponential_integral

// Integral from v to infinity of e^{-H (v' - v)}/(1 + v'^2). Twin: tail.
fn endless_tail(h: f32, v: f32) -> f32 {
    return -scaled_e1(vec2f(h * v, h)).y;
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
    let sight = sight_of(ray.dir, ray.origin - lamp.position, ray.length, lamp.axis, lamp.radius);
    let sigma_t = air_sigma_t();
    let depth = sigma_t * sight.h;
    let excess = excess_at(sight, sight.length);
    let va = sight.behind / sight.h;
    let vb = va + excess / sight.h;
    var difference = vec3f(0.0);
    var cancels = min(depth.x, min(depth.y, depth.z)) < 1e-6 || spans_little(sight, sight.length);
    for (var c = 0u; c < 3u; c++) {
        let whole = endless_tail(max(depth[c], 1e-6), va);
        difference[c] = whole - fall(sigma_t[c] * excess) * endless_tail(max(depth[c], 1e-6), vb);
        cancels = cancels || difference[c] < 0.02 * whole;
    }
    if cancels {
        return airlight_between(ray, lamp, sight, 0.0, ray.length);
    }
    var sigma_s = vec3f(0.0);
    for (var m = 0u; m < MEDIA; m++) {
        sigma_s += media[m].sigma_s;
    }
    return 2.0 * INVERSE_FOUR_PI * sigma_s / sight.h * difference * air_common(sight);
}
