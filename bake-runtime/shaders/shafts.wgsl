// Light shafts: the ray is split into lit intervals by the lamp's shadow map, and each is integrated as if it were alone.
// uses: airlight_quadrature, shadow

// Bisections of a border between light and shadow.
const REFINEMENTS = 6u;

// Where light changes between `from_s` and `to_s`, whose states differ.
fn shadow_border(ray: ViewRay, lamp: Lamp, from_s: f32, to_s: f32, from_lit: bool) -> f32 {
    var low = from_s;
    var high = to_s;
    for (var i = 0u; i < REFINEMENTS; i++) {
        let middle = 0.5 * (low + high);
        if lamp_is_lit(lamp, ray.origin + ray.dir * middle) == from_lit { low = middle; } else { high = middle; }
    }
    return 0.5 * (low + high);
}

fn lamp_airlight_shadowed(ray: ViewRay, lamp: Lamp) -> vec3f {
    let sight = sight_of(ray.dir, ray.origin - lamp.position, ray.length, lamp.axis, lamp.radius);
    if lamp.shadow == UNSHADOWED {
        return airlight_between(ray, lamp, sight, 0.0, ray.length);
    }
    let end = air_end(ray, sight, air_sigma_t(), first_lit(lamp, sight));
    let step = end / f32(SHAFT_STEPS);
    var sum = vec3f(0.0);
    var begin = 0.0;
    var lit = lamp_is_lit(lamp, ray.origin);
    var s = 0.0;
    for (var i = 1u; i <= SHAFT_STEPS; i++) {
        let next = step * f32(i);
        let next_lit = lamp_is_lit(lamp, ray.origin + ray.dir * next);
        if next_lit != lit {
            let border = shadow_border(ray, lamp, s, next, lit);
            if lit { sum += airlight_between(ray, lamp, sight, begin, border); }
            begin = border;
            lit = next_lit;
        }
        s = next;
    }
    if lit {
        sum += airlight_between(ray, lamp, sight, begin, end);
    }
    return sum;
}
