//! What is looked at and how: everything but the camera that a picture depends on. Knows no window and no device.

use bake_formats::Term;
use bake_runtime::Method;
use bake_runtime::scene::PageContent;
use glam::Vec3;

use crate::options::{Compare, Options, View};
use crate::turned::{Lamp, Turned};

/// What is shown, and how.
#[derive(Debug, Clone, PartialEq)]
pub struct Look {
    /// Stops brighter (+) or darker (−) than the exposure that suits the lightmaps.
    pub exposure_stops: f32,
    /// What is shown.
    pub view: View,
    /// Terms of the baked light that are shown.
    pub terms: Vec<Term>,
    /// How the air is drawn.
    pub air: Method,
    /// Air and lights as they are turned: of the package, and of the one beside it.
    pub turned: [Turned; 2],
    /// Lamps that were not baked, on both sides.
    pub lamps: Vec<Lamp>,
    /// Distance of the sky behind air, metres; none: it is seen through the air's own extent.
    pub sky_distance_m: Option<u32>,
    /// Distance from which on clutter is thinned, metres; none: everything is drawn.
    pub prune_start_m: Option<f32>,
    /// Whether there are two sides.
    pub split: Split,
    /// How the air of the right side is drawn.
    pub right_air: Method,
}

/// Two pictures in one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Split {
    /// One picture.
    Off,
    /// Side by side; the left one has this share of the width.
    Divided(f32),
    /// How much brighter the right one is, in false colours, the strongest at this share of the brightness shown white.
    Difference(f32),
}

impl Look {
    /// What the options ask for.
    pub fn new(options: &Options) -> Self {
        let two = options.difference.map_or(Split::Divided(0.5), Split::Difference);
        let (split, right_air) = match &options.compare {
            None => (Split::Off, options.air),
            Some(Compare::Method(method)) => (two, *method),
            Some(Compare::Package(_)) => (two, options.air),
        };
        Self {
            exposure_stops: options.exposure_stops,
            view: options.show,
            terms: options.terms.clone().unwrap_or_else(|| Term::ALL.to_vec()),
            air: options.air,
            turned: Default::default(),
            lamps: Vec::new(),
            sky_distance_m: None,
            prune_start_m: options.prune_start_m,
            split,
            right_air,
        }
    }

    /// What lies on the lightmap pages.
    pub fn page_content(&self) -> PageContent {
        match self.view {
            View::Error => PageContent::RelativeError,
            View::Validity => PageContent::Validity,
            View::Show(_) => PageContent::Terms(self.terms.clone()),
        }
    }

    /// Shows a term, or no longer.
    pub fn toggle_term(&mut self, term: Term) {
        match self.terms.iter().position(|shown| *shown == term) {
            Some(at) => drop(self.terms.remove(at)),
            None => self.terms.push(term),
        }
        self.terms.sort();
    }

    /// A lamp that was not baked, or all of them away.
    pub fn toggle_lamp(&mut self, place: Vec3) {
        if self.lamps.is_empty() { self.lamps.push(Lamp::at(place)) } else { self.lamps.clear() }
    }

    /// The next of all views.
    pub fn next_view(&mut self) {
        self.view = next(&View::ALL, self.view);
    }

    /// The next way to draw the air.
    pub fn next_air(&mut self) {
        self.air = next(&Method::ALL, self.air);
    }

    /// One picture, two side by side, their difference, and one again.
    pub fn next_split(&mut self) {
        self.split = match self.split {
            Split::Off => Split::Divided(0.5),
            Split::Divided(_) => Split::Difference(0.1),
            Split::Difference(_) => Split::Off,
        };
    }

    /// The column where the right side begins, of `width`; none where sides do not stand beside each other.
    pub fn divider(&self, width: u32) -> Option<u32> {
        match self.split {
            Split::Divided(share) => Some((share.clamp(0.0, 1.0) * width as f32) as u32),
            _ => None,
        }
    }
}

/// The entry after `now`, round and round.
fn next<T: Copy + PartialEq>(all: &[T], now: T) -> T {
    let at = all.iter().position(|one| *one == now).map_or(0, |at| at + 1);
    all[at % all.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn toggled_round_a_look_is_as_it_was() {
        let start = Look::new(&Options::default());
        let mut look = start.clone();
        look.toggle_term(Term::Indirect);
        assert_eq!(look.terms, [Term::Direct, Term::Single, Term::Multiple]);
        look.next_split();
        assert_eq!((look.divider(100), start.divider(100)), (Some(50), None));
        assert_ne!(look, start);
        look.toggle_term(Term::Indirect);
        look.next_split();
        assert_eq!(look.divider(100), None);
        look.next_split();
        assert_eq!(look, start);
    }

    #[test]
    fn next_goes_through_all_and_comes_back() {
        let mut look = Look::new(&Options::default());
        let first = (look.view, look.air);
        let mut seen = vec![look.view];
        (1..View::ALL.len()).for_each(|_| {
            look.next_view();
            seen.push(look.view);
        });
        assert!(View::ALL.iter().all(|view| seen.contains(view)), "{seen:?}");
        look.next_view();
        (0..Method::ALL.len()).for_each(|_| look.next_air());
        assert_eq!((look.view, look.air), first);
    }
}
