// Texels per metre, a colour an octave from 1 up. Their area against the surface's, both as the picture's texels see it.
// uses: palette, texel_pattern

fn density_color(uv: vec2f, place: vec3f) -> vec3f {
    let texels = uv * vec2f(textureDimensions(lightmap_texels));
    let across = dpdx(texels);
    let down = dpdy(texels);
    let area = length(cross(dpdx(place), dpdy(place)));
    let density = sqrt(abs(across.x * down.y - across.y * down.x) / max(area, 1e-30));
    // Where texels are smaller than the picture's the pattern gives way to its mean.
    let pattern = mix(texel_pattern(uv), 0.7, smoothstep(0.3, 0.6, max(length(across), length(down))));
    return palette_color(log2(max(density, 1e-6)) / f32(PALETTE_COUNT - 1u)) * pattern;
}
