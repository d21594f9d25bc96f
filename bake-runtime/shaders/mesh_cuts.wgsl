// Where light along a ray has corners because of a mesh: its borders, and where the way to the light passes one of its sharp edges.
// Twin: bake_optics::airlight's borders.
// uses: cuts, mesh

// `light`: a place and 1, or a direction towards the light and 0.
fn add_mesh_cuts(cuts: ptr<function, Cuts>, medium: Medium, ray: ViewRay, light: vec4f, begin: Place, end: Place) {
    let parts = mesh_parts(medium, ray);
    for (var i = 0u; i < parts.count; i++) {
        add_cut(cuts, shifted(begin, parts.at[i].x), begin, end);
        add_cut(cuts, shifted(begin, parts.at[i].y), begin, end);
    }
    // The plane of ray and light: x along the ray, y towards the light.
    let to_light = light.xyz - light.w * ray.origin;
    let along = dot(to_light, ray.dir);
    let across = to_light - along * ray.dir;
    let height = length(across);
    if height <= 1e-6 * length(to_light) {
        return;
    }
    let up = across / height;
    let normal = cross(ray.dir, up);
    for (var i = 0u; i < medium.edge_count; i++) {
        let a = mesh_vector(medium.edges + 6u * i) - ray.origin;
        let b = mesh_vector(medium.edges + 6u * i + 3u) - ray.origin;
        let over_a = dot(normal, a);
        let over_b = dot(normal, b);
        if (over_a > 0.0) == (over_b > 0.0) {
            continue;
        }
        let point = a + (b - a) * (over_a / (over_a - over_b));
        let y = dot(point, up);
        if y >= 0.0 && light.w * y < height {
            let s = (dot(point, ray.dir) * height - y * along) / (height - light.w * y);
            add_cut(cuts, shifted(begin, s), begin, end);
        }
    }
}

// The place at distance `s` of the ray that a place lies on.
fn shifted(place: Place, s: f32) -> Place {
    return Place(s, place.z - place.s + s);
}
