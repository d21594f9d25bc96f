//! IES LM-63 photometric files (1986 to 2019), type C: candela over vertical and horizontal angles.
//!
//! Orientation: vertical angle 0 (nadir) lies along the light's travel (the node's −Z), horizontal angle 0 along the
//! node's +X, growing counter-clockwise seen along the travel's opposite. Photometric types A and B are refused.

use super::Profile;
use super::error::{Fault, Refusal};
use super::files;
use glam::Vec3;
use std::path::Path;
use std::sync::Arc;

/// Largest number of angles in one direction; goniophotometers measure a degree or half a degree.
const MAX_ANGLES: usize = 4096;

/// Candela by direction, with symmetric parts spelled out.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Photometry {
    /// Vertical angles, degrees, ascending within [0, 180].
    vertical: Vec<f32>,
    /// Horizontal angles, degrees: 0 alone when the light is round about its axis, else from 0 to 360.
    horizontal: Vec<f32>,
    /// Candela, a row of vertical angles for each horizontal one.
    candela: Vec<f32>,
}

/// Reads an IES file.
pub(super) fn read(path: &Path) -> Result<Photometry, Refusal> {
    let bytes = files::read(path).map_err(|fault| fault.in_file(path))?;
    // Luminaire names come in any code page; the numbers are ASCII.
    let text = String::from_utf8_lossy(&bytes);
    parse(&text).map_err(|(object, fault)| fault.in_file(path).object(object))
}

type Located<T> = Result<T, (String, Fault)>;

/// Parses the text of an IES file.
fn parse(text: &str) -> Located<Photometry> {
    let mut numbers = numbers_after_tilt(text)?;
    let head: Vec<f32> = numbers.take_many("the ten lamp and luminaire numbers", 10)?;
    // Ballast factor, future use (ballast-lamp photometric factor before 2002), input watts.
    let tail = numbers.take_many("ballast factor, ballast-lamp factor and input watts", 3)?;
    let scale = head[2] * tail[0] * tail[1];
    if !(scale.is_finite() && scale > 0.0) {
        let product = "candela multiplier × ballast factor × ballast-lamp factor";
        return Err((product.into(), Fault::value(scale, "above 0")));
    }
    if head[5] != 1.0 {
        let what = format!("photometry of type {}", if head[5] == 2.0 { "B" } else { "A" });
        let way_out = "convert the file to photometric type C";
        return Err(("photometric type".into(), Fault::Unsupported { what, way_out }));
    }
    let vertical_count = angle_count(head[3], "number of vertical angles")?;
    let horizontal_count = angle_count(head[4], "number of horizontal angles")?;
    let vertical = numbers.angles("vertical angles", vertical_count, 180.0)?;
    let horizontal = numbers.angles("horizontal angles", horizontal_count, 360.0)?;
    let mut candela = numbers.take_many("candela values", vertical_count * horizontal_count)?;
    for value in &mut candela {
        *value *= scale;
        if !(value.is_finite() && *value >= 0.0) {
            return Err(("candela values".into(), Fault::value(*value, "0 or more")));
        }
    }
    unfold(vertical, horizontal, candela)
}

fn angle_count(value: f32, name: &str) -> Located<usize> {
    if value.fract() == 0.0 && (1.0..=MAX_ANGLES as f32).contains(&value) {
        return Ok(value as usize);
    }
    Err((name.into(), Fault::value(value, format!("1 to {MAX_ANGLES}"))))
}

/// The numbers of a file, taken in order; line ends mean nothing.
struct Numbers<'a> {
    tokens: Box<dyn Iterator<Item = &'a str> + 'a>,
}

