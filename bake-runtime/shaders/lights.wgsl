// Lights that were not baked: what surfaces reflect of them, through air where there is any.
// uses: frame, emitter, lamps
// uses: medium // if FOGGED
// uses: softened // if SOFTENED
// uses: shadow // if SHADOWS

// Share of the light that passes from a place along a direction.
fn passage(place: vec3f, dir: vec3f, away: f32) -> vec3f {
    return fall3(optical_depth(ViewRay(place, dir, away))); // if FOGGED
    return vec3f(1.0); // unless FOGGED
}

// Reflected share towards the eye per unit irradiance, 1/sr: Lambert, and a Phong lobe that returns four per cent.
fn reflected(base: vec3f, exponent: f32, normal: vec3f, to_light: vec3f, to_eye: vec3f) -> vec3f {
    var share = base / PI;
    let mirrored = max(0.0, dot(reflect(-to_light, normal), to_eye)); // if SPECULAR
    share += vec3f(0.04 * (exponent + 2.0) / (2.0 * PI) * pow(mirrored, exponent)); // if SPECULAR
    return share;
}

// Radiance of a surface at `place` (relative to the eye). Source of the softened part: Sun et al. 2005, eqs. 14 to 18.
fn lit_radiance(base: vec3f, exponent: f32, place: vec3f, normal: vec3f) -> vec3f {
    let to_eye = -normalize(place);
    var sum = vec3f(0.0);
    for (var i = 0u; i < frame.lamp_count; i++) { // if LAMPS
        let lamp = lamps[i]; // if LAMPS
        if lamp.dynamic == 1u { sum += lamp.intensity * lamp_reflected(lamp, base, exponent, place, normal, to_eye); } // if LAMPS
    } // if LAMPS
    for (var i = 0u; i < frame.sun_count; i++) { // if SUNS
        let sun = suns[i]; // if SUNS
        if sun.dynamic == 1u { sum += sun.irradiance * sun_reflected(sun, base, exponent, place, normal, to_eye); } // if SUNS
    } // if SUNS
    return sum;
}

// Per unit intensity of the lamp.
fn lamp_reflected(lamp: Lamp, base: vec3f, exponent: f32, place: vec3f, normal: vec3f, to_eye: vec3f) -> vec3f {
    let offset = lamp.position - place;
    let away = max(length(offset), max(lamp.radius, 1e-6));
    let to_light = offset / max(length(offset), 1e-20);
    let cosine = max(0.0, dot(normal, to_light));
    var direct = passage(place, to_light, away) * (cosine * emitted(lamp, -dot(lamp.axis, to_light)) / (away * away));
    direct *= select(0.0, 1.0, is_lit(maps_of_lamp(lamp), place + normal * shadow_offset(lamp, place))); // if SHADOWS
    var sum = direct * reflected(base, exponent, normal, to_light, to_eye);
    sum += softened_radiance(base, exponent, away, normal, to_light, to_eye); // if SOFTENED
    return sum;
}

// Per unit irradiance of the sun.
fn sun_reflected(sun: Sun, base: vec3f, exponent: f32, place: vec3f, normal: vec3f, to_eye: vec3f) -> vec3f {
    let cosine = max(0.0, -dot(normal, sun.direction));
    var direct = passage(place, -sun.direction, FAR_AWAY) * cosine;
    direct *= select(0.0, 1.0, is_lit(maps_of_sun(sun), place + normal * 1e-3)); // if SHADOWS
    return direct * reflected(base, exponent, normal, -sun.direction, to_eye);
}

// Where suns are, metres.
const FAR_AWAY = 1e9;
