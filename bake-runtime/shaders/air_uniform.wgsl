// Air of one density in one region that holds the lamps too. Twin: bake_optics::airlight::UniformAir.
// uses: medium, sight

fn air_sigma_t() -> vec3f {
    var sum = vec3f(0.0);
    for (var m = 0u; m < MEDIA; m++) {
        sum += media[m].sigma_t;
    }
    return sum;
}

// The part of a ray that lies in the air.
fn air_span(ray: ViewRay) -> vec2f {
    return clip_bounds(media[0], ray);
}

// Transmittance common to all points of a sight.
fn air_common(sight: Sight) -> vec3f {
    return fall3(air_sigma_t() * sight.eye_distance);
}

// Scattering at a point, times the transmittance by way of it over the common one.
fn air_value(ray: ViewRay, lamp: Lamp, sigma_t: vec3f, point: PathPoint) -> vec3f {
    var scattering = vec3f(0.0);
    for (var m = 0u; m < MEDIA; m++) {
        scattering += media[m].sigma_s * phase(media[m], point.deflection);
    }
    return scattering * fall3(sigma_t * point.excess);
}

// Where so little light is left that the rest of the ray is dark; `first`: the first lit place. Twin: UniformAir::end.
fn air_end(ray: ViewRay, sight: Sight, sigma_t: vec3f, first: f32) -> f32 {
    let least = max(min(sigma_t.x, min(sigma_t.y, sigma_t.z)), 1e-12);
    let passed = select(excess_at(sight, place_at(sight, first)), 0.0, first == 0.0);
    return min(reach(sight, passed + LIGHT_DEPTH / least), sight.length);
}
