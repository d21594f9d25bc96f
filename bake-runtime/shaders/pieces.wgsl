// A ray cut where its integrand has corners: the lamp's foot, the edges of its cone, borders of media. Twin: Integrand::pieces.
// uses: cuts, panel, lamp_sight
// uses: mesh_cuts // if BOUNDS_MESH
// uses: air_uniform // unless LAYERED
// uses: air_layered // if LAYERED

// Borders of the pieces between two places.
fn cuts_of(ray: ViewRay, lamp: Lamp, sight: Sight, begin: Place, end: Place) -> Cuts {
    var cuts: Cuts;
    cuts.count = 0u;
    add_cut(&cuts, place_past_foot(sight, 0.0), begin, end);
    if lamp.shape == 1u { // if LAMP_CONE
        add_cut(&cuts, place_past_foot(sight, sight.outer.x), begin, end); // if LAMP_CONE
        add_cut(&cuts, place_past_foot(sight, sight.outer.y), begin, end); // if LAMP_CONE
        add_cut(&cuts, place_past_foot(sight, sight.inner.x), begin, end); // if LAMP_CONE
        add_cut(&cuts, place_past_foot(sight, sight.inner.y), begin, end); // if LAMP_CONE
    } // if LAMP_CONE
    for (var m = 0u; m < MEDIA; m++) { // if LAYERED
        let span = clip_bounds(media[m], ray); // if LAYERED
        add_cut(&cuts, place_at(sight, span.x), begin, end); // if LAYERED
        add_cut(&cuts, place_at(sight, span.y), begin, end); // if LAYERED
        if media[m].bounds == 4u { add_mesh_cuts(&cuts, media[m], ray, vec4f(lamp.position, 1.0), begin, end); } // if BOUNDS_MESH
    } // if LAYERED
    return cuts;
}

// The first place that a cone lights; 0 for lamps that shine everywhere.
fn first_lit(lamp: Lamp, sight: Sight) -> f32 {
    if lamp.shape == 1u && emitted_to(lamp, sight, point_at(sight, place_at(sight, 0.0))) <= 0.0 { // if LAMP_CONE
        let ahead = select(vec2f(FAR), sight.outer - sight.z, sight.outer > vec2f(sight.z)); // if LAMP_CONE
        return min(sight.length, min(ahead.x, ahead.y)); // if LAMP_CONE
    } // if LAMP_CONE
    return 0.0;
}
