//! Which texels a layout's triangles touch, and how much of each: exact clipping against the texel's square.

use super::Layout;
use super::pack::Size;
use glam::DVec2;

/// A corner of a clipped triangle: texel coordinates and the weights of the triangle's second and third vertex.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Corner {
    /// Texel coordinates.
    pub at: DVec2,
    /// Barycentric weights.
    pub weights: DVec2,
}

/// A convex piece of a triangle. A triangle cut by four half-planes has at most seven corners.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Polygon {
    corners: [Corner; 8],
    count: usize,
}

impl Polygon {
    /// A triangle of a layout, in the layout's texels.
    pub fn triangle(layout: &Layout, triangle: usize, size: Size) -> Self {
        let size = DVec2::new(f64::from(size[0]), f64::from(size[1]));
        let mut polygon = Self { count: 3, ..Self::default() };
        for (k, &v) in layout.triangles[triangle].iter().enumerate() {
            let weights = [DVec2::ZERO, DVec2::X, DVec2::Y][k];
            polygon.corners[k] = Corner { at: layout.uv[v as usize].as_dvec2() * size, weights };
        }
        polygon
    }

    /// Its corners in order.
    pub fn corners(&self) -> &[Corner] {
        &self.corners[..self.count]
    }

    /// Area in texels, whatever the orientation.
    pub fn area(&self) -> f64 {
        let corners = self.corners();
        let Some(first) = corners.first() else { return 0.0 };
        let twice: f64 = corners.windows(2).map(|w| (w[0].at - first.at).perp_dot(w[1].at - first.at)).sum();
        0.5 * twice.abs()
    }

    /// Barycentric weights at a place, for a triangle with area.
    pub fn weights_at(&self, place: DVec2) -> DVec2 {
        let [a, b, c] = [0, 1, 2].map(|k| self.corners[k].at);
        let (u, v, p) = (b - a, c - a, place - a);
        DVec2::new(p.perp_dot(v), u.perp_dot(p)) / u.perp_dot(v)
    }

    /// Smallest and largest coordinate along an axis.
    fn range(&self, axis: usize) -> (f64, f64) {
        let along = self.corners().iter().map(|c| c.at[axis]);
        (along.clone().fold(f64::INFINITY, f64::min), along.fold(f64::NEG_INFINITY, f64::max))
    }

    /// The part inside a half-plane (Sutherland and Hodgman 1974): `sign · coordinate ≤ sign · bound`.
    fn half(&self, axis: usize, bound: f64, sign: f64) -> Self {
        let mut out = Self::default();
        let mut push = |corner| {
            if out.count < out.corners.len() {
                out.corners[out.count] = corner;
                out.count += 1;
            }
        };
        let corners = self.corners();
        for (i, &b) in corners.iter().enumerate() {
            let a = corners[(i + corners.len() - 1) % corners.len()];
            let (da, db) = (sign * (bound - a.at[axis]), sign * (bound - b.at[axis]));
            if (da < 0.0) != (db < 0.0) {
                let s = da / (da - db);
                let mut cut = Corner { at: a.at.lerp(b.at, s), weights: a.weights.lerp(b.weights, s) };
                cut.at[axis] = bound;
                push(cut);
            }
            if db >= 0.0 {
                push(b);
            }
        }
        out
    }

    /// The part between two bounds along an axis.
    fn between(&self, axis: usize, low: f64, high: f64) -> Self {
        self.half(axis, low, -1.0).half(axis, high, 1.0)
    }

    /// The part inside texel (x, y).
    pub fn in_texel(&self, x: u32, y: u32) -> Self {
        let (x, y) = (f64::from(x), f64::from(y));
        self.between(1, y, y + 1.0).between(0, x, x + 1.0)
    }
}

/// A triangle's share of a texel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Fragment {
    /// Row-major texel of the layout's rectangle.
    pub texel: u32,
    /// Triangle.
    pub triangle: u32,
    /// Area covered, texels.
    pub area: f32,
}

/// Share of the smaller of texel and triangle below which a contact is the rounding of a shared border, not a
/// sliver: coordinates are f32 numbers of up to 2^14 texels.
const CONTACT: f64 = 1e-6;

/// All fragments of a layout drawn at `size` texels, by texel, then by triangle.
pub(super) fn fragments(layout: &Layout, size: Size) -> Vec<Fragment> {
    let mut fragments = Vec::new();
    for triangle in 0..layout.triangles.len() {
        draw(&Polygon::triangle(layout, triangle, size), triangle as u32, size, &mut fragments);
    }
    fragments.sort_by_key(|f| (f.texel, f.triangle));
    fragments
}

