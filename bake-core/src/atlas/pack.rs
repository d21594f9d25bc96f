//! Rectangles on pages: skyline, bottom-left (Jylänki 2010, "A thousand ways to pack the bin", section 3).

/// Size in texels.
pub(super) type Size = [u32; 2];

/// Where a rectangle came to lie.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Spot {
    /// Page.
    pub page: u32,
    /// Column of its first texel.
    pub x: u32,
    /// Row of its first texel.
    pub y: u32,
}

/// The upper outline of what lies on a page, as steps from left to right.
#[derive(Debug, Clone)]
struct Skyline {
    steps: Vec<Step>,
}

#[derive(Debug, Clone, Copy)]
struct Step {
    x: u32,
    y: u32,
    width: u32,
}

impl Skyline {
    fn new(width: u32) -> Self {
        Self { steps: vec![Step { x: 0, y: 0, width }] }
    }

    /// The place where the rectangle's far edge lies lowest; ties go left.
    fn find(&self, size: Size, bounds: Size) -> Option<(u32, u32)> {
        let mut best: Option<(u32, u32)> = None;
        for (i, step) in self.steps.iter().enumerate() {
            if step.x + size[0] > bounds[0] {
                break;
            }
            let end = step.x + size[0];
            let y = self.steps[i..].iter().take_while(|s| s.x < end).map(|s| s.y).max().unwrap_or(0);
            if y + size[1] <= bounds[1] && best.is_none_or(|(_, lowest)| y < lowest) {
                best = Some((step.x, y));
            }
        }
        best
    }

    /// Raises the outline over a placed rectangle.
    fn place(&mut self, (x, y): (u32, u32), size: Size) {
        let end = x + size[0];
        let mut steps = Vec::with_capacity(self.steps.len() + 2);
        let raised = Step { x, y: y + size[1], width: size[0] };
        steps.extend(self.steps.iter().take_while(|s| s.x < x).map(|s| Step { width: s.width.min(x - s.x), ..*s }));
        match steps.last_mut() {
            Some(last) if last.y == raised.y => last.width += raised.width,
            _ => steps.push(raised),
        }
        for s in self.steps.iter().filter(|s| s.x + s.width > end) {
            let from = s.x.max(end);
            let rest = Step { x: from, width: s.x + s.width - from, ..*s };
            match steps.last_mut() {
                Some(last) if last.y == rest.y => last.width += rest.width,
                _ => steps.push(rest),
            }
        }
        self.steps = steps;
    }
}

/// Packs rectangles on as few pages as come out, first fit, tallest first, `padding` texels between any two.
/// `None` when one is larger than a page or more than `max_pages` would be needed.
pub(super) fn pack(sizes: &[Size], padding: u32, page: Size, max_pages: u32) -> Option<Vec<Spot>> {
    let mut order: Vec<usize> = (0..sizes.len()).collect();
    order.sort_by_key(|&i| (std::cmp::Reverse(sizes[i][1]), std::cmp::Reverse(sizes[i][0]), i));
    // Padding is laid after each rectangle; the page grows by as much, so the last one needs none.
    let bounds = [page[0] + padding, page[1] + padding];
    let mut pages: Vec<Skyline> = Vec::new();
    let mut spots = vec![Spot::default(); sizes.len()];
    for i in order {
        let size = [sizes[i][0] + padding, sizes[i][1] + padding];
        let found = pages.iter().enumerate().find_map(|(n, page)| page.find(size, bounds).map(|at| (n, at)));
        let (n, at) = match found {
            Some(found) => found,
            None if (pages.len() as u32) < max_pages => {
                pages.push(Skyline::new(bounds[0]));
                (pages.len() - 1, pages[pages.len() - 1].find(size, bounds)?)
            }
            None => return None,
        };
        pages[n].place(at, size);
        spots[i] = Spot { page: n as u32, x: at.0, y: at.1 };
    }
    Some(spots)
}

