//! The list of what the window shows, in a file: for programs that use the window as a person would.

use std::collections::HashMap;
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::PathBuf;

use bake_formats::FormatError;
use bake_formats::package::write_atomic;
use egui::accesskit::{Node, NodeId, Role, TreeUpdate};

/// A file that holds the list as it was shown last: a line for each widget, from the top and from the left,
/// `LEFT TOP RIGHT BOTTOM ROLE NAME`, in pixels of the window; role and name as assistive programs are told.
#[derive(Debug)]
pub struct WidgetFile {
    path: PathBuf,
    written: String,
}

impl WidgetFile {
    /// One that is not yet written.
    pub fn new(path: PathBuf) -> Self {
        Self { path, written: String::new() }
    }

    /// Writes the list if it is another than before.
    pub fn keep(&mut self, shown: &TreeUpdate, pixels_per_point: f32) -> Result<(), FormatError> {
        let list = list(shown, pixels_per_point.into());
        if list != self.written {
            write_atomic(&self.path, |out| out.write_all(list.as_bytes()))?;
            self.written = list;
        }
        Ok(())
    }
}

fn list(shown: &TreeUpdate, pixels_per_point: f64) -> String {
    let nodes: HashMap<NodeId, &Node> = shown.nodes.iter().map(|(id, node)| (*id, node)).collect();
    // Runs are the lines of labels.
    let whole = nodes.values().filter(|node| node.role() != Role::TextRun);
    let mut rows: Vec<_> = whole.filter_map(|node| row(node, &nodes, pixels_per_point)).collect();
    rows.sort_by_key(|([left, top, ..], role, _)| (*top, *left, *role as u8));
    rows.iter().fold(String::new(), |mut list, ([left, top, right, bottom], role, name)| {
        let _ = writeln!(list, "{left} {top} {right} {bottom} {role:?} {name}");
        list
    })
}

/// Left, top, right, bottom, role and name; none of what has no place or no name.
fn row(node: &Node, nodes: &HashMap<NodeId, &Node>, pixels_per_point: f64) -> Option<([i64; 4], Role, String)> {
    let beside = || node.labelled_by().iter().find_map(|label| nodes.get(label)?.value());
    let name = node.label().or_else(beside).or(node.value())?;
    let name = name.split_whitespace().collect::<Vec<_>>().join(" ");
    let place = node.bounds().map(|at| [at.x0, at.y0, at.x1, at.y1])?;
    Some((place.map(|at| (at * pixels_per_point).round() as i64), node.role(), name))
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::{Context, RawInput, ViewportInfo, pos2, vec2};

    /// A slider, and beside it a box to tick that is named over two lines.
    fn shown(pixels_per_point: f32) -> TreeUpdate {
        let context = Context::default();
        context.enable_accesskit();
        let screen = egui::Rect::from_min_size(pos2(0.0, 0.0), vec2(400.0, 300.0));
        let mut input = RawInput { screen_rect: Some(screen), ..RawInput::default() };
        let viewport = ViewportInfo { native_pixels_per_point: Some(pixels_per_point), ..ViewportInfo::default() };
        input.viewports.insert(input.viewport_id, viewport);
        let mut output = context.run_ui(input, |ui| {
            let mut place = |left: f32, widget: &mut dyn FnMut(&mut egui::Ui)| {
                let place = egui::Rect::from_min_size(pos2(left, 50.0), vec2(100.0, 20.0));
                ui.scope_builder(egui::UiBuilder::new().max_rect(place), |ui| widget(ui));
            };
            place(200.0, &mut |ui| drop(ui.checkbox(&mut true, "two\nlines")));
            place(10.0, &mut |ui| drop(ui.add(egui::Slider::new(&mut 0.0, 0.0..=1.0).show_value(false).text("times"))));
        });
        output.textures_delta.clear();
        output.platform_output.accesskit_update.expect("it was enabled")
    }

    #[test]
    fn widgets_are_listed_from_the_left_in_pixels() {
        let list = list(&shown(2.0), 2.0);
        let lines: Vec<Vec<&str>> = list.lines().map(|line| line.splitn(6, ' ').collect()).collect();
        let names: Vec<[&str; 2]> = lines.iter().map(|line| [line[4], line[5]]).collect();
        assert_eq!(names, [["Slider", "times"], ["CheckBox", "two lines"], ["Label", "times"]], "{list}");
        let left = |line: usize| lines[line][0].parse::<i64>().expect("a number");
        assert_eq!((left(0), left(1)), (20, 400), "{list}");
    }

    #[test]
    fn a_file_is_written_anew_only_where_the_list_changed() {
        let folder = std::env::temp_dir().join(format!("bake-view-widgets-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a temporary folder");
        let path = folder.join("widgets.txt");
        let mut file = WidgetFile::new(path.clone());
        let shown = shown(1.0);
        file.keep(&shown, 1.0).expect("written");
        std::fs::remove_file(&path).expect("it was written");
        file.keep(&shown, 1.0).expect("nothing to write");
        assert!(!path.exists());
        file.keep(&shown, 2.0).expect("written");
        assert!(path.exists());
        std::fs::remove_dir_all(&folder).expect("removed");
        assert!(matches!(file.keep(&shown, 1.0), Err(FormatError::Io { .. })));
    }
}