/// Everything after the TILT line (and the tilt table that may follow, which a bake does not use).
fn numbers_after_tilt(text: &str) -> Located<Numbers<'_>> {
    let mut rest = text;
    let tilt = loop {
        let Some((line, after)) = rest.split_once('\n') else {
            return Err((String::new(), Fault::Decode { format: "IES", reason: "it has no TILT= line".into() }));
        };
        rest = after;
        if let Some(tilt) = line.trim().strip_prefix("TILT=") {
            break tilt.trim();
        }
    };
    let separator = |c: char| c.is_whitespace() || c == ',';
    let tokens = rest.split(separator).filter(|token| !token.is_empty());
    let mut numbers = Numbers { tokens: Box::new(tokens) };
    if tilt == "INCLUDE" {
        let head = numbers.take_many("tilt table", 2)?;
        let pairs = angle_count(head[1], "number of tilt angles")?;
        numbers.take_many("tilt table", 2 * pairs)?;
    }
    Ok(numbers)
}

impl Numbers<'_> {
    fn take_many(&mut self, name: &str, count: usize) -> Located<Vec<f32>> {
        let mut values = Vec::new();
        for i in 0..count {
            let token = self.tokens.next();
            let value = token.and_then(|token| token.parse::<f32>().ok()).filter(|value| value.is_finite());
            let found = || token.map_or("absent".to_owned(), |token| format!("`{}`", files::shorten(token)));
            let place = || (format!("{name}, entry {i} of {count}"), Fault::value(found(), "a number"));
            values.push(value.ok_or_else(place)?);
        }
        Ok(values)
    }

    fn angles(&mut self, name: &str, count: usize, limit: f32) -> Located<Vec<f32>> {
        let angles = self.take_many(name, count)?;
        let ascending = angles.windows(2).all(|pair| pair[0] < pair[1]);
        if ascending && angles[0] >= 0.0 && angles[count - 1] <= limit {
            return Ok(angles);
        }
        Err((
            name.into(),
            Fault::value(format!("{} to {}", angles[0], angles[count - 1]), format!("ascending in 0 to {limit}")),
        ))
    }
}

/// Spells symmetric parts out (LM-63-2002, section 3.13): the last horizontal angle tells the symmetry, 0 round,
/// 90 in quadrants, 180 about one plane, above that none. Files from 90 to 270 are symmetric about the 90° plane.
fn unfold(vertical: Vec<f32>, horizontal: Vec<f32>, candela: Vec<f32>) -> Located<Photometry> {
    let (first, last) = (horizontal[0], horizontal[horizontal.len() - 1]);
    if horizontal.len() == 1 {
        return Ok(Photometry { vertical, horizontal: vec![0.0], candela });
    }
    let rows = candela.chunks_exact(vertical.len());
    let mut planes: Vec<(f32, Vec<f32>)> = horizontal.iter().copied().zip(rows.map(<[f32]>::to_vec)).collect();
    let known = match (first, last) {
        (0.0, 90.0) => {
            mirror(&mut planes, 180.0);
            mirror(&mut planes, 360.0);
            true
        }
        (0.0, 180.0) => {
            mirror(&mut planes, 360.0);
            true
        }
        (90.0, 270.0) => {
            // f(φ) = f(180 − φ) = f(540 − φ): the first half mirrored goes before, the second half behind.
            let fold = |full: f32, low: f32, high: f32| {
                let half = planes.iter().rev().filter(move |(angle, _)| (low..=high).contains(angle));
                half.map(move |(angle, row)| (full - angle, row.clone())).collect::<Vec<_>>()
            };
            let (mut before, mut behind) = (fold(180.0, 90.0, 180.0), fold(540.0, 180.0, 270.0));
            before.pop();
            behind.remove(0);
            planes = [before, planes, behind].concat();
            planes[0].0 == 0.0
        }
        (0.0, last) if last > 180.0 => {
            if last < 360.0 {
                let row = planes[0].1.clone();
                planes.push((360.0, row));
            }
            true
        }
        _ => false,
    };
    if !known {
        let value = format!("{first} to {last}");
        return Err(("horizontal angles".into(), Fault::value(value, "0 alone, or from 0 to 90, 180 or 360")));
    }
    let (horizontal, rows): (Vec<f32>, Vec<Vec<f32>>) = planes.into_iter().unzip();
    Ok(Photometry { vertical, horizontal, candela: rows.concat() })
}

