//! The list of lights: those that were baked, of each package, and those that were not.

use egui::Ui;

use super::of_package;
use crate::keys::Viewer;
use crate::stage::Baked;
use crate::turned::{Dimmer, Lamp};

pub fn show(ui: &mut Ui, viewer: &mut Viewer, baked: &[Baked]) {
    for (side, (package, turned)) in baked.iter().zip(&mut viewer.look.turned).enumerate() {
        of_package(ui, baked, side);
        for (index, ((path, kind), dimmer)) in package.lights.iter().zip(&mut turned.lights).enumerate() {
            ui.push_id((side, index), |ui| light(ui, &format!("{kind} {path}"), dimmer));
        }
    }
    if baked.iter().any(|package| !package.lights.is_empty()) {
        ui.weak("baked: their light in the air is turned; what lies on the pages stays");
    }
    lamps(ui, viewer);
}

/// Lamps that were not baked.
fn lamps(ui: &mut Ui, viewer: &mut Viewer) {
    let mut gone = None;
    for (index, lamp) in viewer.look.lamps.iter_mut().enumerate() {
        ui.push_id(("added", index), |ui| {
            light(ui, &format!("point, not baked, {:.1}", lamp.place), &mut lamp.dimmer);
            if ui.small_button("remove").clicked() {
                gone = Some(index);
            }
        });
    }
    gone.map(|index| viewer.look.lamps.remove(index));
    if ui.button("add a lamp ahead").clicked() {
        viewer.look.lamps.push(Lamp::at(viewer.navigator.ahead()));
    }
}

/// One light: whether it shines, and how bright.
fn light(ui: &mut Ui, name: &str, dimmer: &mut Dimmer) {
    ui.checkbox(&mut dimmer.on, name);
    let slider = egui::Slider::new(&mut dimmer.scale, 0.0..=100.0).logarithmic(true).smallest_positive(1e-3);
    ui.add_enabled(dimmer.on, slider.text("times"));
}
