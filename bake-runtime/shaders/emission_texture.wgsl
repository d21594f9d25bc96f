// Texture of emission.
// uses: texture_map

@group(2) @binding(3) var emission_texture: texture_2d<f32>;
@group(2) @binding(4) var emission_sampler: sampler;

fn emission_texel(uv_0: vec2f, uv_more: vec4f) -> vec3f {
    let uv = mapped_uv(surface.emission_u, surface.emission_v, uv_0, uv_more);
    return textureSample(emission_texture, emission_sampler, uv).rgb;
}
