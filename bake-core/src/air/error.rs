//! Why the air of a scene is refused: the medium, what is wrong with it, and the next step.

use super::GridFault;
use crate::settings::SettingsError;
use bake_optics::axial_table::AxialTableError;
use bake_optics::medium::mesh::MeshError;
use bake_optics::phase::PhaseError;
use glam::DVec3;
use std::path::PathBuf;
use thiserror::Error;

/// Media that cannot be used.
#[derive(Debug, Error)]
pub enum AirError {
    /// A value out of range, or extras that are no media.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// A box without content.
    #[error("medium \"{medium}\": its bounds are the scene's box, which has no volume: {} by {} by {} m; give it `bounds: Box(min: …, max: …)`, as a flag `--fog …,bounds=x0:y0:z0:x1:y1:z1`", size.x, size.y, size.z)]
    FlatScene {
        /// Name.
        medium: String,
        /// Of the scene's box, metres.
        size: DVec3,
    },
    /// A node that carries no mesh.
    #[error("medium \"{medium}\": no node `{node}` with a mesh; {hint}")]
    UnknownNode {
        /// Name.
        medium: String,
        /// As set.
        node: String,
        /// A similar name, or what to look for.
        hint: String,
    },
    /// A node whose mesh bounds nothing.
    #[error("medium \"{medium}\": the node `{node}` bounds no air: {source}; {}", mesh_help(source))]
    Mesh {
        /// Name.
        medium: String,
        /// As set.
        node: String,
        /// What is wrong with the mesh.
        source: MeshError,
    },
    /// A phase function that cannot be.
    #[error("medium \"{medium}\": {source}; correct `phase`")]
    Phase {
        /// Name.
        medium: String,
        /// What is wrong.
        source: PhaseError,
    },
    /// A series that is negative somewhere.
    #[error(
        "medium \"{medium}\": the Legendre series of `phase` is {value:.3} /sr at {angle_deg:.0}°, and no light is negative; give more terms, or a Table"
    )]
    NegativePhase {
        /// Name.
        medium: String,
        /// Lowest value, 1/sr.
        value: f64,
        /// Where, degrees.
        angle_deg: f64,
    },
    /// A file that cannot be read.
    #[error("medium \"{medium}\": cannot read {}: {source}; check the path and its permissions", file.display())]
    Unreadable {
        /// Name.
        medium: String,
        /// The file.
        file: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A grid that is none.
    #[error("medium \"{medium}\": {} {source}", file.display())]
    Grid {
        /// Name.
        medium: String,
        /// The file.
        file: PathBuf,
        /// What is wrong.
        source: GridFault,
    },
    /// A file of angles and values that is none.
    #[error("medium \"{medium}\": {}:{line}: {message}; a line holds an angle in degrees and a value", file.display())]
    TableLine {
        /// Name.
        medium: String,
        /// The file.
        file: PathBuf,
        /// Counted from 1.
        line: usize,
        /// What is wrong.
        message: String,
    },
    /// Angles and values that make no phase function.
    #[error("medium \"{medium}\": {}: {source}; angles stand in degrees from 0 to 180", file.display())]
    Table {
        /// Name.
        medium: String,
        /// The file.
        file: PathBuf,
        /// What is wrong.
        source: AxialTableError,
    },
}

fn mesh_help(error: &MeshError) -> &'static str {
    match error {
        MeshError::Open { .. } => "close the mesh (fill holes, merge corners by distance), or use Box or Sphere",
        MeshError::Turned { .. } => "let all faces look outwards (recalculate normals), or use Box or Sphere",
        MeshError::Corner { .. } | MeshError::Flat => "give it a mesh with an inside, or use Box or Sphere",
    }
}
