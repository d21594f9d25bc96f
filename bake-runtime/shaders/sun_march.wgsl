// Light of a sun by midpoints at equal distances: the baseline of sun shafts.
// uses: airlight_sun
// uses: shadow // if SHADOWS

fn sun_airlight_marched(ray: ViewRay, sun: Sun) -> vec3f {
    let deflection = deflection_between(sun.direction, -ray.dir);
    let step = ray.length / f32(STEPS);
    var sum = vec3f(0.0);
    for (var i = 0u; i < STEPS; i++) {
        let s = step * (f32(i) + 0.5);
        var light = step;
        light *= select(0.0, 1.0, is_lit(maps_of_sun(sun), ray.origin + ray.dir * s)); // if SHADOWS
        sum += light * sun_value(ray, sun, deflection, s);
    }
    return sum;
}
