// Where on a ray light and shadow meet.
// uses: shadow, view_ray

// Bisections of a border between light and shadow.
const REFINEMENTS = 6u;

// Where light changes between `from_s` and `to_s`, whose states differ.
fn shadow_border(ray: ViewRay, maps: ShadowMaps, from_s: f32, to_s: f32, from_lit: bool) -> f32 {
    var low = from_s;
    var high = to_s;
    for (var i = 0u; i < REFINEMENTS; i++) {
        let middle = 0.5 * (low + high);
        if is_lit(maps, ray.origin + ray.dir * middle) == from_lit { low = middle; } else { high = middle; }
    }
    return 0.5 * (low + high);
}
