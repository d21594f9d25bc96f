//! What stands beside the picture, and what hands do on it: widgets that turn a [`Viewer`].

mod lights;

use bake_formats::Term;
use bake_runtime::air::Haze;
use bake_runtime::palette::{self, Palette};
use bake_runtime::{Method, Show};
use egui::{PointerButton, Rect, Sense, Ui};
use glam::{DVec3, Vec2, Vec3};

use crate::keys::{KEYS, Viewer, WALK};
use crate::look::Split;
use crate::navigator::{Mode, Motion};
use crate::options::View;
use crate::stage::{Baked, Readout};

/// Width of the panel, points.
const WIDTH: f32 = 290.0;

/// A notch of the wheel, points.
const NOTCH: f32 = 50.0;

/// What the panel tells.
#[derive(Debug, Clone, Default)]
pub struct Facts {
    /// Name of the package, and of the one beside it.
    pub title: String,
    /// What draws.
    pub adapter: String,
    /// What is not drawn, in words.
    pub notes: Vec<String>,
    /// Why the air is drawn in another way than asked for.
    pub air_notes: Vec<String>,
    /// Terms that were baked, of either package.
    pub terms: Vec<Term>,
    /// What can be turned of each package.
    pub baked: Vec<Baked>,
    /// Whether there is a sky.
    pub sky: bool,
    /// Milliseconds of each pass, of the left side and of the right one where there are two.
    pub times: [Vec<(&'static str, f64)>; 2],
    /// Milliseconds of the whole picture, as the host sees it, and pixels across that share a texel.
    pub picture: (f64, u32),
    /// Luminance of the strongest colour of differences, cd/m².
    pub full_difference: Option<f32>,
    /// What lies under the cursor.
    pub readout: Option<Readout>,
    /// What happened last.
    pub status: String,
}

/// What hands did on the picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Touched {
    /// Where the picture is, points.
    pub area: Rect,
    /// How the camera was moved.
    pub motion: Motion,
    /// Where the cursor is on it, as shares of its width and height.
    pub cursor: Option<Vec2>,
    /// Whether something is held, so that more will follow.
    pub held: bool,
}

/// Panel and picture.
pub fn show(ui: &mut Ui, viewer: &mut Viewer, facts: &Facts, picture: egui::TextureId) -> Touched {
    if viewer.panel {
        let panel = egui::Panel::right("panel").resizable(false).exact_size(WIDTH);
        panel.show(ui, |ui| {
            egui::ScrollArea::vertical().auto_shrink(false).show(ui, |ui| widgets(ui, viewer, facts));
        });
    }
    // A widget that was clicked keeps no key from the camera, unless it is written into.
    if !ui.ctx().text_edit_focused() {
        ui.ctx().memory_mut(|memory| memory.focused().into_iter().for_each(|id| memory.surrender_focus(id)));
    }
    let touched = egui::CentralPanel::no_frame().show(ui, |ui| touch(ui, viewer, picture)).inner;
    // Keys come last: home is where the camera is after all.
    viewer.navigator.go(&touched.motion);
    press_keys(ui, viewer);
    touched
}

fn press_keys(ui: &Ui, viewer: &mut Viewer) {
    if ui.ctx().text_edit_focused() {
        return;
    }
    let pressed: Vec<_> =
        ui.input(|i| KEYS.iter().filter(|(key, ..)| i.key_pressed(*key)).map(|(.., action)| *action).collect());
    for action in pressed {
        viewer.act(action);
        ui.ctx().request_repaint();
    }
}

/// The picture, and the mouse on it.
fn touch(ui: &mut Ui, viewer: &mut Viewer, picture: egui::TextureId) -> Touched {
    let area = ui.available_rect_before_wrap();
    let response = ui.allocate_rect(area, Sense::click_and_drag());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::accesskit::Role::Image, true, "picture"));
    let all = Rect::from_min_max(egui::pos2(0.0, 0.0), egui::pos2(1.0, 1.0));
    ui.painter().image(picture, area, all, egui::Color32::WHITE);
    divide(ui, area, &mut viewer.look.split);
    let drag = |buttons: &[PointerButton]| {
        let held = buttons.iter().any(|button| response.dragged_by(*button));
        let by = response.drag_delta() / area.height().max(1.0);
        if held { Vec2::new(by.x, by.y) } else { Vec2::ZERO }
    };
    // All of egui is locked while its input is read: nothing may ask it again in there.
    let (turn, shift) = (drag(&[PointerButton::Primary]), drag(&[PointerButton::Secondary, PointerButton::Middle]));
    let (hovered, writes) = (response.hovered(), ui.ctx().text_edit_focused());
    let motion = ui.input(|i| Motion {
        // A key that was let go again since the last picture counts for one.
        walk: WALK
            .iter()
            .filter(|(key, _)| !writes && (i.key_down(*key) || i.key_pressed(*key)))
            .map(|(_, way)| Vec3::from(*way))
            .sum(),
        fast: i.modifiers.shift,
        seconds: i.stable_dt,
        turn,
        shift,
        wheel: if hovered { i.smooth_scroll_delta().y / NOTCH } else { 0.0 },
    });
    let held = motion.is_walking() || motion.wheel != 0.0 || ui.input(|i| i.pointer.any_down());
    let share = |at: egui::Pos2| Vec2::new((at.x - area.left()) / area.width(), (at.y - area.top()) / area.height());
    Touched { area, motion, cursor: response.hover_pos().map(share), held }
}

