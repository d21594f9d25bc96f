//! Light at the nodes on the lattice's border, drawn out from where their air lies.
//!
//! Only half a cell's air looks a border node up: its mean is the light a third of a cell inwards, and looked up as the
//! light on the border it makes light that falls towards the border too bright there. On the ground under fog of depth 0.5
//! to 4 and albedo 0.5 to 1, four cells deep and at most 0.4 mean free paths a cell, that is 0.0 to +4.0 %, drawn out −0.6 to
//! +1.5 % (the tests' one-dimensional quadrature). The first fill stays as it is: its excess makes up for what means over cells take
//! from light that bends down, as it does in fog.

use super::LightGrid;
use crate::solve::sphere::Sh9;
use crate::trace::Tracer;
use glam::{UVec3, Vec3};

/// The border lies a third of a cell beyond the light that its node holds, the next node's two thirds on the other side.
const DRAWN_OUT: f32 = 0.5;
/// Share of its order 0 that a node may lose or gain.
const MOST: f32 = 0.5;

impl LightGrid {
    /// Light at the nodes, with what the border's nodes hold drawn out along a line through that of the next ones inwards
    /// which they see.
    pub(super) fn drawn_out<const N: usize>(&self, tracer: &Tracer, nodes: &[[Sh9; N]]) -> Vec<[Sh9; N]> {
        let drawn_out = |(index, light): (usize, &[Sh9; N])| {
            let next: Vec<_> = self.next_inwards(tracer, index as u32).map(|next| &nodes[next]).collect();
            std::array::from_fn(|kind| line(&light[kind], next.iter().map(|next| &next[kind])))
        };
        nodes.iter().enumerate().map(drawn_out).collect()
    }

    /// For each border that a free node lies on, the next node inwards, where it is seen.
    fn next_inwards<'a>(&'a self, tracer: &'a Tracer<'a>, index: u32) -> impl Iterator<Item = usize> + 'a {
        let at = self.lattice_point(index);
        let steps = UVec3::AXES.into_iter().filter_map(move |axis| {
            let place = at.dot(axis);
            match place {
                0 => Some(at + axis),
                _ if place + 1 == self.size.dot(axis) => Some(at - axis),
                _ => None,
            }
        });
        steps
            .filter(move |&next| self.free[index as usize] && self.sees_node(tracer, self.position(at), next))
            .map(|next| self.index(next))
    }
}

