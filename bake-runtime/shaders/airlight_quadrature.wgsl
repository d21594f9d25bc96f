// Air-light by Gauss-Legendre nodes on each side of the lamp's foot. Twin: bake_optics::airlight::Quadrature.
// uses: pieces

// Integral over [from_s, to_s], which the foot does not divide.
fn piece(ray: ViewRay, lamp: Lamp, sight: Sight, sigma_t: vec3f, from_s: f32, to_s: f32) -> vec3f {
    let panel = panel_of(sight, from_s, to_s);
    var sum = vec3f(0.0);
    for (var i = 0u; i < RULE_COUNT; i++) {
        let node = panel_node(sight, panel, i);
        var weight = node.weight;
        weight *= emitted(lamp, cos_axis(sight, node.point)); // if LAMP_CONE|LAMP_LEGENDRE
        sum += weight * air_value(ray, lamp, sigma_t, node.point);
    }
    return sum;
}

// Radiance scattered once from a lamp of unit intensity, from `first` to `last` on the ray; 1/m^2.
fn airlight_between(ray: ViewRay, lamp: Lamp, sight: Sight, first: f32, last: f32) -> vec3f {
    let sigma_t = air_sigma_t();
    let end = min(last, air_end(ray, sight, sigma_t, max(first, first_lit(lamp, sight))));
    var cuts = cuts_of(ray, lamp, sight, end);
    var from_s = first;
    var sum = vec3f(0.0);
    for (var i = 0u; i <= cuts.count; i++) {
        var to_s = end;
        if i < cuts.count { to_s = cuts.at[i]; }
        if to_s <= from_s {
            continue;
        }
        var lit = true;
        lit = emitted(lamp, cos_axis(sight, point_at(sight, 0.5 * (from_s + to_s)))) > 0.0; // if LAMP_CONE
        if lit {
            sum += piece(ray, lamp, sight, sigma_t, from_s, to_s);
        }
        from_s = to_s;
    }
    return sum * air_common(sight);
}

fn lamp_airlight(ray: ViewRay, lamp: Lamp) -> vec3f {
    let sight = sight_of(ray.dir, ray.origin - lamp.position, ray.length, lamp.axis, lamp.radius);
    return airlight_between(ray, lamp, sight, 0.0, ray.length);
}