/// The line between two sides, which can be dragged.
fn divide(ui: &mut Ui, area: Rect, split: &mut Split) {
    let Split::Divided(share) = split else { return };
    let x = area.left() + *share * area.width();
    let grip = Rect::from_center_size(egui::pos2(x, area.center().y), egui::vec2(12.0, area.height()));
    let response = ui.interact(grip, ui.scope_id().with("divider"), Sense::drag());
    if response.hovered() || response.dragged() {
        ui.ctx().set_cursor_icon(egui::CursorIcon::ResizeHorizontal);
    }
    if let Some(at) = response.interact_pointer_pos().filter(|_| response.dragged()) {
        *share = ((at.x - area.left()) / area.width().max(1.0)).clamp(0.0, 1.0);
    }
}

fn widgets(ui: &mut Ui, viewer: &mut Viewer, facts: &Facts) {
    ui.add_space(6.0);
    ui.strong(&facts.title);
    ui.weak(&facts.adapter);
    section(ui, "Light", |ui| light(ui, viewer, facts));
    section(ui, "Lights", |ui| lights::show(ui, viewer, &facts.baked));
    section(ui, "Air", |ui| air(ui, viewer, facts));
    section(ui, "Compare", |ui| compare(ui, viewer, facts));
    section(ui, "Under the cursor", |ui| cursor(ui, facts));
    section(ui, "Camera", |ui| {
        camera(ui, viewer);
        clutter(ui, viewer);
    });
    section(ui, "Time", |ui| times(ui, facts));
    egui::CollapsingHeader::new("Keys").show(ui, keys);
    if !facts.status.is_empty() {
        ui.separator();
        ui.label(&facts.status);
    }
}

fn section(ui: &mut Ui, title: &str, content: impl FnOnce(&mut Ui)) {
    egui::CollapsingHeader::new(title).default_open(true).show(ui, content);
}

fn light(ui: &mut Ui, viewer: &mut Viewer, facts: &Facts) {
    let look = &mut viewer.look;
    ui.add(egui::Slider::new(&mut look.exposure_stops, -8.0..=8.0).text("exposure").suffix(" stops"));
    egui::ComboBox::from_label("view").selected_text(look.view.name()).show_ui(ui, |ui| {
        for view in View::ALL {
            ui.selectable_value(&mut look.view, view, view.name());
        }
    });
    if look.view == View::Show(Show::Density) {
        let octaves = palette::SEQUENTIAL.len() - 1;
        scale(ui, &palette::SEQUENTIAL, ["1".into(), "texels/m".into(), (1 << octaves).to_string()]);
    }
    ui.horizontal_wrapped(|ui| {
        for term in &facts.terms {
            let mut shown = look.terms.contains(term);
            if ui.checkbox(&mut shown, term.name()).changed() {
                look.toggle_term(*term);
            }
        }
    });
}

fn air(ui: &mut Ui, viewer: &mut Viewer, facts: &Facts) {
    methods(ui, "method", &mut viewer.look.air);
    facts.air_notes.iter().for_each(|note| drop(ui.weak(note)));
    for (side, (baked, turned)) in facts.baked.iter().zip(&mut viewer.look.turned).enumerate() {
        of_package(ui, &facts.baked, side);
        for (index, (baked, turned)) in baked.haze.iter().zip(&mut turned.haze).enumerate() {
            ui.push_id((side, index), |ui| medium(ui, index, baked, turned));
        }
    }
    if facts.baked.iter().all(|baked| baked.haze.is_empty()) {
        ui.weak("baked without air");
    } else if facts.sky {
        sky(ui, &mut viewer.look.sky_distance_m);
    }
    facts.notes.iter().for_each(|note| drop(ui.weak(note)));
}

