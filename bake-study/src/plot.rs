//! A plot as SVG: lines of points over logarithmic axes, values on hovering, light and dark by the reader's choice.
//!
//! The project's other pictures are made with `plotters`, whose SVG knows neither titles for single points nor classes;
//! hovering and two colour schemes need both. Templates of `maud` escape whatever names contain.

use maud::{Markup, PreEscaped, html};

/// Width and height in user units.
const SIZE: (f64, f64) = (760.0, 400.0);
/// Left, right, top, bottom; wider at the right for long names.
const MARGIN: (f64, f64, f64, f64) = (64.0, 160.0, 14.0, 44.0);

/// Colours of lines, text and grid, in both schemes and on paper. Lines: blue, vermilion, green, purple, orange, grey of
/// Okabe and Ito's set, which colour-blind readers tell apart.
pub const STYLE: &str = "\
.plot{--ink:#222;--grid:#ddd;--back:#fff;--c0:#0072b2;--c1:#d55e00;--c2:#009e73;--c3:#9b5fc0;--c4:#b07800;--c5:#777;\
font:12px system-ui,sans-serif;max-width:100%;height:auto}\
@media (prefers-color-scheme:dark){.plot{--ink:#ddd;--grid:#444;--back:#181818;--c0:#56b4e9;--c1:#ff8a4c;--c2:#3fd0a0;--c3:#cc9fe8;--c4:#e69f00;--c5:#aaa}}\
@media print{.plot{--ink:#000;--grid:#ccc;--back:#fff;--c0:#0072b2;--c1:#d55e00;--c2:#009e73;--c3:#9b5fc0;--c4:#b07800;--c5:#777}}\
.plot rect.back{fill:var(--back)}.plot text{fill:var(--ink)}.plot .grid{stroke:var(--grid);fill:none}\
.plot .front{stroke:var(--ink);stroke-dasharray:3 3;fill:none;opacity:.7}.plot .level{stroke:var(--ink);opacity:.25;fill:none}\
.plot .line{fill:none;stroke-width:1.5}.plot circle{stroke-width:1.5}.plot circle:hover{stroke-width:5}\
.plot .s0{stroke:var(--c0);color:var(--c0)}.plot .s1{stroke:var(--c1);color:var(--c1)}.plot .s2{stroke:var(--c2);color:var(--c2)}\
.plot .s3{stroke:var(--c3);color:var(--c3)}.plot .s4{stroke:var(--c4);color:var(--c4)}.plot .s5{stroke:var(--c5);color:var(--c5)}\
.plot circle.best{fill:currentColor}.plot circle.beaten{fill:var(--back)}";

/// From the right margin's start to the names of lines.
const NAMES_AT: f64 = 64.0;

/// What a letter of a name takes at most on average, in 12 px system-ui.
const LETTER: f64 = 7.2;

/// How many colours there are.
const COLOURS: usize = 6;

/// A point.
#[derive(Debug, Clone, PartialEq)]
pub struct Mark {
    /// Position, in the axes' units; must be above 0 on logarithmic axes.
    pub at: (f64, f64),
    /// Shown on hovering.
    pub title: String,
}

/// A line of points.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// Name.
    pub name: String,
    /// Its points in their order.
    pub marks: Vec<Mark>,
}

/// A plot with logarithmic axes, or an even one across.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Plot {
    /// For readers who cannot see it.
    pub title: String,
    /// Names of the axes.
    pub axes: [&'static str; 2],
    /// Whether the axis across is even; 0 is a place on it then.
    pub even: bool,
    /// The lines.
    pub lines: Vec<Line>,
    /// The points of the Pareto front, drawn filled and joined by a dashed line.
    pub front: Vec<(f64, f64)>,
    /// Heights marked across the plot, with their labels.
    pub levels: Vec<(f64, String)>,
}

/// Where numbers lie on an axis.
struct Scale {
    /// Both ends: logarithms (base 10) unless the axis is even.
    range: [f64; 2],
    /// Their places.
    place: [f64; 2],
    even: bool,
}

