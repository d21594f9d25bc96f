//! Points in, light out, as comma separated text.

use super::Sampler;
use glam::Vec3;
use std::fmt::Write;

/// Names of the coordinate columns, either set.
const COORDINATES: [[&str; 6]; 2] = [["px", "py", "pz", "nx", "ny", "nz"], ["x", "y", "z", "nx", "ny", "nz"]];

/// What is wrong with a points file.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum PointsError {
    /// There is no line with column names.
    #[error("no header line; the first line that does not start with # names the columns px,py,pz,nx,ny,nz")]
    NoHeader,
    /// Coordinates are missing.
    #[error("line {line}: columns {found}; needs px,py,pz,nx,ny,nz or x,y,z,nx,ny,nz")]
    Columns {
        /// Line, from 1.
        line: usize,
        /// The header.
        found: String,
    },
    /// A cell is no number.
    #[error("line {line}, column {column}: '{value}' is no finite number")]
    Number {
        /// Line, from 1.
        line: usize,
        /// Name of the column.
        column: &'static str,
        /// The cell.
        value: String,
    },
    /// A line has more or fewer cells than the header.
    #[error("line {line}: {found} cells, the header has {expected}")]
    Cells {
        /// Line, from 1.
        line: usize,
        /// Cells found.
        found: usize,
        /// Cells in the header.
        expected: usize,
    },
}

/// Adds the sampled columns to every row of `input`; lines that begin with `#` and empty ones are left out, other columns pass through.
/// A row that no surface answers has empty cells. Returns the text and the number of such rows.
pub fn sample_csv(sampler: &Sampler, input: &str) -> Result<(String, usize), PointsError> {
    let mut lines = input.trim_start_matches('\u{feff}').lines().enumerate();
    let mut lines = lines.by_ref().filter(|(_, line)| !line.starts_with('#') && !line.trim().is_empty());
    let (line, header) = lines.next().ok_or(PointsError::NoHeader)?;
    let columns: Vec<&str> = header.split(',').map(str::trim).collect();
    let coordinates = COORDINATES
        .into_iter()
        .find_map(|names| Some((names, find_all(&columns, names)?)))
        .ok_or_else(|| PointsError::Columns { line: line + 1, found: header.to_owned() })?;
    let mut out = format!("{header},{}\n", output_columns(sampler).join(","));
    let mut unanswered = 0;
    for (line, row) in lines {
        let cells: Vec<&str> = row.split(',').map(str::trim).collect();
        if cells.len() != columns.len() {
            return Err(PointsError::Cells { line: line + 1, found: cells.len(), expected: columns.len() });
        }
        let [x, y, z, nx, ny, nz] = numbers(&cells, &coordinates, line + 1)?;
        out.push_str(row);
        unanswered += usize::from(!write_sample(&mut out, sampler, Vec3::new(x, y, z), Vec3::new(nx, ny, nz)));
        out.push('\n');
    }
    Ok((out, unanswered))
}

fn find_all(columns: &[&str], names: [&str; 6]) -> Option<[usize; 6]> {
    let found = names.map(|name| columns.iter().position(|column| *column == name));
    found.iter().all(Option::is_some).then(|| found.map(Option::unwrap_or_default))
}

fn numbers(
    cells: &[&str],
    (names, indices): &([&'static str; 6], [usize; 6]),
    line: usize,
) -> Result<[f32; 6], PointsError> {
    let mut values = [0.0; 6];
    for (value, (&column, &index)) in values.iter_mut().zip(names.iter().zip(indices)) {
        let parsed = cells[index].parse::<f32>().ok().filter(|number| number.is_finite());
        *value = parsed.ok_or_else(|| PointsError::Number { line, column, value: cells[index].to_owned() })?;
    }
    Ok(values)
}

fn output_columns(sampler: &Sampler) -> Vec<String> {
    let rgb = |name: &str| ["r", "g", "b"].map(|channel| format!("{name}_{channel}"));
    let terms = sampler.terms().iter().flat_map(|term| rgb(term.name()));
    let place = ["node", "page", "texel_x", "texel_y", "distance"].map(str::to_owned);
    rgb("E").into_iter().chain(terms).chain(rgb("var")).chain(place).collect()
}

/// Appends the cells; false when no surface answers.
fn write_sample(out: &mut String, sampler: &Sampler, point: Vec3, normal: Vec3) -> bool {
    let Some(sample) = sampler.sample(point, normal) else {
        out.extend(std::iter::repeat_n(',', output_columns(sampler).len()));
        return false;
    };
    let colors = std::iter::once(&sample.irradiance).chain(&sample.terms).chain([&sample.variance]);
    for value in colors.flat_map(|color| color.to_array()) {
        let _ = write!(out, ",{value}");
    }
    let (node, [x, y]) = (quoted(&sample.node), sample.texel);
    let _ = write!(out, ",{node},{},{x},{y},{}", sample.page, sample.distance);
    true
}

/// Quotes a name that would break the line (RFC 4180).
fn quoted(name: &str) -> String {
    if name.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", name.replace('"', "\"\"").replace(['\n', '\r'], " "))
    } else {
        name.to_owned()
    }
}
