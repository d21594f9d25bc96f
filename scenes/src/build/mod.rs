//! The tools that scenes are built with: [`Patch`]es make meshes, [`Glb`] takes meshes, lights and nodes and writes the file.

mod glb;
mod lathe;
mod lightmap;
mod material;
mod patch;
mod png;
mod wall;

pub use glb::{Content, GRID_M, GRID_UV, Glb, Light, LightId, MeshId, NodeId, Place};
pub use lathe::lathe;
pub use lightmap::{GUTTER, Layout, layout};
pub use material::{Alpha, Material, MaterialId, TextureId};
pub use patch::{Patch, Vertex, cuboid, room};
pub use png::Pixels;
pub use wall::{Opening, extrude, wall};
