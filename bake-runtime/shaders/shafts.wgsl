// Light shafts: the ray is split into lit intervals by the lamp's shadow map, and each is integrated as if it were alone.
// uses: airlight_quadrature, shadow_border

fn lamp_airlight_shadowed(ray: ViewRay, lamp: Lamp) -> vec3f {
    let sight = lamp_sight(ray, lamp);
    if lamp.shadow == UNSHADOWED {
        return airlight_between(ray, lamp, sight, 0.0, ray.length);
    }
    let maps = maps_of_lamp(lamp);
    let end = air_end(ray, sight, air_sigma_t(), first_lit(lamp, sight));
    let step = end / f32(SHAFT_STEPS);
    var sum = vec3f(0.0);
    var begin = 0.0;
    var lit = is_lit(maps, ray.origin);
    var s = 0.0;
    for (var i = 1u; i <= SHAFT_STEPS; i++) {
        let next = step * f32(i);
        let next_lit = is_lit(maps, ray.origin + ray.dir * next);
        if next_lit != lit {
            let border = shadow_border(ray, maps, s, next, lit);
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
