//! What is worth its time: the front of points that no other beats in both seconds and error.

/// Indices of the points (seconds, error) that no other point beats or equals in both, fastest first.
pub fn front(points: &[(f64, f64)]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by(|&a, &b| points[a].0.total_cmp(&points[b].0).then(points[a].1.total_cmp(&points[b].1)));
    let mut best = f64::INFINITY;
    order.retain(|&at| {
        let better = points[at].1 < best;
        best = best.min(points[at].1);
        better
    });
    order
}

/// The fastest point whose error is at most `level`.
pub fn cheapest(points: &[(f64, f64)], level: f64) -> Option<usize> {
    let reaching = (0..points.len()).filter(|&at| points[at].1 <= level);
    reaching.min_by(|&a, &b| points[a].0.total_cmp(&points[b].0))
}

/// Seconds at which a line of points, in the order of their effort, comes down to `level`: by a power law between the
/// two points around it; `None` where the line ends above. The first point's seconds where it is good enough at once.
pub fn seconds_to(line: &[(f64, f64)], level: f64) -> Option<f64> {
    let below = line.iter().position(|point| point.1 <= level)?;
    let (seconds, error) = line[below];
    if below == 0 {
        return Some(seconds);
    }
    let (before, worse) = line[below - 1];
    let share = (worse / level).ln() / (worse / error.max(f64::MIN_POSITIVE)).ln();
    Some(before * (seconds / before).powf(share))
}

#[cfg(test)]
mod tests {
    use super::*;

    const POINTS: [(f64, f64); 5] = [(1.0, 0.10), (4.0, 0.05), (2.0, 0.20), (3.0, 0.04), (16.0, 0.025)];

    #[test]
    fn beaten_points_are_not_on_the_front() {
        assert_eq!(front(&POINTS), [0, 3, 4]);
        assert_eq!(front(&[]), [0; 0]);
        assert_eq!(front(&[(1.0, 0.1), (1.0, 0.1), (2.0, 0.1)]), [0], "equals stand once");
    }

    #[test]
    fn the_cheapest_reaches_its_level() {
        assert_eq!([0.2, 0.05, 0.03, 0.02].map(|level| cheapest(&POINTS, level)), [Some(0), Some(3), Some(4), None]);
    }

    #[test]
    fn time_between_points_follows_their_power_law() {
        // Error falls as one over the root of time.
        let line = [(1.0, 0.08), (4.0, 0.04), (16.0, 0.02)];
        assert!((seconds_to(&line, 0.02 * 2f64.sqrt()).expect("within") - 8.0).abs() < 1e-9);
        assert_eq!((seconds_to(&line, 0.1), seconds_to(&line, 0.01)), (Some(1.0), None));
    }
}