/// Adds the planes at `full` − φ.
fn mirror(planes: &mut Vec<(f32, Vec<f32>)>, full: f32) {
    let mirrored: Vec<_> = planes.iter().rev().skip(1).map(|(angle, row)| (full - angle, row.clone())).collect();
    planes.extend(mirrored);
}

impl Photometry {
    /// The profile with its greatest intensity taken out, and that intensity, candela.
    pub fn into_profile(self, axis: Vec3, horizontal: Vec3) -> (Profile, f32) {
        let greatest = self.candela.iter().copied().fold(0.0, f32::max);
        let scale = if greatest > 0.0 { 1.0 / f64::from(greatest) } else { 0.0 };
        let radians = |angles: Vec<f32>| Arc::new(angles.into_iter().map(f32::to_radians).collect());
        let profile = Profile {
            axis,
            horizontal,
            vertical: radians(self.vertical),
            horizontal_angles: radians(self.horizontal),
            relative: Arc::new(self.candela.iter().map(|c| (f64::from(*c) * scale) as f32).collect()),
        };
        (profile, greatest)
    }
}

impl Profile {
    /// Intensity towards a unit direction of travel, relative to the greatest; linear between the measured angles and
    /// zero beyond the vertical ones. Horizontal angles turn about −`axis`, right-handed.
    pub fn relative_towards(&self, direction: Vec3) -> f32 {
        let vertical = direction.dot(self.axis).clamp(-1.0, 1.0).acos();
        let Some((row_at, row_share)) = bracket(&self.vertical, vertical) else { return 0.0 };
        let y = direction.dot(self.horizontal.cross(self.axis));
        let angle = y.atan2(direction.dot(self.horizontal)).rem_euclid(std::f32::consts::TAU);
        let (plane, share) = bracket(&self.horizontal_angles, angle).unwrap_or((0, 0.0));
        let width = self.vertical.len();
        let along = |plane: usize| {
            let row = &self.relative[plane * width..(plane + 1) * width];
            let next = row[(row_at + 1).min(width - 1)];
            row[row_at] + (next - row[row_at]) * row_share
        };
        let first = along(plane);
        if share == 0.0 { first } else { first + (along(plane + 1) - first) * share }
    }
}