/// A node's light and [`DRAWN_OUT`] of what it has beyond each of the next nodes', as far as [`MOST`] allows.
fn line<'a>(light: &Sh9, next: impl Iterator<Item = &'a Sh9>) -> Sh9 {
    let mut beyond = Sh9::default();
    for next in next {
        for ((sum, here), there) in beyond.iter_mut().zip(light).zip(next) {
            *sum += DRAWN_OUT * (*here - *there);
        }
    }
    let excess = (beyond[0].abs() / (MOST * light[0]).max(Vec3::splat(f32::MIN_POSITIVE))).max_element();
    std::array::from_fn(|i| light[i] + beyond[i] / excess.max(1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_that_falls_evenly_is_right_on_the_border() {
        let at = |x: f32| -> Sh9 { std::array::from_fn(|i| Vec3::splat(2.0 + x) / (1.0 + i as f32)) };
        let drawn = line(&at(1.0 / 3.0), [&at(1.0)].into_iter());
        for (got, want) in drawn.iter().zip(at(0.0)) {
            assert!((*got - want).abs().max_element() < 1e-6, "{got} beside {want}");
        }
        let dark = line(&at(-1.9), [&at(10.0)].into_iter());
        assert!((dark[0].x / at(-1.9)[0].x - 0.5).abs() < 1e-6, "a node keeps half of its light: {}", dark[0]);
        let black = line(&[Vec3::ZERO; 9], [&at(1.0)].into_iter());
        assert!(black[0].abs().max_element() < 1e-30, "and gets none where it had none: {}", black[0]);
    }

    /// E_n(t) = ∫₀¹ μ^{n−2} e^{−t/μ} dμ, by midpoints.
    fn exponential_integral(n: i32, t: f64) -> f64 {
        const STEPS: u32 = 2000;
        let at = |i: u32| (f64::from(i) + 0.5) / f64::from(STEPS);
        (0..STEPS).map(|i| at(i).powi(n - 2) * (-t / at(i)).exp()).sum::<f64>() / f64::from(STEPS)
    }

    /// What black ground under a layer of isotropic fog and an even sky gets by nodes on a line, over what it gets, less one:
    /// with the border drawn out and without. Peierls' equation on 240 thin layers; nodes and their look-up as in the grid.
    fn slab_errors(depth: f64, albedo: f64, cells: usize) -> [f64; 2] {
        const LAYERS: usize = 240;
        let thickness = depth / LAYERS as f64;
        let e2: Vec<f64> = (0..=LAYERS).map(|k| exponential_integral(2, (k as f64 + 0.5) * thickness)).collect();
        let sent = |k: usize| if k == 0 { 1.0 - e2[0] } else { 0.5 * (e2[k - 1] - e2[k]) };
        let kernel: Vec<f64> = (0..LAYERS).map(sent).collect();
        let scattered = |light: &[f64]| -> Vec<f64> {
            let to = |i: usize| light.iter().enumerate().map(|(j, light)| kernel[i.abs_diff(j)] * light).sum::<f64>();
            (0..LAYERS).map(|i| albedo * to(i)).collect()
        };
        let straight: Vec<f64> =
            (0..LAYERS).map(|i| 0.5 * exponential_integral(2, (i as f64 + 0.5) * thickness)).collect();
        let with_straight = |light: &[f64]| -> Vec<f64> { light.iter().zip(&straight).map(|(a, b)| a + b).collect() };
        let mut collided = vec![0.0; LAYERS];
        for _ in 0..300 {
            collided = scattered(&with_straight(&collided));
        }
        let e3: Vec<f64> = (0..=LAYERS).map(|i| exponential_integral(3, depth - i as f64 * thickness)).collect();
        let ground = |collided: &[f64]| -> f64 {
            let seen =
                with_straight(collided).iter().enumerate().map(|(i, j)| albedo * (e3[i + 1] - e3[i]) * j).sum::<f64>();
            2.0 * (e3[0] + seen)
        };
        let place = |i: usize| (i as f64 + 0.5) * cells as f64 / LAYERS as f64;
        let tent = |node: usize, i: usize| (1.0 - (place(i) - node as f64).abs()).max(0.0);
        let nodes = |light: &[f64]| -> Vec<Sh9> {
            let mean = |node| {
                let sum = |of: &dyn Fn(usize) -> f64| (0..LAYERS).map(|i| tent(node, i) * of(i)).sum::<f64>();
                sum(&|i| light[i]) / sum(&|_| 1.0)
            };
            (0..=cells).map(|node| [Vec3::splat(mean(node) as f32); 9]).collect()
        };
        let looked_up = |nodes: &[Sh9]| -> Vec<f64> {
            let at = |i| nodes.iter().enumerate().map(|(node, light)| tent(node, i) * f64::from(light[0].x)).sum();
            (0..LAYERS).map(at).collect()
        };
        let plain = nodes(&scattered(&with_straight(&looked_up(&nodes(&collided)))));
        let mut drawn = plain.clone();
        drawn[0] = line(&plain[0], [&plain[1]].into_iter());
        drawn[cells] = line(&plain[cells], [&plain[cells - 1]].into_iter());
        [drawn, plain].map(|nodes| ground(&looked_up(&nodes)) / ground(&collided) - 1.0)
    }

    #[test]
    fn ground_under_fog_errs_as_documented() {
        let mut worst = [0.0f64; 2];
        for albedo in [0.5, 0.8, 1.0] {
            for (depth, cells) in [(0.5, 4), (1.0, 4), (2.0, 5), (3.0, 8), (4.0, 10)] {
                let errors = slab_errors(depth, albedo, cells);
                println!("albedo {albedo}, depth {depth}: {:+.4} drawn out, {:+.4} as held", errors[0], errors[1]);
                assert!((-0.006..0.016).contains(&errors[0]), "{errors:?}");
                worst = std::array::from_fn(|i| worst[i].max(errors[i].abs()));
            }
        }
        assert!(worst[1] > 2.0 * worst[0], "the border as held would do: {worst:?}");
    }
}
