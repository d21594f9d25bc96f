// Air-light by Gauss-Legendre nodes on each side of the lamp's foot. Twin: bake_optics::airlight::Quadrature.
// uses: pieces

// Integral between two places that the foot does not divide.
fn piece(ray: ViewRay, lamp: Lamp, sight: Sight, sigma_t: vec3f, begin: Place, end: Place) -> vec3f {
    let panel = panel_of(sight, begin, end);
    var sum = vec3f(0.0);
    for (var i = 0u; i < RULE_COUNT; i++) {
        let node = panel_node(sight, panel, i);
        var weight = node.weight;
        weight *= emitted_to(lamp, sight, node.point); // if LAMP_CONE|LAMP_LEGENDRE
        sum += weight * air_value(ray, lamp, sigma_t, node.point);
    }
    return sum;
}

// Radiance scattered once from a lamp of unit intensity, from `first` to `last` on the ray; 1/m^2.
fn airlight_between(ray: ViewRay, lamp: Lamp, sight: Sight, first: f32, last: f32) -> vec3f {
    let sigma_t = air_sigma_t();
    let end = place_at(sight, min(last, air_end(ray, sight, sigma_t, max(first, first_lit(lamp, sight)))));
    var begin = place_at(sight, first);
    var cuts = cuts_of(ray, lamp, sight, begin, end);
    var sum = vec3f(0.0);
    for (var i = 0u; i <= cuts.count; i++) {
        var next = end;
        if i < cuts.count { next = cuts.at[i]; }
        if !lies_before(begin, next) {
            continue;
        }
        var lit = true;
        let middle = Place(0.5 * (begin.s + next.s), 0.5 * (begin.z + next.z)); // if LAMP_CONE
        lit = emitted_to(lamp, sight, point_at(sight, middle)) > 0.0; // if LAMP_CONE
        if lit {
            sum += piece(ray, lamp, sight, sigma_t, begin, next);
        }
        begin = next;
    }
    return sum * air_common(sight);
}

fn lamp_airlight(ray: ViewRay, lamp: Lamp) -> vec3f {
    let sight = lamp_sight(ray, lamp);
    return airlight_between(ray, lamp, sight, 0.0, ray.length);
}
