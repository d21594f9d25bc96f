// Normals bent by a texture; tangents from screen derivatives (Schueler 2006), so that meshes need none.
// uses: texture_map

@group(2) @binding(5) var normal_texture: texture_2d<f32>;
@group(2) @binding(6) var normal_sampler: sampler;

// +X of the texture is right, +Y is up, as in glTF: v grows downwards.
fn bent_normal(normal: vec3f, place: vec3f, uv: vec2f) -> vec3f {
    let across = cross(dpdy(place), normal);
    let along = cross(normal, dpdx(place));
    let tangent = across * dpdx(uv.x) + along * dpdy(uv.x);
    let bitangent = across * dpdx(uv.y) + along * dpdy(uv.y);
    // Rows of the picture grow downwards: dpdx x dpdy points away from the eye.
    let handed = sign(dot(cross(dpdx(place), dpdy(place)), normal));
    let scale = handed * inverseSqrt(max(max(dot(tangent, tangent), dot(bitangent, bitangent)), 1e-30));
    let texel = textureSample(normal_texture, normal_sampler, uv).xyz * 2.0 - 1.0;
    return normalize((tangent * texel.x - bitangent * texel.y) * scale + normal * max(texel.z, 1e-3));
}
