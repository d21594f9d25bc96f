// All that the air does along one view ray from the eye.
// uses: frame, medium, lamps
// uses: air_uniform // unless LAYERED
// uses: air_layered // if LAYERED
// uses: airlight_quadrature // if QUADRATURE
// uses: airlight_vacuum // if VACUUM
// uses: airlight_lut // if LUT
// uses: airlight_closed_form // if CLOSED_FORM
// uses: airlight_ray_march // if RAY_MARCH
// uses: shafts // if SHAFTS
// uses: airlight_sun // if SUNS
// uses: sun_march // if SUNS&RAY_MARCH
// uses: sun_shafts // if SUNS&SHADOWS&!RAY_MARCH
// uses: lattice_inscatter // if LATTICE_AIR

// Most that a lamp of unit intensity gives, 1/m^2: an eye within a lamp in air as thick as rock.
const BRIGHTEST = 1e24;

struct Air {
    // Radiance scattered towards the eye, cd/m^2.
    inscatter: vec3f,
    // Share of the light from behind that passes.
    transmittance: vec3f,
}

// `dir`: unit; `away`: distance to the first surface.
fn air_along(dir: vec3f, away: f32) -> Air {
    let whole = ViewRay(vec3f(0.0), dir, away);
    var air = Air(vec3f(0.0), vec3f(1.0));
    air.transmittance = fall3(optical_depth(whole)); // unless VACUUM
    let span = air_span(whole);
    if span.x >= span.y {
        return air;
    }
    let inside = ViewRay(dir * span.x, dir, span.y - span.x); // unless LAYERED
    let inside = ViewRay(vec3f(0.0), dir, span.y); // if LAYERED
    for (var i = 0u; i < frame.lamp_count; i++) { // if LAMPS
        let lamp = lamps[i]; // if LAMPS
        air.inscatter += lamp.intensity * min(lamp_airlight(inside, lamp), vec3f(BRIGHTEST)); // if LAMPS&!CLOSED_FORM&!LUT&!SHAFTS
        air.inscatter += lamp.intensity * min(lamp_airlight_shadowed(inside, lamp), vec3f(BRIGHTEST)); // if LAMPS&SHAFTS
        air.inscatter += lamp.intensity * min(lamp_airlight_table(inside, lamp), vec3f(BRIGHTEST)); // if LAMPS&LUT
        air.inscatter += lamp.intensity * min(lamp_airlight_closed(inside, lamp), vec3f(BRIGHTEST)); // if LAMPS&CLOSED_FORM
    } // if LAMPS
    for (var i = 0u; i < frame.sun_count; i++) { // if SUNS
        air.inscatter += suns[i].irradiance * sun_airlight_marched(inside, suns[i]); // if SUNS&RAY_MARCH
        air.inscatter += suns[i].irradiance * sun_airlight_shadowed(inside, suns[i]); // if SUNS&SHADOWS&!RAY_MARCH
        air.inscatter += suns[i].irradiance * sun_between(inside, suns[i], 0.0, inside.length); // if SUNS&!SHADOWS&!RAY_MARCH
    } // if SUNS
    air.inscatter += lattice_inscatter(ViewRay(dir * span.x, dir, span.y - span.x)); // if LATTICE_AIR
    return air;
}
