// What lies under one texel of the picture: distance from the eye, page coordinate, and placement counted from 1; as bits.
// uses: placed
// uses: base_texture // if BASE_TEXTURE

@fragment
fn fragment(in: VertexOut) -> @location(0) vec4u {
    var opacity = surface.base_color.a * in.color.a; // if MASK
    opacity *= base_texel(in.uv_0, in.uv_more).a; // if MASK&BASE_TEXTURE
    if opacity < surface.alpha_cutoff { discard; } // if MASK
    var page_uv = vec2f(0.0);
    page_uv = in.page_uv; // if LIGHTMAP
    return vec4u(bitcast<u32>(length(in.place)), bitcast<vec2u>(page_uv), in.node + 1u);
}
