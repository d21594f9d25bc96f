// Depth of surfaces as a lamp or sun sees them.
// uses: frame

@group(0) @binding(1) var<storage, read> instances: array<Instance>;

@vertex
fn vertex(@builtin(instance_index) index: u32, @location(0) position: vec3f) -> @builtin(position) vec4f {
    let instance = instances[index];
    let object = vec4f(position, 1.0);
    let world = vec3f(dot(instance.row_x, object), dot(instance.row_y, object), dot(instance.row_z, object));
    return frame.clip_from_relative * vec4f(world - frame.eye, 1.0);
}
