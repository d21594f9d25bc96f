// A piece of a view ray on one side of a lamp's foot, and Gauss-Legendre sums on it. Twin: bake_optics::airlight::panels.
// uses: sight, emitter

struct Panel {
    past: bool,
    begin: Place,
    // x = r - z before the foot, y = r + z past it, at the start.
    start: f32,
    excess: f32,
    // Width in 1/x or ln y.
    width: f32,
}

// Twin: Panel::new.
fn panel_of(sight: Sight, begin: Place, end: Place) -> Panel {
    let za = begin.z;
    let zb = end.z;
    let ra = distance_at(za, sight.h);
    let rb = distance_at(zb, sight.h);
    let excess = select(excess_at(sight, begin), 0.0, begin.s == 0.0);
    let way = way_between(begin, end);
    let slope = (za + zb) / (ra + rb);
    if za + zb <= 0.0 {
        let start = ra - za;
        return Panel(false, begin, start, excess, way * (1.0 - slope) / start / (rb - zb));
    }
    let start = ra + max(za, 0.0);
    return Panel(true, begin, start, excess, log1p(way * (1.0 + slope) / start));
}

// How far nodes are drawn towards the foot. Twin: grading.
fn grading(panel: Panel) -> f32 {
    return select(0.0, clamp(0.05 * (panel.width - 2.0), 0.0, 0.8), panel.past);
}

struct Node {
    point: PathPoint,
    // Weight times ds/r^2.
    weight: f32,
}

// Node `i` of the rule on a panel. Twins: Panel::point, Integrand::graded_sum.
fn panel_node(sight: Sight, panel: Panel, i: u32) -> Node {
    let h = sight.h;
    let pull = grading(panel);
    let bent = pull * RULE_NODES[i];
    let offset = panel.width * RULE_NODES[i] * (1.0 - pull + bent);
    let weight = panel.width * RULE_WEIGHTS[i] * (1.0 - pull + 2.0 * bent);
    if !panel.past {
        let inverse = 1.0 / panel.start + offset;
        let p = h * inverse;
        let grown = h * h * offset;
        let gone = 0.5 * (grown + panel.start * offset / inverse);
        return Node(path_point(Place(panel.begin.s + gone, panel.begin.z + gone), panel.excess + grown, p, false), weight * 2.0 / (1.0 + p * p));
    }
    let grown = panel.start * expm1(offset);
    let y = panel.start + grown;
    let q = h / y;
    let gone = 0.5 * grown * (1.0 + q * (h / panel.start));
    return Node(path_point(Place(panel.begin.s + gone, panel.begin.z + gone), panel.excess + grown, q, true), weight * 2.0 / (y * (1.0 + q * q)));
}
