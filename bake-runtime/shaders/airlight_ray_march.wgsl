// Air-light by midpoints at equal distances: the method that everyone uses, here as baseline. Twin: bake_optics::airlight::RayMarch.
// uses: lamp_sight
// uses: air_uniform // unless LAYERED
// uses: air_layered // if LAYERED
// uses: shadow // if SHADOWS

fn lamp_airlight(ray: ViewRay, lamp: Lamp) -> vec3f {
    let sight = lamp_sight(ray, lamp);
    let sigma_t = air_sigma_t();
    let step = air_end(ray, sight, sigma_t, 0.0) / f32(STEPS);
    var sum = vec3f(0.0);
    for (var i = 0u; i < STEPS; i++) {
        let point = point_at(sight, place_at(sight, step * (f32(i) + 0.5)));
        let r = distance_at(sight.z + point.place.s, sight.h);
        var light = emitted_to(lamp, sight, point) / r / r;
        light *= select(0.0, 1.0, is_lit(maps_of_lamp(lamp), ray.origin + ray.dir * point.place.s)); // if SHADOWS
        sum += light * air_value(ray, lamp, sigma_t, point);
    }
    return sum * step * air_common(sight);
}
