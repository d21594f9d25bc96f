// A ray cut where its integrand has corners: the lamp's foot, the edges of its cone, borders of media. Twin: Integrand::pieces.
// uses: panel
// uses: air_uniform // unless LAYERED
// uses: air_layered // if LAYERED

struct Cuts {
    at: array<f32, CUTS>,
    count: u32,
}

// Keeps the list ascending; what lies outside (0, end) is no cut.
fn add_cut(cuts: ptr<function, Cuts>, s: f32, end: f32) {
    if !(s > 0.0 && s < end) || (*cuts).count >= CUTS {
        return;
    }
    var i = (*cuts).count;
    while i > 0u && (*cuts).at[i - 1u] > s {
        (*cuts).at[i] = (*cuts).at[i - 1u];
        i--;
    }
    (*cuts).at[i] = s;
    (*cuts).count++;
}

// Ends of the pieces of a sight but its start.
fn cuts_of(ray: ViewRay, lamp: Lamp, sight: Sight, end: f32) -> Cuts {
    var cuts: Cuts;
    cuts.count = 0u;
    add_cut(&cuts, -sight.z, end);
    if lamp.shape == 1u { // if LAMP_CONE
        let outer = crossings(sight, lamp.cos_outer); // if LAMP_CONE
        let inner = crossings(sight, lamp.cos_inner); // if LAMP_CONE
        add_cut(&cuts, outer.x, end); // if LAMP_CONE
        add_cut(&cuts, outer.y, end); // if LAMP_CONE
        add_cut(&cuts, inner.x, end); // if LAMP_CONE
        add_cut(&cuts, inner.y, end); // if LAMP_CONE
    } // if LAMP_CONE
    for (var m = 0u; m < MEDIA; m++) { // if LAYERED
        let span = clip_bounds(media[m], ray); // if LAYERED
        add_cut(&cuts, span.x, end); // if LAYERED
        add_cut(&cuts, span.y, end); // if LAYERED
    } // if LAYERED
    return cuts;
}

// The first place that a cone lights; 0 for lamps that shine everywhere.
fn first_lit(lamp: Lamp, sight: Sight) -> f32 {
    if lamp.shape == 1u && emitted(lamp, cos_axis(sight, point_at(sight, 0.0))) <= 0.0 { // if LAMP_CONE
        let outer = crossings(sight, lamp.cos_outer); // if LAMP_CONE
        let a = select(FAR, outer.x, outer.x > 0.0); // if LAMP_CONE
        let b = select(FAR, outer.y, outer.y > 0.0); // if LAMP_CONE
        return min(sight.length, min(a, b)); // if LAMP_CONE
    } // if LAMP_CONE
    return 0.0;
}