/// The fragments of one triangle. One without area leaves fragments of zero area along its line.
fn draw(whole: &Polygon, triangle: u32, size: Size, fragments: &mut Vec<Fragment>) {
    let area = whole.area();
    let least = CONTACT * area.min(1.0);
    for y in texels(whole.range(1), size[1]) {
        let row = whole.between(1, f64::from(y), f64::from(y) + 1.0);
        if row.count == 0 {
            continue;
        }
        for x in texels(row.range(0), size[0]) {
            let piece = row.between(0, f64::from(x), f64::from(x) + 1.0);
            let covered = piece.area();
            if piece.count > 0 && (covered > least || area < f64::from(f32::MIN_POSITIVE)) {
                fragments.push(Fragment { texel: y * size[0] + x, triangle, area: covered as f32 });
            }
        }
    }
}

/// Texels that a range of coordinates touches, inside [0, count).
fn texels((low, high): (f64, f64), count: u32) -> std::ops::Range<u32> {
    let last = f64::from(count - 1);
    let first = low.floor().clamp(0.0, last) as u32;
    let end = (high.ceil() - 1.0).clamp(f64::from(first), last) as u32 + 1;
    first..end
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec2;
    use testkit::compare::Worst;

    const SIZE: Size = [16, 16];

    fn one(corners: [Vec2; 3]) -> Layout {
        let uv = corners.iter().map(|c| *c / 16.0).collect();
        Layout { uv, triangles: vec![[0, 1, 2]], chart: vec![0], charts: 1, ..Layout::default() }
    }

    fn triangles() -> impl Iterator<Item = [Vec2; 3]> {
        let number = |i: u32, k: u32| 16.0 * sobol_burley::sample(i, k, 7);
        (0..500).map(move |i| {
            let at = |k| Vec2::new(number(i, k), number(i, k + 1));
            // Every third one is a sliver, three thousand times longer than wide.
            let (a, b, c) = (at(0), at(2), at(4));
            if i % 3 == 0 { [a, b, a.lerp(b, 0.4) + 1e-3 * (c - a)] } else { [a, b, c] }
        })
    }

    #[test]
    fn clipping_loses_no_area() {
        let mut worst = Worst::new("fragment areas against the triangle", 2e-5);
        for corners in triangles() {
            let layout = one(corners);
            let whole = Polygon::triangle(&layout, 0, SIZE).area();
            let sum: f64 = fragments(&layout, SIZE).iter().map(|f| f64::from(f.area)).sum();
            worst.relative(sum, whole, || format!("{corners:?}"));
        }
        worst.check();
    }

    #[test]
    fn every_texel_with_a_point_of_the_triangle_has_a_fragment() {
        let mut checked = 0;
        for corners in triangles() {
            let touched: Vec<u32> = fragments(&one(corners), SIZE).iter().map(|f| f.texel).collect();
            for i in 0..200 {
                let (s, t) = (sobol_burley::sample(i, 0, 3).sqrt(), sobol_burley::sample(i, 1, 3));
                let p = corners[0].lerp(corners[1].lerp(corners[2], t), s);
                let from_border = (p - p.round()).abs().min_element();
                if from_border > 1e-3 {
                    checked += 1;
                    let texel = p.y as u32 * 16 + p.x as u32;
                    assert!(touched.contains(&texel), "{p} of {corners:?}");
                }
            }
        }
        assert!(checked > 90_000, "{checked} points were clear of texel borders");
    }

    #[test]
    fn a_triangle_without_area_still_leaves_its_line() {
        let line = [Vec2::new(1.5, 2.5), Vec2::new(5.5, 2.5), Vec2::new(3.5, 2.5)];
        let texels: Vec<u32> = fragments(&one(line), SIZE).iter().map(|f| f.texel - 2 * 16).collect();
        assert_eq!(texels, [1, 2, 3, 4, 5]);
    }

    #[test]
    fn a_border_on_texel_borders_touches_no_neighbour() {
        let square = [Vec2::new(4.0, 4.0), Vec2::new(8.0, 4.0), Vec2::new(8.0, 8.0)];
        let fragments = fragments(&one(square), SIZE);
        assert_eq!(fragments.len(), 10);
        assert!(fragments.iter().all(|f| (4..8).contains(&(f.texel % 16)) && (4..8).contains(&(f.texel / 16))));
    }
}