impl Scale {
    fn new(values: impl Iterator<Item = f64>, place: [f64; 2]) -> Self {
        let logs = values.filter(|value| *value > 0.0 && value.is_finite()).map(f64::log10);
        let [low, high] =
            logs.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], log| [low.min(log), high.max(log)]);
        let [low, high] = if low <= high { [low, high] } else { [0.0, 0.0] };
        // Half a decade at least, and some room at the ends.
        let room = (0.5 * (0.5 - (high - low))).max(0.04 * (high - low)).max(0.03);
        Self { range: [low - room, high + room], place, even: false }
    }

    /// An even axis with room at the ends.
    fn even(values: impl Iterator<Item = f64>, place: [f64; 2]) -> Self {
        let [low, high] =
            values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| [low.min(value), high.max(value)]);
        let [low, high] = if low < high { [low, high] } else { [0.0, 1.0] };
        let room = 0.04 * (high - low);
        Self { range: [low - room, high + room], place, even: true }
    }

    fn at(&self, value: f64) -> f64 {
        let [low, high] = self.range;
        let along = if self.even { value } else { value.max(f64::MIN_POSITIVE).log10() };
        let share = (along - low) / (high - low);
        self.place[0] + share.clamp(-0.02, 1.02) * (self.place[1] - self.place[0])
    }

    /// Decades, with 2 and 5 between where there are few; on an even axis about six round numbers.
    fn ticks(&self) -> Vec<f64> {
        let [low, high] = self.range;
        if self.even {
            let decade = 10f64.powf(((high - low) / 6.0).log10().floor());
            let fitting = [1.0, 2.0, 3.0, 5.0, 10.0].into_iter().find(|step| (high - low) / (step * decade) < 8.0);
            let step = decade * fitting.unwrap_or(10.0);
            return ((low / step).ceil() as i64..=(high / step).floor() as i64).map(|i| i as f64 * step).collect();
        }
        let steps: &[f64] = if high - low > 3.0 { &[1.0] } else { &[1.0, 2.0, 5.0] };
        let decades = (low.floor() as i32)..=(high.ceil() as i32);
        let all = decades.flat_map(|decade| steps.iter().map(move |step| step * 10f64.powi(decade)));
        all.filter(|tick| (low..=high).contains(&tick.log10())).collect()
    }
}

impl Plot {
    /// The picture, complete: it can stand in a page or in a file of its own.
    pub fn svg(&self) -> Markup {
        let marks = || self.lines.iter().flat_map(|line| &line.marks);
        let (across, place) = (marks().map(|mark| mark.at.0), [MARGIN.0, SIZE.0 - MARGIN.1]);
        let x = if self.even { Scale::even(across, place) } else { Scale::new(across, place) };
        let width = self.width();
        let heights = marks().map(|mark| mark.at.1).chain(self.levels.iter().map(|level| level.0));
        let y = Scale::new(heights, [SIZE.1 - MARGIN.3, MARGIN.2]);
        html! {
            svg.plot xmlns="http://www.w3.org/2000/svg" viewBox=(format!("0 0 {width} {}", SIZE.1)) width=(width) height=(SIZE.1) role="img" aria-label=(self.title) {
                style { (PreEscaped(STYLE)) }
                rect.back width=(width) height=(SIZE.1) {}
                (self.frame(&x, &y))
                @for (height, name) in &self.levels {
                    path.level d=(format!("M{:.1} {:.1}H{:.1}", x.place[0], y.at(*height), x.place[1])) {}
                    text x=(round(x.place[1] + 4.0)) y=(round(y.at(*height) + 4.0)) { (name) }
                }
                @for (index, line) in self.lines.iter().enumerate() { (self.line(index, line, &x, &y)) }
                @if self.front.len() > 1 { path.front d=(way(self.front.iter().map(|&(s, e)| (x.at(s), y.at(e))))) {} }
            }
        }
    }

    /// With room for the longest name of a line.
    fn width(&self) -> f64 {
        let longest = self.lines.iter().map(|line| line.name.chars().count()).max().unwrap_or(0);
        SIZE.0.max((SIZE.0 - MARGIN.1 + NAMES_AT + LETTER * longest as f64).ceil())
    }

    fn frame(&self, x: &Scale, y: &Scale) -> Markup {
        let (bottom, left) = (y.place[0], x.place[0]);
        html! {
            @for tick in x.ticks() {
                path.grid d=(format!("M{:.1} {bottom:.1}V{:.1}", x.at(tick), y.place[1])) {}
                text x=(round(x.at(tick))) y=(bottom + 16.0) text-anchor="middle" { (number(tick)) }
            }
            @for tick in y.ticks() {
                path.grid d=(format!("M{left:.1} {:.1}H{:.1}", y.at(tick), x.place[1])) {}
                text x=(left - 6.0) y=(round(y.at(tick) + 4.0)) text-anchor="end" { (number(tick)) }
            }
            text x=(0.5 * (left + x.place[1])) y=(SIZE.1 - 8.0) text-anchor="middle" { (self.axes[0]) }
            text transform=(format!("translate(14 {:.0}) rotate(-90)", 0.5 * (bottom + y.place[1]))) text-anchor="middle" { (self.axes[1]) }
        }
    }

