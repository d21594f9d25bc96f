// Regions between planes: n.x <= d for each. Twin: bake_optics::medium::Bounds::Hull.
// uses: coefficients, view_ray

fn hull_plane(medium: Medium, index: u32) -> vec4f {
    let at = medium.planes + 4u * index;
    return vec4f(coefficients[at], coefficients[at + 1u], coefficients[at + 2u], coefficients[at + 3u]);
}

// Entering and leaving distance; a ray along a plane is in or out as a whole.
fn clip_hull(medium: Medium, ray: ViewRay) -> vec2f {
    var span = vec2f(-1e30, 1e30);
    for (var i = 0u; i < medium.plane_count; i++) {
        let plane = hull_plane(medium, i);
        let speed = dot(plane.xyz, ray.dir);
        let room = plane.w - dot(plane.xyz, ray.origin);
        if abs(speed) < 1e-20 {
            if room < 0.0 { return vec2f(1e30, -1e30); }
            continue;
        }
        let s = clamp(room / speed, -1e30, 1e30);
        if speed > 0.0 { span.y = min(span.y, s); } else { span.x = max(span.x, s); }
    }
    return span;
}

fn inside_hull(medium: Medium, place: vec3f) -> bool {
    var inside = true;
    for (var i = 0u; i < medium.plane_count; i++) {
        let plane = hull_plane(medium, i);
        inside = inside && dot(plane.xyz, place) <= plane.w;
    }
    return inside;
}
