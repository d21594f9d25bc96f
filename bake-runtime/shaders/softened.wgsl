// Light of a lamp that reaches a surface by way of endless uniform isotropic air. Twin: bake_optics::surface.
// uses: arithmetic, medium

// Layer 0: G_1, the Lambertian one; others: Phong lobes. Over (T/(1 + T), theta/pi), times (1 + T) e^T.
@group(0) @binding(16) var surface_texels: texture_2d_array<f32>;

// Twin: SurfaceTable::look_up.
fn softened_table(layer: u32, t: f32, theta: f32) -> f32 {
    let last = f32(textureDimensions(surface_texels).x - 1u);
    let place = clamp(vec2f(t / (1.0 + t), theta / PI) * last, vec2f(0.0), vec2f(last));
    let low = min(floor(place), vec2f(last - 1.0));
    let share = place - low;
    let at = vec2i(low);
    let top = mix(textureLoad(surface_texels, at, layer, 0).r, textureLoad(surface_texels, at + vec2i(1, 0), layer, 0).r, share.x);
    let bottom = mix(textureLoad(surface_texels, at + vec2i(0, 1), layer, 0).r, textureLoad(surface_texels, at + vec2i(1, 1), layer, 0).r, share.x);
    return mix(top, bottom, share.y) * fall(t) / (1.0 + t);
}

// sigma_s G/(2 pi D), the irradiance scattered onto the surface (Sun et al. 2005, eq. 17), reflected by each lobe about its axis.
fn softened_radiance(base: vec3f, exponent: f32, away: f32, normal: vec3f, to_light: vec3f, to_eye: vec3f) -> vec3f {
    let theta = angle_of(length(cross(normal, to_light)), dot(normal, to_light));
    let axis = reflect(-to_eye, normal); // if SPECULAR
    let turned = angle_of(length(cross(axis, to_light)), dot(axis, to_light)); // if SPECULAR
    var sum = vec3f(0.0);
    for (var m = 0u; m < MEDIA; m++) {
        let medium = media[m];
        for (var c = 0u; c < 3u; c++) {
            let t = medium.sigma_t[c] * away;
            let scale = medium.sigma_s[c] / (2.0 * PI * away);
            sum[c] += scale * softened_table(0u, t, theta) * base[c] / PI;
            sum[c] += scale * softened_table(surface.lobe, t, turned) * 0.04 * (exponent + 2.0) / (2.0 * PI); // if SPECULAR
        }
    }
    return sum;
}