/// Index of the interval that holds `x` and where in it; none outside. f32 radians may miss the ends by a rounding.
fn bracket(angles: &[f32], x: f32) -> Option<(usize, f32)> {
    const ROUNDING: f32 = 1e-6;
    let (first, last) = (*angles.first()?, *angles.last()?);
    if x < first - ROUNDING || x > last + ROUNDING {
        return None;
    }
    let at = angles.partition_point(|a| *a <= x).saturating_sub(1);
    match angles.get(at + 1) {
        Some(next) => Some((at, ((x - angles[at]) / (next - angles[at])).clamp(0.0, 1.0))),
        None => Some((at, 0.0)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f32::consts::{FRAC_PI_2, PI};

    fn file(horizontal: &str, planes: &[&str]) -> String {
        let count = horizontal.split(' ').count();
        format!(
            "IESNA:LM-63-2002\n[TEST] x\nTILT=NONE\n1 -1 2 3 {count} 1 2 0 0 0\n0.5 1 60\n0 45 90\n{horizontal}\n{}\n",
            planes.join("\n")
        )
    }

    fn profile(text: &str) -> (Profile, f32) {
        parse(text).expect("a sound file").into_profile(Vec3::NEG_Y, Vec3::X)
    }

    #[test]
    fn multiplier_and_ballast_factors_scale_candela() {
        // 2 × 0.5 × 1.
        assert_eq!(parse(&file("0", &["4 2 1"])).expect("sound").candela, [4.0, 2.0, 1.0]);
        let (profile, greatest) = profile(&file("0", &["4 2 1"]).replace("0.5 1 60", "0.5 0.25 60"));
        assert_eq!(greatest, 1.0);
        assert_eq!(*profile.relative, [1.0, 0.5, 0.25]);
    }

    #[test]
    fn symmetric_planes_are_spelled_out() {
        let horizontal = |angles: &str, rows: &[&str]| {
            let photometry = parse(&file(angles, rows)).expect("sound");
            let first: Vec<f32> = photometry.candela.chunks(3).map(|row| row[0]).collect();
            (photometry.horizontal, first)
        };
        let (a, b, c, d) = ("1 0 0", "2 0 0", "3 0 0", "4 0 0");
        assert_eq!(horizontal("0 90", &[a, b]), (vec![0., 90., 180., 270., 360.], vec![1., 2., 1., 2., 1.]));
        assert_eq!(horizontal("0 90 180", &[a, b, c]), (vec![0., 90., 180., 270., 360.], vec![1., 2., 3., 2., 1.]));
        assert_eq!(
            horizontal("0 90 180 270", &[a, b, c, d]),
            (vec![0., 90., 180., 270., 360.], vec![1., 2., 3., 4., 1.])
        );
        assert_eq!(horizontal("90 180 270", &[a, b, c]), (vec![0., 90., 180., 270., 360.], vec![2., 1., 2., 3., 2.]));
        assert!(parse(&file("0 45", &[a, b])).is_err());
        assert!(parse(&file("90 200 270", &[a, b, c])).is_err());
    }

    #[test]
    fn evaluation_meets_the_measured_directions() {
        // Planes at 0, 90, 180, 270 about −Y with angle 0 at +X: 90° right-handed about +Y is −Z.
        let (profile, _) = profile(&file("0 90 180 270", &["8 1 0", "8 2 0", "8 3 0", "8 4 0"]));
        let at = |x: f32, z: f32| profile.relative_towards(Vec3::new(x, -1.0, z).normalize()) * 8.0;
        for (got, want) in [(at(1.0, 0.0), 1.0), (at(0.0, -1.0), 2.0), (at(-1.0, 0.0), 3.0), (at(0.0, 1.0), 4.0)] {
            assert!((got - want).abs() < 1e-4, "{got} for {want}");
        }
        assert_eq!(profile.relative_towards(Vec3::NEG_Y), 1.0);
        assert_eq!(profile.relative_towards(Vec3::Y), 0.0);
        let between = Vec3::new(0.5f32.sqrt(), -1.0, -(0.5f32.sqrt())).normalize();
        assert!((profile.relative_towards(between) * 8.0 - 1.5).abs() < 1e-4);
        assert_eq!(bracket(&[0.0, FRAC_PI_2], PI), None);
    }

    #[test]
    fn damage_is_refused_by_name() {
        let good = file("0", &["4 2 1"]);
        for (text, place) in [
            (String::new(), "TILT"),
            (good.replace("4 2 1", "4 2"), "candela values, entry 2 of 3"),
            (good.replace("4 2 1", "4 x 1"), "entry 1 of 3"),
            (good.replace("4 2 1", "4 -2 1"), "0 or more"),
            (good.replace("0 45 90", "0 95 90"), "vertical angles"),
            (good.replace("0 45 90", "0 45 190"), "vertical angles"),
            (good.replace("2 3 1 1", "2 3 1 2"), "type B"),
            (good.replace("2 3 1 1", "2 1e9 1 1"), "number of vertical angles"),
            (good.replace("0.5 1 60", "0 1 60"), "ballast factor"),
        ] {
            let (object, fault) = parse(&text).expect_err(place);
            let message = format!("{object} {fault}");
            assert!(message.contains(place), "{place}: {message}");
        }
    }

    #[test]
    fn tilt_tables_are_stepped_over() {
        let text = file("0", &["4 2 1"]).replace("TILT=NONE", "TILT=INCLUDE\n1\n2\n0 90\n1 .9");
        assert_eq!(parse(&text).expect("sound").candela, [4.0, 2.0, 1.0]);
    }
}
