// Surfaces: what they emit and reflect of baked light.
// uses: frame
// uses: base_texture // if BASE_TEXTURE
// uses: emission_texture // if EMISSION_TEXTURE
// uses: lightmap // if LIGHTMAP
// uses: sh1 // if SH1
// uses: normal_map // if NORMAL_MAP
// uses: views // if SHOW_TEXELS|SHOW_NODES
// uses: lattice // if PROBES
// uses: lights // if LIGHTS
// uses: inscatter // if AIR

@group(0) @binding(1) var<storage, read> instances: array<Instance>;
@group(0) @binding(2) var<storage, read> page_uvs: array<vec2f>; // if LIGHTMAP
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
}

@vertex
fn vertex(in: VertexIn) -> VertexOut {
    let instance = instances[in.instance];
    let object = vec4f(in.position, 1.0);
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
    return out;
}

@fragment
fn fragment(in: VertexOut, @builtin(front_facing) front: bool) -> @location(0) vec4f {
    var base = surface.base_color * in.color;
    base *= base_texel(in.uv_0, in.uv_more); // if BASE_TEXTURE
    if base.a < surface.alpha_cutoff { discard; } // if MASK
    let facing = select(-1.0, 1.0, front);
    let flat = normalize(in.normal) * facing; // if NORMAL_MAP
    let normal = bent_normal(flat, in.place, in.uv_0); // if NORMAL_MAP
    let normal = normalize(in.normal) * facing; // unless NORMAL_MAP
    var light = vec3f(0.0);
    let around = texels_around(in.page_uv); // if LIGHTMAP
    light += baked_irradiance(around); // if LIGHTMAP&!SH1
    light += bent_irradiance(around, flat, normal); // if SH1
    light += lattice_irradiance(in.place, normal); // if PROBES
    var radiance = base.rgb * light / PI;
    radiance += lit_radiance(base.rgb, surface.exponent, in.place, normal); // if LIGHTS
    var emission = surface.emission; // if EMISSION
    emission *= emission_texel(in.uv_0, in.uv_more); // if EMISSION_TEXTURE
    radiance += emission; // if EMISSION
    radiance = light; // if SHOW_PAGE
    radiance *= texel_pattern(in.page_uv); // if SHOW_TEXELS
    radiance = node_color(in.node); // if SHOW_NODES
    let air = air_along(normalize(in.place), length(in.place)); // if AIR
    radiance = radiance * air.transmittance + air.inscatter; // if AIR
    return vec4f(radiance, base.a); // if BLEND
    return vec4f(radiance, 1.0); // unless BLEND
}
