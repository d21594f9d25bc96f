// Texture of base colour and opacity.
// uses: texture_map

@group(2) @binding(1) var base_texture: texture_2d<f32>;
@group(2) @binding(2) var base_sampler: sampler;

fn base_texel(uv_0: vec2f, uv_more: vec4f) -> vec4f {
    return textureSample(base_texture, base_sampler, mapped_uv(surface.base_u, surface.base_v, uv_0, uv_more));
}