/// Which package what follows is of, where there are two.
fn of_package(ui: &mut Ui, all: &[Baked], side: usize) {
    if all.len() > 1 {
        ui.strong(format!("{}: {}", ["left", "right"][side.min(1)], all[side].name));
    }
}

/// How far off the sky is taken to be.
fn sky(ui: &mut Ui, distance: &mut Option<u32>) {
    let mut stated = distance.is_some();
    if ui.checkbox(&mut stated, "sky at a stated distance").changed() {
        *distance = stated.then_some(100);
    }
    if let Some(distance) = distance {
        ui.add(egui::Slider::new(distance, 1..=100_000).logarithmic(true).text("m"));
    }
}

fn methods(ui: &mut Ui, label: &str, method: &mut Method) {
    egui::ComboBox::from_label(label).selected_text(method.name()).show_ui(ui, |ui| {
        for one in Method::ALL {
            ui.selectable_value(method, one, one.name());
        }
    });
}

fn medium(ui: &mut Ui, index: usize, baked: &Haze, turned: &mut Option<Haze>) {
    let mut haze = turned.unwrap_or(*baked);
    ui.horizontal(|ui| {
        ui.label(format!("medium {}", index + 1));
        if turned.is_some() && ui.small_button("as baked").clicked() {
            haze = *baked;
        }
    });
    ui.add(egui::Slider::new(&mut haze.sigma_t, 0.0..=10.0).logarithmic(true).smallest_positive(1e-4).text("σt 1/m"));
    ui.add(egui::Slider::new(&mut haze.albedo, 0.0..=1.0).text("albedo"));
    ui.add(egui::Slider::new(&mut haze.g, -0.95..=0.95).text("g"));
    *turned = (haze != *baked).then_some(haze);
}

fn compare(ui: &mut Ui, viewer: &mut Viewer, facts: &Facts) {
    let look = &mut viewer.look;
    ui.horizontal(|ui| {
        ui.selectable_value(&mut look.split, Split::Off, "one");
        for (other, name) in [(Split::Divided(0.5), "two"), (Split::Difference(0.1), "difference")] {
            let now = std::mem::discriminant(&look.split) == std::mem::discriminant(&other);
            if ui.selectable_label(now, name).clicked() && !now {
                look.split = other;
            }
        }
    });
    if look.split != Split::Off {
        methods(ui, "right method", &mut look.right_air);
    }
    if let Split::Difference(share) = &mut look.split {
        ui.add(egui::Slider::new(share, 1e-4..=1.0).logarithmic(true).text("of white"));
        let full = facts.full_difference.unwrap_or(0.0);
        scale(ui, &palette::DIVERGING, [format!("-{full:.3}"), "right - left, cd/m²".into(), format!("+{full:.3}")]);
    }
}

/// A palette with words below its ends and middle.
fn scale(ui: &mut Ui, palette: &Palette, words: [String; 3]) {
    const STEPS: usize = 64;
    let (area, _) = ui.allocate_exact_size(egui::vec2(ui.available_width() - 8.0, 14.0), Sense::hover());
    let width = area.width() / STEPS as f32;
    for step in 0..STEPS {
        let color = palette.color((step as f32 + 0.5) / STEPS as f32);
        let color = egui::Rgba::from_rgb(color.x, color.y, color.z);
        let corner = area.min + egui::vec2(step as f32 * width, 0.0);
        ui.painter().rect_filled(Rect::from_min_size(corner, egui::vec2(width + 0.5, area.height())), 0.0, color);
    }
    ui.horizontal(|ui| {
        let [low, middle, high] = words;
        ui.small(low);
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            ui.small(high);
            ui.centered_and_justified(|ui| ui.small(middle));
        });
    });
}

