//! The formulas that are mapped, one file each; a file exports `map()` or `maps()`.

mod airlight;
mod chapman;
mod elementary;
mod erfcx;
mod exponential_integral;
mod henyey_greenstein;
mod legendre;
mod linear_phase;
mod medium;

use crate::map::Map;

/// All maps, in the order of the page.
pub fn all() -> Vec<Map> {
    let mut all = exponential_integral::maps();
    all.push(erfcx::map());
    all.extend(elementary::maps());
    all.push(chapman::map());
    all.extend(henyey_greenstein::maps());
    all.push(linear_phase::map());
    all.push(legendre::map());
    all.extend(medium::maps());
    all.extend(airlight::maps());
    all
}
