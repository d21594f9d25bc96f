// What lies behind all surfaces: a uniform sky.
// uses: frame, screen

@fragment
fn fragment(in: Screen) -> @location(0) vec4f {
    return vec4f(frame.sky, 1.0);
}