/// What lies under the cursor.
fn cursor(ui: &mut Ui, facts: &Facts) {
    let Some(readout) = &facts.readout else {
        ui.weak("nothing");
        return;
    };
    let row = |ui: &mut Ui, name: &str, value: String| {
        ui.label(name);
        ui.monospace(value);
        ui.end_row();
    };
    egui::Grid::new("cursor").num_columns(2).show(ui, |ui| {
        let DVec3 { x, y, z } = readout.place;
        row(ui, "place m", format!("{x:.3} {y:.3} {z:.3}"));
        ui.label("node");
        ui.add(egui::Label::new(&readout.node).truncate()).on_hover_text(&readout.node);
        ui.end_row();
        let Some((page, reading)) = &readout.lightmap else { return };
        let filled = if reading.valid { "" } else { ", filled" };
        row(ui, "texel", format!("{} {} of page {page}{filled}", reading.texel[0], reading.texel[1]));
        let light = |value: Vec3| value.to_array().map(significant).join(" ");
        row(ui, "total lx", light(reading.irradiance));
        row(ui, "± lx", light(reading.standard_error));
        reading.terms.iter().for_each(|(term, value)| row(ui, term.name(), light(*value)));
    });
}

/// Four digits that count.
fn significant(value: f32) -> String {
    let digits = (3 - value.abs().max(1e-9).log10().floor() as i32).clamp(0, 6) as usize;
    if value.abs() < 1e7 { format!("{value:.digits$}") } else { format!("{value:.3e}") }
}

fn camera(ui: &mut Ui, viewer: &mut Viewer) {
    let navigator = &mut viewer.navigator;
    ui.horizontal(|ui| {
        ui.selectable_value(&mut navigator.mode, Mode::Fly, "fly");
        ui.selectable_value(&mut navigator.mode, Mode::Orbit, "orbit");
        if ui.button("home").clicked() {
            navigator.go_home();
        }
    });
    ui.add(egui::Slider::new(&mut navigator.speed, 0.01..=100.0).logarithmic(true).text("speed m/s"));
    let mut degrees = navigator.camera.fov_y.to_degrees();
    if ui.add(egui::Slider::new(&mut degrees, 10.0..=120.0).text("height °")).changed() {
        navigator.camera.fov_y = degrees.to_radians();
    }
}

fn clutter(ui: &mut Ui, viewer: &mut Viewer) {
    let start = &mut viewer.look.prune_start_m;
    let mut thin = start.is_some();
    if ui.checkbox(&mut thin, "thin far clutter").changed() {
        *start = thin.then_some(10.0);
    }
    if let Some(start) = start {
        ui.add(egui::Slider::new(start, 0.1..=1000.0).logarithmic(true).text("from m"));
    }
}

fn times(ui: &mut Ui, facts: &Facts) {
    let (milliseconds, divisor) = facts.picture;
    let coarse = if divisor > 1 { format!(", 1/{divisor} across") } else { String::new() };
    ui.label(format!("picture {milliseconds:.1} ms{coarse}"));
    let [left, right] = &facts.times;
    if left.is_empty() && right.is_empty() {
        ui.weak("the device tells no times of passes");
    }
    let time = |side: &[(&str, f64)], pass: &str| {
        let found = side.iter().find(|(name, _)| *name == pass);
        found.map_or(String::new(), |(_, milliseconds)| format!("{milliseconds:8.2} ms"))
    };
    let only_right = right.iter().filter(|(pass, _)| left.iter().all(|(name, _)| name != pass));
    egui::Grid::new("times").show(ui, |ui| {
        for (pass, _) in left.iter().chain(only_right) {
            ui.label(*pass);
            ui.monospace(time(left, pass));
            ui.monospace(time(right, pass));
            ui.end_row();
        }
    });
}

fn keys(ui: &mut Ui) {
    egui::Grid::new("keys").show(ui, |ui| {
        let rows = [
            ("W A S D", "walk"),
            ("E C", "up, down"),
            ("Shift", "faster"),
            ("left drag", "turn"),
            ("right drag", "shift"),
            ("wheel", "speed, nearer"),
        ];
        let own = KEYS.iter().map(|(key, what, _)| (key.symbol_or_name(), *what));
        for (key, what) in rows.into_iter().chain(own) {
            ui.monospace(key);
            ui.label(what);
            ui.end_row();
        }
    });
}

#[cfg(test)]
mod tests {
    use super::significant;

    #[test]
    fn readings_keep_four_digits() {
        for (value, text) in [
            (0.0, "0.000000"),
            (0.012346, "0.01235"),
            (1.23456, "1.235"),
            (-97.531, "-97.53"),
            (123456.7, "123457"),
            (3.2e9, "3.200e9"),
        ] {
            assert_eq!(significant(value), text);
        }
    }
}