/// Packs rectangles into one of small area, no side above `limit`: its size and the places.
pub(super) fn enclose(sizes: &[Size], padding: u32, limit: u32) -> Option<(Size, Vec<Spot>)> {
    let area: f64 = sizes.iter().map(|s| f64::from(s[0] + padding) * f64::from(s[1] + padding)).sum();
    let widest = sizes.iter().map(|s| s[0]).max()?;
    let square = area.sqrt().ceil() as u32;
    let extent = |spots: &[Spot], k: usize| {
        sizes.iter().zip(spots).map(|(s, at)| s[k] + if k == 0 { at.x } else { at.y }).max().unwrap_or(0)
    };
    // A few widths about the square one; the full limit last, as the best chance to fit at all.
    let widths = [1.0, 1.06, 1.15, 1.3].map(|f| ((f64::from(square) * f) as u32).max(widest).min(limit));
    widths
        .into_iter()
        .chain([limit])
        .filter_map(|width| {
            let spots = pack(sizes, padding, [width, limit], 1)?;
            Some(([extent(&spots, 0), extent(&spots, 1)], spots))
        })
        .min_by_key(|(size, _)| (u64::from(size[0]) * u64::from(size[1]), size[0].max(size[1])))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gap(a: (Size, Spot), b: (Size, Spot)) -> Option<i64> {
        if a.1.page != b.1.page {
            return None;
        }
        let axis =
            |p: u32, w: u32, q: u32, v: u32| (i64::from(q) - i64::from(p + w)).max(i64::from(p) - i64::from(q + v));
        Some(axis(a.1.x, a.0[0], b.1.x, b.0[0]).max(axis(a.1.y, a.0[1], b.1.y, b.0[1])))
    }

    fn closest(sizes: &[Size], spots: &[Spot]) -> i64 {
        let all: Vec<_> = sizes.iter().copied().zip(spots.iter().copied()).collect();
        let pairs = (0..all.len()).flat_map(|i| (0..i).map(move |j| (i, j)));
        pairs.filter_map(|(i, j)| gap(all[i], all[j])).min().unwrap_or(i64::MAX)
    }

    fn many(count: u32) -> Vec<Size> {
        (0..count).map(|i| [3 + i * 7 % 23, 2 + i * 11 % 31]).collect()
    }

    #[test]
    fn rectangles_keep_their_distance_and_stay_on_the_page() {
        for padding in [0, 1, 3] {
            let sizes = many(300);
            let spots = pack(&sizes, padding, [128, 100], u32::MAX).expect("every rectangle fits a page");
            assert_eq!(closest(&sizes, &spots), i64::from(padding), "closest pair, padding {padding}");
            for (size, at) in sizes.iter().zip(&spots) {
                assert!(at.x + size[0] <= 128 && at.y + size[1] <= 100, "{size:?} at {at:?}");
            }
        }
    }

    #[test]
    fn pages_are_well_filled() {
        let sizes = many(2000);
        let spots = pack(&sizes, 1, [256, 256], u32::MAX).expect("fits");
        let pages = spots.iter().map(|s| s.page).max().expect("some") + 1;
        let area: u32 = sizes.iter().map(|s| (s[0] + 1) * (s[1] + 1)).sum();
        let least = area.div_ceil(257 * 257);
        assert!(pages <= least + 1 + least / 8, "{pages} pages where area alone needs {least}");
    }

    #[test]
    fn what_cannot_fit_is_refused() {
        assert!(pack(&[[10, 4]], 1, [9, 9], 5).is_none());
        assert!(pack(&many(300), 1, [64, 64], 1).is_none());
        assert!(enclose(&many(300), 1, 64).is_none());
        let (size, spots) = enclose(&many(300), 1, 512).expect("fits");
        assert!(closest(&many(300), &spots) >= 1 && size[0] <= 512 && size[1] <= 512);
    }
}
