// Coordinates of a material's textures: coordinate set and transform (KHR_texture_transform).

// w of the u row is the coordinate set: 0, 1 or 2.
fn mapped_uv(row_u: vec4f, row_v: vec4f, uv_0: vec2f, uv_more: vec4f) -> vec2f {
    let chosen = select(select(uv_more.zw, uv_more.xy, row_u.w < 1.5), uv_0, row_u.w < 0.5);
    return vec2f(dot(row_u.xy, chosen) + row_u.z, dot(row_v.xy, chosen) + row_v.z);
}
