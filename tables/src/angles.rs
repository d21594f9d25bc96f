//! Angles of an emitter's axis at which responses are read: a coordinate in which linear reading is good at every order.
//!
//! Light scattered once has a kink at θ = 90°, smoothed by the air; light scattered more often is a polynomial in cos θ whose slope is
//! largest, and whose value is smallest, where the emitter faces away. Nodes are uniform in
//! `s = ±(1 − g(u))`, `u = sqrt(1 − |cos θ|)`, the sign that of cos θ: close together at 90° by g'(1), uniform in θ at the ends by u.

/// g: coefficients of u, u², u³, u⁴; g(0) = 0, g(1) = 1. Found by least largest error of linear reading over orders 1, 2 and 3,
/// |g| ≤ 0.8 and all distances.
const G: [f32; 4] = [0.285, 1.05, -2.585, 2.25];

/// Place of cos θ from −1 to 1.
#[inline]
pub(crate) fn coordinate(cos_emitter: f32) -> f32 {
    let u = (1.0 - cos_emitter.abs()).max(0.0).sqrt();
    (1.0 - (((G[3] * u + G[2]) * u + G[1]) * u + G[0]) * u).copysign(cos_emitter)
}

/// cos θ at a place from −1 to 1, the inverse of [`coordinate`]; by bisection.
fn cosine(place: f64) -> f64 {
    let [a, b, c, d] = G.map(f64::from);
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..60 {
        let u = 0.5 * (low + high);
        let above = (((d * u + c) * u + b) * u + a) * u > 1.0 - place.abs();
        *(if above { &mut high } else { &mut low }) = u;
    }
    (1.0 - low * low).copysign(place)
}

/// Cosines of `count` nodes and of the places in the middle between them, in turn: `2 count − 1`.
pub(crate) fn cosines(count: usize) -> Vec<f64> {
    (0..2 * count - 1).map(|i| cosine(i as f64 / (count - 1) as f64 - 1.0)).collect()
}

/// Nodes for linear reading from values at nodes and at the places in the middle between them, in turn. Between its nodes a line errs to
/// one side; moved by half of that, the nodes err as much to the other.
pub(crate) fn balanced<V: AsRef<[f64]> + AsMut<[f64]> + Clone>(values: &[V]) -> Vec<V> {
    let value = |i: usize, lane: usize| values[i].as_ref()[lane];
    let excess = |middle: usize, lane| 0.5 * (value(middle - 1, lane) + value(middle + 1, lane)) - value(middle, lane);
    let last = values.len() - 1;
    let at = |i: usize| {
        let (mut node, left, right) = (values[i].clone(), i.max(2) - 1, (i + 1).min(last - 1));
        let lanes = node.as_mut().iter_mut().enumerate();
        lanes.for_each(|(lane, value)| *value -= 0.25 * (excess(left, lane) + excess(right, lane)));
        node
    };
    (0..=last).step_by(2).map(at).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mapping_is_its_own_inverse() {
        for i in 0..=480 {
            let place = i as f64 / 240.0 - 1.0;
            assert!((f64::from(coordinate(cosine(place) as f32)) - place).abs() < 2e-4, "{place}");
        }
        assert_eq!([-1.000_1, -1.0, 1.0, 1.000_1].map(coordinate), [-1.0, -1.0, 1.0, 1.0]);
        assert!(coordinate(0.0).abs() < 1e-6);
        let cosines = cosines(65);
        assert_eq!((cosines.len(), cosines[0], cosines[64].abs() < 1e-9, cosines[128]), (129, -1.0, true, 1.0));
        assert!(cosines.is_sorted());
    }

    /// Largest error of linear reading of c ↦ e^{2c} from nodes made by `nodes`.
    fn error(nodes: impl Fn(&[[f64; 1]]) -> Vec<[f64; 1]>) -> f64 {
        let count = 17;
        let nodes = nodes(&cosines(count).iter().map(|c| [(2.0 * c).exp()]).collect::<Vec<_>>());
        let at = |i: usize| {
            let c = i as f32 / 1000.0 - 1.0;
            let x = 0.5 * (coordinate(c) + 1.0) * (count - 1) as f32;
            let node = (x as usize).min(count - 2);
            let linear = nodes[node][0] + f64::from(x - node as f32) * (nodes[node + 1][0] - nodes[node][0]);
            (linear - (2.0 * f64::from(c)).exp()).abs()
        };
        (0..=2000).map(at).fold(0.0, f64::max)
    }

    #[test]
    fn balanced_nodes_halve_the_error() {
        let (plain, balanced) = (error(|v| v.iter().step_by(2).copied().collect()), error(balanced));
        println!("error {plain:.2e}, balanced {balanced:.2e}");
        assert!(balanced < 0.65 * plain, "{balanced} {plain}");
    }
}
