//! Which key does what: one list, from which keys are obeyed and the panel's help is written.

use bake_formats::Term;
use egui::Key;

use crate::look::Look;
use crate::navigator::Navigator;

/// Something that is done once when a key goes down.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Action {
    /// Ends the program.
    Close,
    /// The camera goes back to where it began.
    Home,
    /// Fly or orbit.
    ToggleMode,
    /// Writes the picture to a file.
    Save,
    /// Shows the panel, or no longer.
    TogglePanel,
    /// Shows a term of the baked light, or no longer.
    ToggleTerm(Term),
    /// Shows something else.
    NextView,
    /// Draws the air in another way.
    NextAir,
    /// Puts a lamp ahead of the camera, or takes all away.
    ToggleLamp,
    /// One side, two, or their difference.
    NextSplit,
    /// Stops brighter.
    Brighter(f32),
}

/// Keys, what they are called, and what they do.
pub const KEYS: &[(Key, &str, Action)] = &[
    (Key::O, "fly / orbit", Action::ToggleMode),
    (Key::H, "camera home", Action::Home),
    (Key::Num1, "direct light", Action::ToggleTerm(Term::Direct)),
    (Key::Num2, "indirect light", Action::ToggleTerm(Term::Indirect)),
    (Key::Num3, "single scattering", Action::ToggleTerm(Term::Single)),
    (Key::Num4, "multiple scattering", Action::ToggleTerm(Term::Multiple)),
    (Key::V, "next view", Action::NextView),
    (Key::M, "next air method", Action::NextAir),
    (Key::L, "a lamp ahead, none", Action::ToggleLamp),
    (Key::X, "one, two, difference", Action::NextSplit),
    (Key::OpenBracket, "half a stop darker", Action::Brighter(-0.5)),
    (Key::CloseBracket, "half a stop brighter", Action::Brighter(0.5)),
    (Key::P, "save the picture", Action::Save),
    (Key::Tab, "panel", Action::TogglePanel),
    (Key::Escape, "close", Action::Close),
    (Key::Q, "close", Action::Close),
];

/// Keys that walk while they are held: to the right, up, forward.
pub const WALK: &[(Key, [f32; 3])] = &[
    (Key::W, [0.0, 0.0, 1.0]),
    (Key::S, [0.0, 0.0, -1.0]),
    (Key::A, [-1.0, 0.0, 0.0]),
    (Key::D, [1.0, 0.0, 0.0]),
    (Key::E, [0.0, 1.0, 0.0]),
    (Key::C, [0.0, -1.0, 0.0]),
];

/// What a person has chosen, without window and device.
#[derive(Debug, Clone, PartialEq)]
pub struct Viewer {
    /// The camera.
    pub navigator: Navigator,
    /// What is shown.
    pub look: Look,
    /// Whether the panel is shown.
    pub panel: bool,
    /// Whether the picture is to be written to a file.
    pub save: bool,
    /// Whether the program is to end.
    pub close: bool,
}

impl Viewer {
    /// A viewer with its panel.
    pub fn new(navigator: Navigator, look: Look) -> Self {
        Self { navigator, look, panel: true, save: false, close: false }
    }

    /// Does what a key asks for.
    pub fn act(&mut self, action: Action) {
        match action {
            Action::Close => self.close = true,
            Action::Home => self.navigator.go_home(),
            Action::ToggleMode => self.navigator.toggle_mode(),
            Action::Save => self.save = true,
            Action::TogglePanel => self.panel = !self.panel,
            Action::ToggleTerm(term) => self.look.toggle_term(term),
            Action::NextView => self.look.next_view(),
            Action::NextAir => self.look.next_air(),
            Action::ToggleLamp => self.look.toggle_lamp(self.navigator.ahead()),
            Action::NextSplit => self.look.next_split(),
            Action::Brighter(stops) => {
                self.look.exposure_stops = (self.look.exposure_stops + stops).clamp(-20.0, 20.0);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::options::Options;
    use bake_runtime::Camera;
    use glam::Vec3;

    #[test]
    fn no_key_has_two_meanings() {
        let all: Vec<Key> = KEYS.iter().map(|(key, ..)| *key).chain(WALK.iter().map(|(key, _)| *key)).collect();
        for (at, key) in all.iter().enumerate() {
            assert!(!all[..at].contains(key), "{key:?}");
        }
    }

    #[test]
    fn every_key_changes_something() {
        let box_of = [Vec3::ZERO, Vec3::ONE];
        let mut start =
            Viewer::new(Navigator::new(Camera::overview(box_of[0], box_of[1]), box_of), Look::new(&Options::default()));
        start.navigator.camera.eye.x += 1.0;
        for (key, what, action) in KEYS {
            let mut viewer = start.clone();
            viewer.act(*action);
            assert_ne!(viewer, start, "{key:?}: {what}");
        }
    }
}
