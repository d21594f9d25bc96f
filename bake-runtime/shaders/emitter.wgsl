// How lamps spread their light. Twins: bake_optics::emitter.
// uses: legendre // if LAMP_LEGENDRE

// Twin: spot_cone.
fn spot_cone(cos_inner: f32, cos_outer: f32, cosine: f32) -> f32 {
    let width = cos_inner - cos_outer;
    let step = select(0.0, 1.0, cosine >= cos_outer);
    let ramp = select(step, clamp((cosine - cos_outer) / max(width, 1e-12), 0.0, 1.0), width > 0.0);
    return ramp * ramp;
}

// Relative intensity towards a cosine from the axis. Twin: Emitter::eval.
fn emitted(lamp: Lamp, cosine: f32) -> f32 {
    if lamp.shape == 1u { return spot_cone(lamp.cos_inner, lamp.cos_outer, clamp(cosine, -1.0, 1.0)); } // if LAMP_CONE
    if lamp.shape == 2u { return max(0.0, legendre(lamp.first, lamp.count, clamp(cosine, -1.0, 1.0))); } // if LAMP_LEGENDRE
    return 1.0;
}
