// Air that scatters and takes nothing away. Twins: bake_optics::airlight::{Vacuum, macklin}.
// uses: lamp_sight
// uses: air_uniform // unless LAYERED
// uses: air_layered // if LAYERED

// Angle at the lamp between the ends of the ray. Twin: opening_angle.
fn opening_angle(z: f32, h: f32, length_of_ray: f32) -> f32 {
    return angle_of(h * length_of_ray, h * h + z * (z + length_of_ray));
}

// Integral of ds/r^2. Twin: inverse_square_integral.
fn inverse_square_integral(z: f32, h: f32, length_of_ray: f32) -> f32 {
    let flat = length_of_ray / (h * h + z * (z + length_of_ray));
    let x = h * flat;
    if flat > 0.0 && x < 1e-3 {
        return flat * (1.0 - x * x * (1.0 / 3.0 - x * x * 0.2));
    }
    return opening_angle(z, h, length_of_ray) / h;
}

// Mean of scattering times lamp over the angle seen from the lamp, times the integral. Twin: Vacuum::radiance.
fn lamp_airlight(ray: ViewRay, lamp: Lamp) -> vec3f {
    let sight = lamp_sight(ray, lamp);
    let start = angle_of(sight.h, -sight.z);
    let opening = opening_angle(sight.z, sight.h, sight.length);
    var mean = vec3f(0.0);
    for (var i = 0u; i < RULE_COUNT; i++) {
        let angle = min(start + opening * RULE_NODES[i], PI);
        let half_sin = sin(0.5 * angle);
        let half_cos = cos(0.5 * angle);
        let deflection = Deflection(half_cos * half_cos - half_sin * half_sin, 2.0 * half_sin * half_sin, 2.0 * half_cos * half_cos);
        let cosine = sight.axis_across * 2.0 * half_sin * half_cos - sight.axis_along * deflection.cos_theta;
        mean += RULE_WEIGHTS[i] * emitted(lamp, cosine) * vacuum_scattering(ray, sight, angle, deflection);
    }
    return mean * inverse_square_integral(sight.z, sight.h, sight.length);
}

// Scattering where the angle at the lamp is `angle`.
fn vacuum_scattering(ray: ViewRay, sight: Sight, angle: f32, deflection: Deflection) -> vec3f {
    let s = -sight.h * cos(angle) / max(sin(angle), 1e-6) - sight.z; // if LAYERED
    return scattering_at(ray.origin + ray.dir * clamp(s, 0.0, ray.length), deflection); // if LAYERED
    var sum = vec3f(0.0); // unless LAYERED
    for (var m = 0u; m < MEDIA; m++) { sum += media[m].sigma_s * phase(media[m], deflection); } // unless LAYERED
    return sum; // unless LAYERED
}
