// How much brighter or darker one picture is than another, in false colours.
// uses: frame, screen, palette, display

@group(0) @binding(1) var radiance_texels: texture_2d<f32>;
@group(0) @binding(2) var other_texels: texture_2d<f32>;

// The frame's exposure is 1/(luminance of the strongest colour).
@fragment
fn fragment(in: Screen) -> @location(0) vec4f {
    let at = vec2i(in.position.xy);
    let more = textureLoad(other_texels, at, 0).rgb - textureLoad(radiance_texels, at, 0).rgb;
    let share = dot(more, vec3f(0.2126, 0.7152, 0.0722)) * frame.exposure;
    var color = palette_color(0.5 + 0.5 * clamp(share, -1.0, 1.0));
    color = srgb(color); // if ENCODE
    return vec4f(color, 1.0);
}