    fn line(&self, index: usize, line: &Line, x: &Scale, y: &Scale) -> Markup {
        let class = format!("s{}", index % COLOURS);
        let places = || line.marks.iter().map(|mark| (x.at(mark.at.0), y.at(mark.at.1)));
        let top = MARGIN.2 + 14.0 + 18.0 * index as f64;
        html! {
            g class=(class) {
                path.line d=(way(places())) {}
                @for (mark, (cx, cy)) in line.marks.iter().zip(places()) {
                    circle class=(if self.front.contains(&mark.at) { "best" } else { "beaten" }) cx=(round(cx)) cy=(round(cy)) r="4" { title { (mark.title) } }
                }
                path.line d=(format!("M{:.0} {top:.0}h16", SIZE.0 - MARGIN.1 + 44.0)) {}
            }
            text x=(SIZE.0 - MARGIN.1 + NAMES_AT) y=(top + 4.0) { (line.name) }
        }
    }
}

fn way(mut places: impl Iterator<Item = (f64, f64)>) -> String {
    let first = places.next().map(|(x, y)| format!("M{x:.1} {y:.1}")).unwrap_or_default();
    places.fold(first, |way, (x, y)| format!("{way}L{x:.1} {y:.1}"))
}

fn round(value: f64) -> String {
    format!("{value:.1}")
}

/// A round number in few characters.
fn number(value: f64) -> String {
    if (1e-3..1e5).contains(&value) {
        format!("{value:.5}").trim_end_matches('0').trim_end_matches('.').into()
    } else {
        format!("{value:.0e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plot() -> Plot {
        let mark = |seconds: f64, error: f64| Mark { at: (seconds, error), title: format!("{seconds} s, <{error}>") };
        let line = Line { name: "walk & more".into(), marks: vec![mark(1.0, 10.0), mark(10.0, 3.0), mark(100.0, 4.0)] };
        Plot {
            title: "t".into(),
            axes: ["s", "%"],
            lines: vec![line],
            front: vec![(1.0, 10.0), (10.0, 3.0)],
            levels: vec![(1.0, "1 %".into())],
            ..Plot::default()
        }
    }

    #[test]
    fn names_end_inside_the_picture_and_an_even_axis_has_round_numbers() {
        let mut plot = plot();
        assert_eq!(plot.width(), SIZE.0);
        plot.lines[0].name = "a name of forty letters, more or less so".into();
        let end = SIZE.0 - MARGIN.1 + NAMES_AT + LETTER * 40.0;
        assert!(
            plot.width() >= end && plot.svg().into_string().contains(&format!("viewBox=\"0 0 {} 400\"", plot.width()))
        );
        let angles = Scale::even([0.0, 45.0, 180.0].into_iter(), [0.0, 108.0]);
        assert_eq!(angles.ticks(), [0.0, 30.0, 60.0, 90.0, 120.0, 150.0, 180.0]);
        assert!((angles.at(90.0) - 54.0).abs() < 1e-9);
    }

    #[test]
    fn every_point_says_its_values_and_the_front_is_marked() {
        let svg = plot().svg().into_string();
        assert_eq!(svg.matches("<title>").count(), 3);
        assert_eq!((svg.matches("\"best\"").count(), svg.matches("\"beaten\"").count()), (2, 1));
        assert!(svg.contains("1 s, &lt;10&gt;") && svg.contains("walk &amp; more") && !svg.contains("NaN"), "{svg}");
        assert!(svg.contains("prefers-color-scheme:dark") && svg.contains("@media print"));
    }

    #[test]
    fn larger_is_further_right_and_further_up() {
        let scale = Scale::new([1.0, 100.0].into_iter(), [0.0, 100.0]);
        assert!((scale.at(10.0) - 50.0).abs() < 1e-9 && scale.at(1.0) < scale.at(2.0) && scale.at(100.0) < 100.0);
        assert!(scale.ticks().contains(&10.0));
    }

    #[test]
    fn nothing_and_zero_are_drawn_without_fault() {
        let empty = Plot::default().svg().into_string();
        let mut zero = plot();
        zero.lines[0].marks[0].at = (0.0, 0.0);
        assert!(![empty, zero.svg().into_string()].iter().any(|svg| svg.contains("NaN") || svg.contains("inf")));
    }
}
