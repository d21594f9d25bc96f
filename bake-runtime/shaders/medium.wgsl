// The media of the picture: where they are and how dense. Twins: bake_optics::medium. Places are relative to the eye.
// uses: arithmetic, phase, view_ray
// uses: hull // if BOUNDS_HULL
// uses: mesh // if BOUNDS_MESH
// uses: planet // if DENSITY_PLANET
// uses: density_grid // if DENSITY_GRID

// Largest exponent of a density: beyond it sums of products of lamp, air and lobe overflow.
const THICKEST = 40.0;

// Optical depth beyond which light is left out: below f32's digits; what a march of equal steps can afford.
const LIGHT_DEPTH = 30.0; // unless RAY_MARCH
const LIGHT_DEPTH = 12.0; // if RAY_MARCH

@group(0) @binding(11) var<uniform> media: array<Medium, MEDIA>;

// Distances at which a ray enters and leaves a medium (of a mesh: its box), within [0, length]; enter >= leave where it misses.
// Twin: Bounds::clip.
fn clip_bounds(medium: Medium, ray: ViewRay) -> vec2f {
    var span = vec2f(0.0, ray.length);
    if medium.bounds == 1u { span = clip_box(medium, ray); } // if BOUNDS_BOX
    if medium.bounds == 4u { span = clip_box(medium, ray); } // if BOUNDS_MESH
    if medium.bounds == 2u { span = clip_ball(medium, ray); } // if BOUNDS_BALL
    if medium.bounds == 3u { span = clip_hull(medium, ray); } // if BOUNDS_HULL
    return vec2f(max(span.x, 0.0), min(span.y, ray.length));
}

fn clip_box(medium: Medium, ray: ViewRay) -> vec2f { // if BOUNDS_BOX
    var span = vec2f(-1e30, 1e30); // if BOUNDS_BOX
    for (var i = 0u; i < 3u; i++) { // if BOUNDS_BOX
        let low = medium.low[i] - ray.origin[i]; // if BOUNDS_BOX
        let high = medium.high[i] - ray.origin[i]; // if BOUNDS_BOX
        if abs(ray.dir[i]) < 1e-20 { // if BOUNDS_BOX
            if low > 0.0 || high < 0.0 { return vec2f(1e30, -1e30); } // if BOUNDS_BOX
            continue; // if BOUNDS_BOX
        } // if BOUNDS_BOX
        let a = clamp(low / ray.dir[i], -1e30, 1e30); // if BOUNDS_BOX
        let b = clamp(high / ray.dir[i], -1e30, 1e30); // if BOUNDS_BOX
        span = vec2f(max(span.x, min(a, b)), min(span.y, max(a, b))); // if BOUNDS_BOX
    } // if BOUNDS_BOX
    return span; // if BOUNDS_BOX
} // if BOUNDS_BOX

fn clip_ball(medium: Medium, ray: ViewRay) -> vec2f { // if BOUNDS_BALL
    let from_centre = ray.origin - medium.low; // if BOUNDS_BALL
    let nearest = -dot(from_centre, ray.dir); // if BOUNDS_BALL
    let h = length(cross(from_centre, ray.dir)); // if BOUNDS_BALL
    let half_chord = sqrt(max(0.0, (medium.high.x - h) * (medium.high.x + h))); // if BOUNDS_BALL
    return select(vec2f(1e30, -1e30), nearest + vec2f(-half_chord, half_chord), h < medium.high.x); // if BOUNDS_BALL
} // if BOUNDS_BALL

// Exponential density: integral of exp(-n (height + s climb)) over [0, length]. Twin: exponential::optical_length.
fn exponential_length(n: f32, height: f32, climb: f32, length_of_ray: f32) -> f32 { // if DENSITY_EXPONENTIAL
    let x = n * abs(climb) * length_of_ray; // if DENSITY_EXPONENTIAL
    let effective = length_of_ray * phi1(-min(x, 1e30)); // if DENSITY_EXPONENTIAL
    let low = select(height, height + climb * length_of_ray, climb < 0.0); // if DENSITY_EXPONENTIAL
    return exp(clamp(-n * low, -DARK, THICKEST)) * effective; // if DENSITY_EXPONENTIAL
} // if DENSITY_EXPONENTIAL

