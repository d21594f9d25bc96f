//! A radial function known at nodes uniform in ln r and read in between by six-point Lagrange interpolation.
//!
//! Holds several functions side by side ("lanes") that are read at the same place, so that weights are found once.

/// Lanes of a radial function, each `q(r)`; what q is, the maker says.
#[derive(Debug, Clone)]
pub struct Profile {
    lanes: usize,
    start: f64,
    step: f64,
    values: Vec<f64>,
}

/// Where a distance lies among the nodes.
#[derive(Debug, Clone, Copy)]
pub struct Place {
    first: usize,
    weights: [f64; 6],
}

impl Profile {
    /// The `count` node distances from `from` to `to`.
    pub fn nodes(from: f64, to: f64, count: usize) -> Vec<f64> {
        let step = (to / from).ln() / (count - 1) as f64;
        (0..count).map(|i| (from.ln() + step * i as f64).exp()).collect()
    }

    /// From rows of `lanes` values at the nodes of [`Profile::nodes`] with the same arguments.
    pub fn new(from: f64, to: f64, rows: &[Vec<f64>]) -> Self {
        let step = (to / from).ln() / (rows.len() - 1) as f64;
        Self { lanes: rows[0].len(), start: from.ln(), step, values: rows.concat() }
    }

    /// Six-point Lagrange weights at `r`; outside the nodes the value at the nearest end is held.
    #[inline]
    pub fn place(&self, r: f64) -> Place {
        let last = self.values.len() / self.lanes - 1;
        let x = ((r.max(f64::MIN_POSITIVE).ln() - self.start) / self.step).clamp(0.0, last as f64);
        let first = (x as usize).saturating_sub(2).min(last - 5);
        let t = x - first as f64;
        // ∏_{j≠i} (t − j)/(i − j), the denominators written out.
        let d = [t, t - 1.0, t - 2.0, t - 3.0, t - 4.0, t - 5.0];
        let (low, high) = (d[0] * d[1] * d[2], d[3] * d[4] * d[5]);
        let weights = [
            d[1] * d[2] * high / -120.0,
            d[0] * d[2] * high / 24.0,
            d[0] * d[1] * high / -12.0,
            low * d[4] * d[5] / 12.0,
            low * d[3] * d[5] / -24.0,
            low * d[3] * d[4] / 120.0,
        ];
        Place { first, weights }
    }

    /// All lanes at a place into `out`.
    #[inline]
    pub fn read(&self, place: &Place, out: &mut [f64]) {
        let block = &self.values[place.first * self.lanes..(place.first + 6) * self.lanes];
        out.fill(0.0);
        for (row, w) in block.chunks_exact(self.lanes).zip(place.weights) {
            out.iter_mut().zip(row).for_each(|(o, v)| *o += w * v);
        }
    }

    /// The first lane at `r`.
    #[inline]
    pub fn eval(&self, r: f64) -> f64 {
        let place = self.place(r);
        (0..6).map(|i| place.weights[i] * self.values[(place.first + i) * self.lanes]).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_reproduces_nodes_and_quintics_in_ln_r() {
        let f = |r: f64| (1.0 + r.ln()).powi(5) * 1e-3 + r.ln();
        let nodes = Profile::nodes(1e-3, 1e2, 40);
        let rows: Vec<_> = nodes.iter().map(|&r| vec![f(r), -f(r)]).collect();
        let profile = Profile::new(1e-3, 1e2, &rows);
        let mut out = [0.0; 2];
        for i in 0..=200 {
            let r = 1e-3 * 1e5f64.powf(i as f64 / 200.0);
            profile.read(&profile.place(r), &mut out);
            assert!((out[0] - f(r)).abs() < 1e-10 && (out[1] + f(r)).abs() < 1e-10, "{r}");
            assert_eq!(out[0], profile.eval(r));
        }
        assert!((profile.eval(1e-9) - f(1e-3)).abs() < 1e-10 && (profile.eval(1e9) - f(1e2)).abs() < 1e-9);
    }
}
