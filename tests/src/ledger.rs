//! The ledger of validation: every check prints what it measured and what is allowed, and leaves the same line in
//! `target/validation.tsv`, from which `ci/test --long` writes `docs/validation.md`.

use std::fs::OpenOptions;
use std::io::Write;

/// The checks of one subject, a scene or an asset.
#[derive(Debug, Clone)]
pub struct Ledger {
    group: String,
    subject: String,
}

impl Ledger {
    /// Opens the page of a subject within a group of like ones.
    pub fn new(group: &str, subject: &str) -> Self {
        Self { group: group.into(), subject: subject.into() }
    }

    /// Requires `measured ≤ allowed`.
    #[track_caller]
    pub fn at_most(&self, what: &str, measured: f64, allowed: f64) {
        self.write(what, &number(measured), &format!("≤ {}", number(allowed)));
        assert!(measured <= allowed, "{}: {what}: measured {measured:e}, allowed at most {allowed:e}", self.subject);
    }

    /// Requires `measured ≥ allowed`.
    #[track_caller]
    pub fn at_least(&self, what: &str, measured: f64, allowed: f64) {
        self.write(what, &number(measured), &format!("≥ {}", number(allowed)));
        assert!(measured >= allowed, "{}: {what}: measured {measured:e}, allowed at least {allowed:e}", self.subject);
    }

    /// Requires `measured > limit` of something wrong on purpose: the check that it breaks can fail.
    #[track_caller]
    pub fn refused(&self, what: &str, measured: f64, limit: f64) {
        self.write(&format!("wrong twin: {what}"), &number(measured), &format!("> {}", number(limit)));
        assert!(measured > limit, "{}: a wrong twin passes: {what}: {measured:e}, limit {limit:e}", self.subject);
    }

    /// Records a number that nothing is asked of.
    pub fn note(&self, what: &str, measured: f64) {
        self.write(what, &number(measured), "recorded");
    }

    fn write(&self, what: &str, measured: &str, allowed: &str) {
        let line = [&self.group, &self.subject, what, measured, allowed].join("\t");
        println!("{}", line.replace('\t', " | "));
        let path = testkit::reference::workspace().join("target/validation.tsv");
        if let Ok(mut file) = OpenOptions::new().create(true).append(true).open(path) {
            // One write, so that lines of parallel tests do not mix.
            let _ = file.write_all(format!("{line}\n").as_bytes());
        }
    }
}

/// Four significant digits.
fn number(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return value.to_string();
    }
    let magnitude = value.abs().log10().floor() as i32;
    if (-4..7).contains(&magnitude) {
        let text = format!("{value:.*}", (3 - magnitude).max(0) as usize);
        if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
    } else {
        format!("{value:.3e}")
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn numbers_are_short() {
        let shown = [0.0, 0.012_345_6, 12.5, 123_456.0, 1.5e-6, 3.2e9].map(super::number);
        assert_eq!(shown, ["0", "0.01235", "12.5", "123456", "1.500e-6", "3.200e9"]);
    }
}
