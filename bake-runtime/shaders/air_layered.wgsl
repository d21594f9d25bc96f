// Any media. Twin: bake_optics::airlight::MediumAlong; its cuts at the shadows of bounds' corners are left out.
// uses: medium, sight

fn air_sigma_t() -> vec3f {
    return vec3f(0.0);
}

// The part of a ray that lies in any air.
fn air_span(ray: ViewRay) -> vec2f {
    var span = vec2f(1e30, -1e30);
    for (var m = 0u; m < MEDIA; m++) {
        let own = clip_bounds(media[m], ray);
        span = select(span, vec2f(min(span.x, own.x), max(span.y, own.y)), own.x < own.y);
    }
    return vec2f(span.x, min(span.y, span.x + air_end_of_density(ray)));
}

fn air_common(sight: Sight) -> vec3f {
    return vec3f(1.0);
}

// Scattering at a point of the ray. `dir`: of the ray; the deflection decides the phase.
fn scattering_at(place: vec3f, deflection: Deflection) -> vec3f {
    var sum = vec3f(0.0);
    for (var m = 0u; m < MEDIA; m++) {
        let inside = optical_inside(media[m], place);
        sum += media[m].sigma_s * (inside * density_at(media[m], place) * phase(media[m], deflection));
    }
    return sum;
}

fn air_value(ray: ViewRay, lamp: Lamp, sigma_t: vec3f, point: PathPoint) -> vec3f {
    let place = ray.origin + ray.dir * point.place.s;
    let to_lamp = lamp.position - place;
    let away = max(length(to_lamp), 1e-20);
    let depth = optical_depth_by_way(ViewRay(ray.origin, ray.dir, point.place.s), ViewRay(place, to_lamp / away, away));
    return scattering_at(place, point.deflection) * fall3(depth);
}

// Distance at which a medium alone has taken all light, or has thinned out.
fn air_end_of_density(ray: ViewRay) -> f32 {
    var end = FAR;
    for (var m = 0u; m < MEDIA; m++) {
        if media[m].density == 1u && media[m].bounds == 0u && ray.dir.y > 0.0 { // if DENSITY_EXPONENTIAL
            end = min(end, 25.0 / max(media[m].slope * ray.dir.y, 1e-9)); // if DENSITY_EXPONENTIAL
        } // if DENSITY_EXPONENTIAL
        if media[m].density == 3u && media[m].bounds == 0u { end = min(end, planet_end(media[m], ray)); } // if DENSITY_PLANET
    }
    return end;
}

fn air_end(ray: ViewRay, sight: Sight, sigma_t: vec3f, first: f32) -> f32 {
    var end = sight.length;
    for (var m = 0u; m < MEDIA; m++) {
        if media[m].bounds == 4u { continue; } // if BOUNDS_MESH
        let least = min(media[m].sigma_t.x, min(media[m].sigma_t.y, media[m].sigma_t.z));
        let span = clip_bounds(media[m], ray);
        let room = LIGHT_DEPTH / max(least, 1e-12);
        var depth_end = max(span.x, first) + room;
        if media[m].density == 1u { depth_end = max(span.x, first) + exponential_end(media[m], ray, max(span.x, first), room); } // if DENSITY_EXPONENTIAL
        if media[m].density < 2u && depth_end < span.y {
            end = min(end, depth_end);
        }
    }
    return end;
}

// Distance from `from_s` after which an exponential medium's optical length reaches `room`. Twin: exponential::free_path.
fn exponential_end(medium: Medium, ray: ViewRay, from_s: f32, room: f32) -> f32 { // if DENSITY_EXPONENTIAL
    let level = room / density_at(medium, ray.origin + ray.dir * from_s); // if DENSITY_EXPONENTIAL
    let p = -medium.slope * ray.dir.y; // if DENSITY_EXPONENTIAL
    let y = p * min(level, 1e30); // if DENSITY_EXPONENTIAL
    if y <= -1.0 { return FAR; } // if DENSITY_EXPONENTIAL
    return min(level * lam(y), FAR); // if DENSITY_EXPONENTIAL
} // if DENSITY_EXPONENTIAL
