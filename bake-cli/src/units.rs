//! Numbers as people read them.

/// A large count: `12.3 million`.
pub fn count(value: f64) -> String {
    match value {
        v if v < 1e4 => format!("{v:.0}"),
        v if v < 1e6 => format!("{:.1} thousand", v / 1e3),
        v if v < 1e9 => format!("{:.1} million", v / 1e6),
        v => format!("{:.1} billion", v / 1e9),
    }
}

/// A size in memory or on disk.
pub fn bytes(value: u64) -> String {
    match value as f64 {
        v if v < 1e6 => format!("{:.0} kB", (v / 1e3).ceil()),
        v if v < 1e9 => format!("{:.0} MB", v / 1e6),
        v => format!("{:.2} GB", v / 1e9),
    }
}

/// A duration.
pub fn seconds(value: f64) -> String {
    match value {
        v if v < 1.0 => "under 1 s".into(),
        v if v < 120.0 => format!("{v:.0} s"),
        v if v < 7200.0 => format!("{:.0} min", v / 60.0),
        v => format!("{:.0} h", v / 3600.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_range_has_its_unit() {
        assert_eq!(
            [0.0, 9999.0, 10_000.0, 2.5e6, 7e9].map(count),
            ["0", "9999", "10.0 thousand", "2.5 million", "7.0 billion"]
        );
        assert_eq!([1, 2_000_000, 3_210_000_000].map(bytes), ["1 kB", "2 MB", "3.21 GB"]);
        assert_eq!([0.2, 90.0, 600.0, 36_000.0].map(seconds), ["under 1 s", "90 s", "10 min", "10 h"]);
    }
}
