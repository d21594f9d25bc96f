//! What is done to finished buffers. First [`adopt`] and [`dilate`] give values to texels that look-ups read but no sample
//! reached, then [`stitch`] makes the two sides of each cut agree; [`seam_score`] measures how well they do.

mod adopt;
mod dilate;
mod hidden;
mod score;
mod seams;
mod stitch;

pub use adopt::adopt;
pub use dilate::dilate;
pub use hidden::{Hidden, hidden};
pub use score::{SeamScore, seam_score};
pub use seams::{Seam, SeamSide, find_seams};
pub use stitch::stitch;

#[cfg(test)]
mod tests;
