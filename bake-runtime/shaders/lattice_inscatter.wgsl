// Baked light scattered towards the eye: the air's share of what lies in the lattice, by midpoints along the ray.
// uses: lattice, medium, moments

@group(0) @binding(21) var<uniform> air_lattice: Lattice;
@group(0) @binding(22) var air_texels: texture_2d_array<f32>;

// Moments of each medium's phase function for l = 0, 1, 2 carry its light over.
fn lattice_inscatter(ray: ViewRay) -> vec3f {
    let step = ray.length / f32(LATTICE_STEPS);
    var sum = vec3f(0.0);
    for (var i = 0u; i < LATTICE_STEPS; i++) {
        let s = (f32(i) + 0.5) * step;
        let place = ray.origin + ray.dir * s;
        var light = vec3f(0.0);
        for (var m = 0u; m < MEDIA; m++) {
            let weights = vec3f(moments[m * ORDERS], moments[m * ORDERS + 1u], moments[m * ORDERS + 2u]);
            let density = optical_inside(media[m], place) * density_at(media[m], place);
            if density > 0.0 {
                light += media[m].sigma_s * density * max(vec3f(0.0), lattice_light(air_lattice, air_texels, place, ray.dir, weights));
            }
        }
        sum += light * fall3(optical_depth(ViewRay(ray.origin, ray.dir, s)));
    }
    return sum * step;
}
