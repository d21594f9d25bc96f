// One triangle over the whole target, and the view ray of each texel.

struct Screen {
    @builtin(position) position: vec4f,
}

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> Screen {
    let corner = vec2f(f32((index << 1u) & 2u), f32(index & 2u));
    return Screen(vec4f(corner * 2.0 - 1.0, 0.0, 1.0));
}

// Direction through a texel's middle, of length 1 along the camera's axis.
fn view_direction(position: vec2f) -> vec3f {
    let share = (position * 2.0 - frame.viewport.xy) / frame.viewport.xy;
    return frame.forward + share.x * frame.right - share.y * frame.up;
}
