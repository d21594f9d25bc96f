// A vertex of a placement: where it lies, and what it carries to the fragments.
// uses: frame
// uses: pruning // if PRUNED

@group(0) @binding(1) var<storage, read> instances: array<Instance>;
@group(0) @binding(2) var<storage, read> page_uvs: array<vec2f>; // if LIGHTMAP
@group(0) @binding(3) var<storage, read> page_charts: array<u32>; // if SHOW_CHARTS
@group(2) @binding(0) var<uniform> surface: Surface;

struct VertexIn {
    @builtin(vertex_index) vertex: u32,
    @builtin(instance_index) instance: u32,
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
    @location(2) uv_0: vec2f,
    @location(3) uv_more: vec4f,
    @location(4) color: vec4f,
}

struct VertexOut {
    @builtin(position) clip: vec4f,
    // Relative to the eye, world axes, metres.
    @location(0) place: vec3f,
    @location(1) normal: vec3f,
    @location(2) uv_0: vec2f,
    @location(3) uv_more: vec4f,
    @location(4) color: vec4f,
    @location(5) page_uv: vec2f, // if LIGHTMAP
    @location(6) @interpolate(flat) node: u32,
    @location(7) @interpolate(flat) chart: u32, // if SHOW_CHARTS
}

@vertex
fn vertex(in: VertexIn) -> VertexOut {
    let instance = instances[in.instance];
    var object = vec4f(in.position, 1.0);
    object = vec4f(in.position * pruned_scale(instance), 1.0); // if PRUNED
    let world = vec3f(dot(instance.row_x, object), dot(instance.row_y, object), dot(instance.row_z, object));
    // Rows of the cofactor matrix carry normals; its sign follows mirroring.
    let x = instance.row_x.xyz;
    let y = instance.row_y.xyz;
    let z = instance.row_z.xyz;
    let normal = vec3f(dot(cross(y, z), in.normal), dot(cross(z, x), in.normal), dot(cross(x, y), in.normal));
    var out: VertexOut;
    out.place = world - frame.eye;
    out.clip = frame.clip_from_relative * vec4f(out.place, 1.0);
    out.normal = normal * instance.handedness;
    out.uv_0 = in.uv_0;
    out.uv_more = in.uv_more;
    out.color = in.color;
    out.page_uv = page_uvs[instance.page_uv_first + in.vertex]; // if LIGHTMAP
    out.node = instance.node;
    out.chart = page_charts[instance.page_uv_first + in.vertex]; // if SHOW_CHARTS
    return out;
}
