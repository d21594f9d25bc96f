// Light of a sun scattered once towards the eye. Twin: bake_optics::airlight's directional form; sun light enters bounds at
// their border. Gauss-Legendre on pieces between borders and where the sun enters by another face of a box.
// uses: medium
// uses: air_uniform // unless LAYERED
// uses: air_layered // if LAYERED
// uses: pieces

// Twin: Deflection::between.
fn deflection_between(a: vec3f, b: vec3f) -> Deflection {
    let minus = 0.5 * dot(a - b, a - b);
    let plus = 0.5 * dot(a + b, a + b);
    return Deflection(0.5 * (plus - minus), minus, plus);
}

// A place on a ray that passes no lamp.
fn alone(s: f32) -> Place {
    return Place(s, s);
}

// Places on the ray where the way to the sun leaves a box through an edge.
fn add_edges(cuts: ptr<function, Cuts>, medium: Medium, ray: ViewRay, sun: Sun, end: f32) { // if BOUNDS_BOX
    let up = -sun.direction; // if BOUNDS_BOX
    for (var i = 0u; i < 3u; i++) { // if BOUNDS_BOX
        let j = (i + 1u) % 3u; // if BOUNDS_BOX
        if abs(up[i]) < 1e-6 || abs(up[j]) < 1e-6 { continue; } // if BOUNDS_BOX
        let face_i = select(medium.low[i], medium.high[i], up[i] > 0.0) - ray.origin[i]; // if BOUNDS_BOX
        let face_j = select(medium.low[j], medium.high[j], up[j] > 0.0) - ray.origin[j]; // if BOUNDS_BOX
        let slope = ray.dir[i] / up[i] - ray.dir[j] / up[j]; // if BOUNDS_BOX
        if abs(slope) > 1e-9 { add_cut(cuts, alone((face_i / up[i] - face_j / up[j]) / slope), alone(0.0), alone(end)); } // if BOUNDS_BOX
    } // if BOUNDS_BOX
} // if BOUNDS_BOX

// What a place on the ray sends to the eye, 1/(m sr); the way to the sun goes on until it has left all air.
fn sun_value(ray: ViewRay, sun: Sun, deflection: Deflection, s: f32) -> vec3f {
    let place = ray.origin + ray.dir * s;
    let depth = optical_depth_by_way(ViewRay(ray.origin, ray.dir, s), ViewRay(place, -sun.direction, FAR));
    return sun_scattering(place, deflection) * fall3(depth);
}

// Radiance per unit irradiance of the sun from the part of the ray between two distances, all of it lit, 1/sr.
fn sun_between(ray: ViewRay, sun: Sun, first: f32, end: f32) -> vec3f {
    let deflection = deflection_between(sun.direction, -ray.dir);
    var cuts: Cuts;
    cuts.count = 0u;
    for (var m = 0u; m < MEDIA; m++) {
        let span = clip_bounds(media[m], ray);
        add_cut(&cuts, alone(span.x), alone(0.0), alone(end));
        add_cut(&cuts, alone(span.y), alone(0.0), alone(end));
        if media[m].bounds == 4u { add_mesh_cuts(&cuts, media[m], ray, vec4f(-sun.direction, 0.0), alone(0.0), alone(end)); } // if BOUNDS_MESH
        if media[m].bounds == 1u { add_edges(&cuts, media[m], ray, sun, end); } // if BOUNDS_BOX
    }
    var sum = vec3f(0.0);
    var from_s = first;
    for (var k = 0u; k <= cuts.count; k++) {
        var to_s = end;
        if k < cuts.count { to_s = cuts.at[k].s; }
        if to_s <= from_s {
            continue;
        }
        for (var i = 0u; i < RULE_COUNT; i++) {
            let s = from_s + (to_s - from_s) * RULE_NODES[i];
            sum += (to_s - from_s) * RULE_WEIGHTS[i] * sun_value(ray, sun, deflection, s);
        }
        from_s = to_s;
    }
    return sum;
}

fn sun_scattering(place: vec3f, deflection: Deflection) -> vec3f {
    return scattering_at(place, deflection); // if LAYERED
    var sum = vec3f(0.0); // unless LAYERED
    for (var m = 0u; m < MEDIA; m++) { sum += media[m].sigma_s * phase(media[m], deflection); } // unless LAYERED
    return sum; // unless LAYERED
}
