//! Light at the nodes on the lattice's border, drawn out from where their air lies.
//!
//! Only half a cell's air looks a border node up: its mean is the light a third of a cell inwards, and looked up as the
//! light on the border it makes light that falls towards the border too bright there. On the ground under fog of depth 0.5
//! to 4 and albedo 0.5 to 1, four cells deep and at most 0.4 mean free paths a cell, that is 0.0 to +4.0 %, drawn out −0.6 to
//! +1.5 % (one-dimensional quadrature). The first fill stays as it is: its excess makes up for what means over cells take
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
}
