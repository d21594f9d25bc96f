// How a view ray passes a lamp.
// uses: sight, emitter, view_ray
// uses: cone // if LAMP_CONE

fn lamp_sight(ray: ViewRay, lamp: Lamp) -> Sight {
    let q = ray.origin - lamp.position;
    var sight = sight_of(ray.dir, q, ray.length, lamp.axis, lamp.radius);
    if lamp.shape == 1u { // if LAMP_CONE
        let off = off_square(ray.dir, q, lamp.axis); // if LAMP_CONE
        sight.outer = crossings(sight, off, lamp.cos_outer); // if LAMP_CONE
        sight.inner = crossings(sight, off, lamp.cos_inner); // if LAMP_CONE
    } // if LAMP_CONE
    return sight;
}

// Relative intensity of the lamp towards a point of the ray.
fn emitted_to(lamp: Lamp, sight: Sight, point: PathPoint) -> f32 {
    let cosine = cos_axis(sight, point);
    if lamp.shape == 1u { // if LAMP_CONE
        return cone_ramp(lamp.cos_inner - lamp.cos_outer, beyond_edge(sight, point, cosine, lamp.cos_outer)); // if LAMP_CONE
    } // if LAMP_CONE
    return emitted(lamp, cosine);
}
