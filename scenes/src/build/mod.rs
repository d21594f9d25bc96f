//! The tools that scenes are built with: [`Patch`]es make meshes; [`Glb`] takes meshes, lights and nodes and writes the
//! file.

mod arrays;
mod glb;
mod lathe;
mod lightmap;
mod material;
mod node;
mod patch;
mod png;
mod wall;

pub use arrays::{GRID_M, GRID_UV};
pub use glb::{Glb, NodeId};
pub use lathe::lathe;
pub use lightmap::{GUTTER, Layout, layout};
pub use material::{Alpha, Material, MaterialId, TextureId};
pub use node::{Content, Light, LightId, MeshId, Place};
pub use patch::{Patch, Vertex, cuboid, room};
pub use png::Pixels;
pub use wall::{Opening, extrude, wall};
