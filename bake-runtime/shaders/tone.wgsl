// The very end: exposure, filmic curve, and the display's transfer function where the target does not apply it.
// uses: frame, screen, display

@group(0) @binding(1) var radiance_texels: texture_2d<f32>;

// Filmic curve: Narkowicz 2016, a fit of the ACES reference transform, per channel; maps [0, inf) into [0, 1).
fn filmic(x: vec3f) -> vec3f {
    return clamp(x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14), vec3f(0.0), vec3f(1.0));
}

@fragment
fn fragment(in: Screen) -> @location(0) vec4f {
    let radiance = textureLoad(radiance_texels, vec2i(in.position.xy - frame.viewport.zw), 0).rgb;
    // Beyond this all channels are white; squares stay finite.
    var color = clamp(radiance * frame.exposure, vec3f(0.0), vec3f(1e6));
    color = filmic(color); // if FILMIC
    color = clamp(color, vec3f(0.0), vec3f(1.0)); // unless FILMIC
    color = srgb(color); // if ENCODE
    return vec4f(color, 1.0);
}
