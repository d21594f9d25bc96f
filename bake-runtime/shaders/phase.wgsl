// Phase functions, 1/sr, over the deflection of light. Twins: bake_optics::phase.
// uses: legendre // if PHASE_LEGENDRE

// Cosine of the deflection angle, and its distances from straight on and straight back.
struct Deflection {
    cos_theta: f32,
    one_minus_cos: f32,
    one_plus_cos: f32,
}

const INVERSE_FOUR_PI = 0.0795774715459477;

// Twin: henyey_greenstein_deflected: the denominator as a sum of positive terms.
fn henyey_greenstein(g: f32, deflection: Deflection) -> f32 {
    let a = abs(g);
    let from_peak = select(deflection.one_plus_cos, deflection.one_minus_cos, g >= 0.0);
    let gap = 1.0 - a;
    let denominator = max(gap * gap + 2.0 * a * from_peak, 1e-24);
    return gap * (1.0 + a) / (denominator * sqrt(denominator)) * INVERSE_FOUR_PI;
}

// Twin: linear_deflected.
fn linear_phase(a1: f32, deflection: Deflection) -> f32 {
    let from_zero = select(deflection.one_minus_cos, deflection.one_plus_cos, a1 >= 0.0);
    return (1.0 - abs(a1) + abs(a1) * from_zero) * INVERSE_FOUR_PI;
}

// Twin: rayleigh.
fn rayleigh(cos_theta: f32) -> f32 {
    return 0.75 * (1.0 + cos_theta * cos_theta) * INVERSE_FOUR_PI;
}

// Twin: Phase::eval_deflected. Only the kinds that the media have are here.
fn phase(medium: Medium, deflection: Deflection) -> f32 {
    if medium.phase == 1u { return linear_phase(medium.asymmetry, deflection); } // if PHASE_LINEAR
    if medium.phase == 2u { return rayleigh(deflection.cos_theta); } // if PHASE_RAYLEIGH
    if medium.phase == 3u { return henyey_greenstein(medium.asymmetry, deflection); } // if PHASE_HENYEY_GREENSTEIN
    if medium.phase == 4u { return legendre(medium.first, medium.count, deflection.cos_theta) * INVERSE_FOUR_PI; } // if PHASE_LEGENDRE
    return INVERSE_FOUR_PI;
}
