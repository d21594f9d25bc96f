//! What each effect cost and changed, as people read it.

use crate::plan_text::bound;
use crate::report::Measured;
use std::fmt::Write;

/// What was left out, and with `--explain` what the rest cost and changed.
pub fn text(measured: &Measured) -> String {
    let mut text = String::new();
    let mut line = |name: &str, what: &str, value: String| {
        writeln!(text, "{name:<12} {what:<31} {value}").expect("a string takes text");
    };
    for effect in &measured.left_out {
        line("left out", effect.name, format!("{:<10} {}", bound(effect.bound), effect.why));
    }
    let Some(explained) = &measured.explained else { return text };
    for stage in &explained.seconds {
        let share = 100.0 * stage.seconds / measured.seconds.max(1e-9);
        line("seconds", stage.name, format!("{:>9.2} s {share:>5.1} %", stage.seconds));
    }
    for term in &explained.terms {
        let [mean, max] = [term.mean, term.max].map(|share| 100.0 * share);
        line("term", term.term, format!("{mean:.2} % of all light, up to {max:.2} % of a texel's"));
    }
    for change in &explained.changes {
        let [mean, max, noise] = [change.mean, change.max, change.noise].map(|share| 100.0 * share);
        let value = format!("{mean:.2} % of the median on the mean, up to {max:.2} %, noise {noise:.2} %");
        line("changed by", change.effect, format!("{value}; bound {}", bound(change.bound)));
    }
    if explained.changes.is_empty() {
        line("changed by", "", "not told: too thick to be walked, or dark".into());
    }
    text
}
