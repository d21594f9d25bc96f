// Light shafts: the ray is split into lit intervals by the lamp's shadow map, and each is integrated as if it were alone.
// uses: airlight_quadrature, shadow_border

// The integral is called at one place: shaders are inlined, and their makers take their time over each copy.
fn lamp_airlight_shadowed(ray: ViewRay, lamp: Lamp) -> vec3f {
    let sight = lamp_sight(ray, lamp);
    let maps = maps_of_lamp(lamp);
    let end = air_end(ray, sight, air_sigma_t(), first_lit(lamp, sight));
    let step = end / f32(SHAFT_STEPS);
    var sum = vec3f(0.0);
    var begin = 0.0;
    var lit = is_lit(maps, ray.origin);
    var s = 0.0;
    // The turn behind the last step closes what is lit; a lamp without maps needs no other.
    for (var i = select(1u, SHAFT_STEPS + 1u, lamp.shadow == UNSHADOWED); i <= SHAFT_STEPS + 1u; i++) {
        let next = min(step * f32(i), end);
        let within = i <= SHAFT_STEPS;
        let next_lit = within && is_lit(maps, ray.origin + ray.dir * next);
        if next_lit != lit {
            var border = end;
            if within { border = shadow_border(ray, maps, s, next, lit); }
            if lit { sum += airlight_between(ray, lamp, sight, begin, border); }
            begin = border;
            lit = next_lit;
        }
        s = next;
    }
    return sum;
}
