// Baked irradiance, lux, from the lightmap page. Weights are f32, not a sampler's eight bits. Neighbours beyond a chart's
// border are its own dilated texels, so that bilinear look-ups stay inside the padding.

@group(1) @binding(0) var lightmap_texels: texture_2d<f32>;

// The four texels around a place, and the shares of the right and lower ones.
struct Around {
    corners: array<vec2i, 4>,
    share: vec2f,
}

fn texels_around(uv: vec2f) -> Around {
    let size = vec2i(textureDimensions(lightmap_texels));
    let place = uv * vec2f(size) - 0.5;
    let low = floor(place);
    let first = clamp(vec2i(low), vec2i(0), size - 1);
    let last = clamp(vec2i(low) + 1, vec2i(0), size - 1);
    return Around(array(first, vec2i(last.x, first.y), vec2i(first.x, last.y), last), place - low);
}

fn blend(around: Around, a: vec3f, b: vec3f, c: vec3f, d: vec3f) -> vec3f {
    return mix(mix(a, b, around.share.x), mix(c, d, around.share.x), around.share.y);
}

fn page_texel(at: vec2i) -> vec3f {
    return textureLoad(lightmap_texels, at, 0).rgb;
}

fn baked_irradiance(around: Around) -> vec3f {
    let at = around.corners;
    return blend(around, page_texel(at[0]), page_texel(at[1]), page_texel(at[2]), page_texel(at[3]));
}