// Linear density: integral of max(0, start + s slope) over [0, length]. Twin: linear::optical_length.
fn linear_length(start: f32, slope: f32, length_of_ray: f32) -> f32 { // if DENSITY_LINEAR
    let last = start + slope * length_of_ray; // if DENSITY_LINEAR
    if start >= 0.0 && last >= 0.0 { return length_of_ray * 0.5 * (start + last); } // if DENSITY_LINEAR
    if start <= 0.0 && last <= 0.0 { return 0.0; } // if DENSITY_LINEAR
    let top = max(start, last); // if DENSITY_LINEAR
    return 0.5 * top * (top / abs(slope)); // if DENSITY_LINEAR
} // if DENSITY_LINEAR

// Density at a place inside the bounds. Twin: Density::at.
fn density_at(medium: Medium, place: vec3f) -> f32 {
    if medium.density == 1u { return exp(clamp(-medium.slope * (place.y - medium.base), -DARK, THICKEST)); } // if DENSITY_EXPONENTIAL
    if medium.density == 2u { return max(0.0, medium.slope * (place.y - medium.base)); } // if DENSITY_LINEAR
    if medium.density == 3u { return planet_at(medium, place); } // if DENSITY_PLANET
    if medium.density == 4u { return grid_at(medium, place); } // if DENSITY_GRID
    return 1.0;
}

// 1 inside the bounds, 0 outside.
fn optical_inside(medium: Medium, place: vec3f) -> f32 {
    if medium.bounds == 3u { return select(0.0, 1.0, inside_hull(medium, place)); } // if BOUNDS_HULL
    if medium.bounds == 4u { return select(0.0, 1.0, inside_mesh(medium, place)); } // if BOUNDS_MESH
    let box = all(place >= medium.low) && all(place <= medium.high);
    let ball = length(place - medium.low) <= medium.high.x;
    return select(0.0, 1.0, medium.bounds == 0u || (medium.bounds == 1u && box) || (medium.bounds == 2u && ball));
}

// Integral of the density along a ray, metres. Twin: Medium::optical_length.
fn optical_length(medium: Medium, ray: ViewRay) -> f32 {
    let span = clip_bounds(medium, ray);
    if span.x >= span.y {
        return 0.0;
    }
    return length_between(medium, ray, span); // unless BOUNDS_MESH
    var parts: MeshParts; // if BOUNDS_MESH
    parts.count = 1u; // if BOUNDS_MESH
    parts.at[0] = span; // if BOUNDS_MESH
    if medium.bounds == 4u { parts = mesh_parts(medium, ray); } // if BOUNDS_MESH
    var sum = 0.0; // if BOUNDS_MESH
    for (var i = 0u; i < parts.count; i++) { sum += length_between(medium, ray, parts.at[i]); } // if BOUNDS_MESH
    return sum; // if BOUNDS_MESH
}

// The same between two distances that the bounds do not divide.
fn length_between(medium: Medium, ray: ViewRay, span: vec2f) -> f32 {
    let inside = span.y - span.x;
    let height = ray.origin.y + ray.dir.y * span.x - medium.base; // if DENSITY_EXPONENTIAL|DENSITY_LINEAR
    if medium.density == 1u { return exponential_length(medium.slope, height, ray.dir.y, inside); } // if DENSITY_EXPONENTIAL
    if medium.density == 2u { return linear_length(medium.slope * height, medium.slope * ray.dir.y, inside); } // if DENSITY_LINEAR
    let within = ViewRay(ray.origin + ray.dir * span.x, ray.dir, inside); // if DENSITY_PLANET|DENSITY_GRID
    if medium.density == 3u { return planet_length(medium, within); } // if DENSITY_PLANET
    if medium.density == 4u { return grid_length(medium, within); } // if DENSITY_GRID
    return inside;
}

// Optical depth per channel. Twin: MediumSet::optical_depth.
fn optical_depth(ray: ViewRay) -> vec3f {
    var depth = vec3f(0.0);
    for (var m = 0u; m < MEDIA; m++) {
        depth += media[m].sigma_t * optical_length(media[m], ray);
    }
    return depth;
}

// The same by way of two straight parts; called at one place, because shaders are inlined.
fn optical_depth_by_way(first: ViewRay, second: ViewRay) -> vec3f {
    var ray = first;
    var depth = vec3f(0.0);
    for (var i = 0u; i < 2u; i++) {
        depth += optical_depth(ray);
        ray = second;
    }
    return depth;
}
