//! The panel of `bake view` as a person uses it: entries are found by their names, clicked, and the picture beside them is judged.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use crate::bake::Desk;
use crate::person::{Display, PATIENCE, Pixels, Seen};
use crate::window::{OTHER, SAME, baked, picture};

/// Terms, lights and air of the panel are in sight without scrolling.
const SIZE: [u32; 2] = [450, 470];

const CAMERA: &str = "--camera 0.5,0.5,0.5:0.5,0.5,-0.5:60";

/// A rectangle of the window: left, top, right, bottom, pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Place([i16; 4]);

impl Place {
    fn centre(self) -> [i16; 2] {
        let Self([left, top, right, bottom]) = self;
        [(left + right) / 2, (top + bottom) / 2]
    }

    /// Where a slider is at its least.
    fn left_end(self) -> [i16; 2] {
        [self.0[0] + 1, self.centre()[1]]
    }

    fn of(self, seen: &Pixels) -> Pixels {
        let [left, top, right, bottom] = self.0.map(|at| at as usize);
        let [width, height] = seen.size.map(|side| side as usize);
        seen.columns(left..right.min(width)).rows(top..bottom.min(height))
    }
}

/// A window with its panel, and the list that it keeps of it.
struct Panel<'a> {
    window: Seen<'a>,
    list: PathBuf,
    picture: Place,
}

impl<'a> Panel<'a> {
    fn open(display: &'a Display, desk: &Desk) -> Self {
        let [width, height] = SIZE;
        let command = format!("view room.bake --size {width}x{height} {CAMERA} --widgets widgets.txt");
        let list = desk.path("widgets.txt");
        let mut window = display.open(desk.command(&command));
        window.until("a list of widgets", |seen| seen.size == SIZE && list.exists());
        let mut panel = Self { window, list, picture: Place([0; 4]) };
        panel.picture = panel.find(&["Image picture"]);
        panel
    }

    /// The first entry whose role and name begin so, below the entries that are named before it.
    fn listed(&self, path: &[&str]) -> Option<Place> {
        let list = std::fs::read_to_string(&self.list).ok()?;
        let mut lines = list.lines().filter_map(|line| {
            let mut words = line.splitn(5, ' ');
            let place = [(); 4].map(|()| words.next().and_then(|word| word.parse().ok()));
            let [Some(left), Some(top), Some(right), Some(bottom)] = place else { return None };
            Some((Place([left, top, right, bottom]), words.next()?))
        });
        path.iter()
            .try_fold(Place([0; 4]), |_, name| lines.find(|(_, entry)| entry.starts_with(name)).map(|found| found.0))
    }

    /// As [`Self::listed`], once it is there.
    #[track_caller]
    fn find(&self, path: &[&str]) -> Place {
        let begin = Instant::now();
        while begin.elapsed() < PATIENCE {
            if let Some(place) = self.listed(path) {
                return place;
            }
            std::thread::sleep(Duration::from_millis(20));
        }
        panic!("no {path:?} in\n{}", std::fs::read_to_string(&self.list).unwrap_or_default());
    }

    #[track_caller]
    fn click(&self, path: &[&str]) {
        self.window.click(self.find(path).centre());
    }

