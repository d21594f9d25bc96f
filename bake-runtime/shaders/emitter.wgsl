// How lamps spread their light. Twins: bake_optics::emitter.
// uses: legendre // if LAMP_LEGENDRE

// Square of the share that a cosine has gone from the outer edge to the inner one.
fn cone_ramp(width: f32, beyond: f32) -> f32 {
    let step = select(0.0, 1.0, beyond >= 0.0);
    let ramp = select(step, clamp(beyond / max(width, 1e-12), 0.0, 1.0), width > 0.0);
    return ramp * ramp;
}

// Twin: spot_cone.
fn spot_cone(cos_inner: f32, cos_outer: f32, cosine: f32) -> f32 {
    return cone_ramp(cos_inner - cos_outer, cosine - cos_outer);
}

// Relative intensity towards a cosine from the axis. Twin: Emitter::eval.
fn emitted(lamp: Lamp, cosine: f32) -> f32 {
    if lamp.shape == 1u { return spot_cone(lamp.cos_inner, lamp.cos_outer, clamp(cosine, -1.0, 1.0)); } // if LAMP_CONE
    if lamp.shape == 2u { return max(0.0, legendre(lamp.first, lamp.count, clamp(cosine, -1.0, 1.0))); } // if LAMP_LEGENDRE
    return 1.0;
}
