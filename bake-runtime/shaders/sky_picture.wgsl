// Latitude-longitude pictures: column 0 begins at -Z and turns towards +X, row 0 is +Y. Twin: sky::direction.
// uses: arithmetic

@group(0) @binding(23) var sky_texels: texture_2d<f32>;
@group(0) @binding(24) var glow_texels: texture_2d<f32>; // if SKY_FOGGED

// Bilinear; columns go round, rows end at the poles.
fn latitude_longitude(texels: texture_2d<f32>, dir: vec3f, rotation: f32) -> vec3f {
    let size = vec2i(textureDimensions(texels));
    let turn = angle_of(abs(dir.x), -dir.z) * select(1.0, -1.0, dir.x < 0.0) - rotation;
    let across = turn / (2.0 * PI);
    let down = angle_of(length(dir.xz), dir.y) / PI;
    let place = vec2f(across - floor(across), down) * vec2f(size) - 0.5;
    let low = floor(place);
    let share = place - low;
    let left = (i32(low.x) + size.x) % size.x;
    let right = (left + 1) % size.x;
    let rows = clamp(vec2i(i32(low.y), i32(low.y) + 1), vec2i(0), vec2i(size.y - 1));
    let top = mix(textureLoad(texels, vec2i(left, rows.x), 0).rgb, textureLoad(texels, vec2i(right, rows.x), 0).rgb, share.x);
    let bottom = mix(textureLoad(texels, vec2i(left, rows.y), 0).rgb, textureLoad(texels, vec2i(right, rows.y), 0).rgb, share.x);
    return mix(top, bottom, share.y);
}
