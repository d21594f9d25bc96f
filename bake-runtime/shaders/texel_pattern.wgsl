// The lightmap's texels, light and dark in turn.

fn texel_pattern(uv: vec2f) -> f32 {
    let at = vec2i(floor(uv * vec2f(textureDimensions(lightmap_texels))));
    return select(0.4, 1.0, ((at.x + at.y) & 1) == 0);
}
