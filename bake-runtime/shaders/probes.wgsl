// Probes: light stored at points in space, for surfaces without lightmap.
// uses: lattice

@group(0) @binding(17) var<uniform> probes: Lattice;
@group(0) @binding(18) var probe_texels: texture_2d_array<f32>;

// Irradiance of a surface that faces `normal`: the clamped cosine's zonal factors pi, 2 pi/3, pi/4.
fn probe_irradiance(place: vec3f, normal: vec3f) -> vec3f {
    return max(vec3f(0.0), lattice_light(probes, probe_texels, place, normal, vec3f(PI, 2.0 * PI / 3.0, 0.25 * PI)));
}
