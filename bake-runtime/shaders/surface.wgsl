// Surfaces: what they emit and reflect of baked light.
// uses: frame, placed
// uses: base_texture // if BASE_TEXTURE
// uses: emission_texture // if EMISSION_TEXTURE
// uses: lightmap // if LIGHTMAP
// uses: sh1 // if SH1
// uses: normal_map // if NORMAL_MAP
// uses: texel_pattern // if SHOW_TEXELS
// uses: density // if SHOW_DENSITY
// uses: hashed_color // if SHOW_NODES|SHOW_CHARTS
// uses: probes // if PROBES
// uses: lights // if LIGHTS
// uses: inscatter // if AIR

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
    light += probe_irradiance(in.place, normal); // if PROBES
    var radiance = base.rgb * light / PI;
    radiance += lit_radiance(base.rgb, surface.exponent, in.place, normal); // if LIGHTS
    var emission = surface.emission; // if EMISSION
    emission *= emission_texel(in.uv_0, in.uv_more); // if EMISSION_TEXTURE
    radiance += emission; // if EMISSION
    radiance = light; // if SHOW_PAGE
    radiance *= texel_pattern(in.page_uv); // if SHOW_TEXELS
    radiance = hashed_color(in.node); // if SHOW_NODES
    radiance = density_color(in.page_uv, in.place); // if SHOW_DENSITY
    radiance = hashed_color(in.chart); // if SHOW_CHARTS
    radiance = vec3f(0.2); // if SHOW_GREY
    let air = air_along(normalize(in.place), length(in.place)); // if AIR
    radiance = radiance * air.transmittance + air.inscatter; // if AIR
    return vec4f(radiance, base.a); // if BLEND
    return vec4f(radiance, 1.0); // unless BLEND
}