    #[track_caller]
    fn until_gone(&self, path: &[&str]) {
        let begin = Instant::now();
        while self.listed(path).is_some() {
            assert!(begin.elapsed() < PATIENCE, "{path:?} is still there");
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    /// Opens a list and clicks an entry of it.
    #[track_caller]
    fn choose(&self, list: &str, entry: &str) {
        self.click(&[list]);
        self.click(&[entry]);
        self.until_gone(&[entry]);
    }

    /// Turns a slider to its least.
    #[track_caller]
    fn turn_down(&mut self, path: &[&str], what: &str, expected: &Pixels) {
        let (slider, picture) = (self.find(path), self.picture);
        let before = self.window.look().map(|seen| picture.of(&seen)).expect("the window is looked at");
        // Pictures are coarse while something is held.
        self.window.hold_at(slider.left_end(), what, |seen| picture.of(seen).distance(&before) > OTHER);
        self.shows(what, expected);
    }

    #[track_caller]
    fn shows(&mut self, what: &str, expected: &Pixels) {
        self.until(what, |seen| seen.distance(expected) < SAME);
    }

    /// Waits until the picture beside the panel is right, and returns it.
    #[track_caller]
    fn until(&mut self, what: &str, right: impl Fn(&Pixels) -> bool) -> Pixels {
        let place = self.picture;
        place.of(&self.window.until(what, |seen| right(&place.of(seen))))
    }
}

/// Whether a picture is brighter than another, and nowhere darker by more than a step of 255.
fn brighter(this: &Pixels, than: &Pixels) -> bool {
    let mut channels = this.rgb.iter().flatten().zip(than.rgb.iter().flatten());
    this.distance(than) > OTHER && channels.all(|(this, than)| this.saturating_add(1) >= *than)
}

/// A display and a room with a lamp in haze, or a counted skip.
fn hazy_room() -> Option<(Display, Desk)> {
    baked(Desk::with_scene("fog_room_point.glb"), "sigma_t=1,albedo=0.9")
}

#[test]
fn a_person_clicks_in_the_panel_and_the_picture_turns_as_the_entries_say() {
    let Some((display, desk)) = hazy_room() else { return };
    let mut panel = Panel::open(&display, &desk);
    let Place([left, top, right, bottom]) = panel.picture;
    let size = [right - left, bottom - top].map(|side| side as u32);
    let still = picture(&desk, size, CAMERA);
    let dim = picture(&desk, size, &format!("{CAMERA} --terms indirect,single,multiple"));
    let airless = picture(&desk, size, &format!("{CAMERA} --air none"));
    assert!(still.distance(&dim) > OTHER && still.distance(&airless) > OTHER && dim.distance(&airless) > OTHER);
    panel.shows("the picture beside the panel", &still);

    // Negative control: pointed at and lit up, but not clicked, an entry changes nothing.
    let direct = panel.find(&["CheckBox direct"]);
    let unlit = panel.window.look().map(|seen| direct.of(&seen));
    panel.window.point_at(direct.centre());
    panel.window.until("the entry lit up", |seen| {
        Some(direct.of(seen)) != unlit && panel.picture.of(seen).distance(&still) < SAME
    });

    // Nor does a click on an entry that is none of the picture's.
    panel.click(&["DisclosureTriangle Compare"]);
    panel.until_gone(&["Button difference"]);
    panel.shows("the picture beside a section that is folded", &still);

    panel.click(&["CheckBox direct"]);
    panel.shows("no direct light", &dim);
    panel.click(&["CheckBox direct"]);
    panel.shows("direct light again", &still);

    panel.turn_down(&["Label medium 1", "Slider σt"], "air so thin that it is none", &airless);
    panel.click(&["Label medium 1", "Button as baked"]);
    panel.shows("the air as it was baked", &still);
    panel.choose("ComboBox method", "Button none");
    panel.shows("the air left out", &airless);
    panel.choose("ComboBox method", "Button quadrature");
    panel.shows("the air drawn again", &still);

    let lamp = "CheckBox point ";
    panel.click(&[lamp]);
    let unlit = panel.until("no light of the lamp in the air", |seen| brighter(&still, seen));
    panel.click(&[lamp]);
    panel.shows("the lamp again", &still);
    panel.turn_down(&[lamp, "Slider times"], "the lamp turned down", &unlit);
}

#[test]
fn a_lamp_that_a_person_adds_shines_is_turned_down_and_removed_by_clicks() {
    let Some((display, desk)) = hazy_room() else { return };
    let mut panel = Panel::open(&display, &desk);
    let Place([left, top, right, bottom]) = panel.picture;
    let still = picture(&desk, [right - left, bottom - top].map(|side| side as u32), CAMERA);
    panel.shows("the picture beside the panel", &still);

    panel.click(&["Button add a lamp ahead"]);
    let lit = panel.until("the lamp's light", |seen| brighter(seen, &still));
    let lamp = "CheckBox point, not baked";
    panel.click(&[lamp]);
    panel.shows("the lamp off", &still);
    panel.click(&[lamp]);
    panel.shows("the lamp on", &lit);
    panel.turn_down(&[lamp, "Slider times"], "the added lamp turned down", &still);
    panel.click(&["Button remove"]);
    // The key would take away a lamp that is still there; where there is none it adds the button's.
    panel.window.press(b'l'.into());
    panel.shows("the same lamp by its key", &lit);
}
