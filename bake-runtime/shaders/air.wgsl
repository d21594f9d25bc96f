// The air between the eye and the first surface: what it scatters towards the eye, and what it leaves of the light behind.
// uses: frame, screen, inscatter

@group(0) @binding(1) var radiance_texels: texture_2d<f32>;
@group(0) @binding(2) var depth_map: texture_depth_2d;

@fragment
fn fragment(in: Screen) -> @location(0) vec4f {
    let at = vec2i(in.position.xy);
    let radiance = textureLoad(radiance_texels, at, 0).rgb;
    let depth = textureLoad(depth_map, at, 0);
    let along = view_direction(in.position.xy);
    let stretch = length(along);
    let away = select(FAR, frame.near / max(depth, 1e-30) * stretch, depth > 0.0);
    var air = air_along(along / stretch, min(away, FAR));
    air.transmittance = select(vec3f(1.0), air.transmittance, depth > 0.0); // if SKY_FOGGED
    return vec4f(radiance * air.transmittance + air.inscatter, 1.0);
}
