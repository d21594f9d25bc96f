//! Where on which page each surface lies: charts, packing, and every texel's points on the surface.
//!
//! *Chart*: connected triangles laid out without overlap. *Page*: one image of packed charts. Texel (x, y) has its
//! centre at ((x + 0.5)/width, (y + 0.5)/height), row 0 at the top, as glTF's UV convention has it.

//!
//! The way: `flatten` (own TEXCOORD_1 when `own` finds it valid, else `unwrap`) → `layout` (charts on whole texels at a
//! density) → `pack` (rectangles on pages) → `raster` (exact clipping of triangles against texels) → [`build`].

mod build;
mod density;
mod flatten;
mod layout;
mod lookup;
mod own;
mod pack;
mod points;
mod raster;
mod settings;
#[cfg(test)]
pub(crate) mod shapes;
mod unwrap;

pub use build::build;
pub use lookup::Bilinear;
pub use settings::{AtlasError, AtlasSettings, AtlasWarning, OwnUvProblem};

use glam::Vec2;

/// The layout of all lightmapped instances.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Atlas {
    /// Images to fill.
    pub pages: Vec<Page>,
    /// Texture coordinates per mesh (own TEXCOORD_1, or unwrapped), shared by the mesh's instances.
    pub layouts: Vec<Layout>,
    /// One per scene instance; `None` where it takes no lightmap.
    pub placements: Vec<Option<Placement>>,
}

/// Lightmap coordinates of one mesh. Unwrapping may split vertices; triangles keep the order of the mesh.
/// Instances share a layout when they cover the same texels: a mesh placed at several sizes has several layouts.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Layout {
    /// Index of the mesh.
    pub mesh: u32,
    /// Per layout vertex, the mesh vertex that it repeats.
    pub source_vertex: Vec<u32>,
    /// Per layout vertex, its coordinate in the unit square.
    pub uv: Vec<Vec2>,
    /// Layout vertex indices per triangle of the mesh, in the mesh's order.
    pub triangles: Vec<[u32; 3]>,
    /// Chart of each triangle, counted from 0 within the mesh.
    pub chart: Vec<u32>,
    /// Number of charts.
    pub charts: u32,
}

/// Where an instance's layout lies: page coordinate = `offset + scale · uv`, in [0, 1] of the page.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placement {
    /// Index of the layout.
    pub layout: u32,
    /// Index of the page.
    pub page: u32,
    /// Corner of the rectangle nearest to the origin.
    pub offset: Vec2,
    /// Size of the rectangle.
    pub scale: Vec2,
    /// Number of the instance's first chart among all charts of the atlas.
    pub first_chart: u32,
}

/// One image of the atlas with the surface behind it.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Page {
    /// Texels across.
    pub width: u32,
    /// Texels down.
    pub height: u32,
    /// Covered texels only, in row-major order.
    pub texels: Vec<Texel>,
    /// Surface points of all texels, in texel order.
    pub points: Vec<SurfacePoint>,
}

/// A covered texel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Texel {
    /// Column.
    pub x: u16,
    /// Row.
    pub y: u16,
    /// Chart, numbered through the atlas.
    pub chart: u32,
    /// First of its surface points on the page.
    pub first_point: u32,
    /// How many it has, at least one.
    pub point_count: u32,
}

/// A place on a triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfacePoint {
    /// Index of the scene instance.
    pub instance: u32,
    /// Index of the mesh's triangle.
    pub triangle: u32,
    /// Weights of the triangle's second and third vertex.
    pub barycentric: Vec2,
    /// Share of the texel that the point stands for; a texel's weights sum to 1.
    pub weight: f32,
}

impl Page {
    /// Row-major index of a texel.
    pub fn index(&self, x: u32, y: u32) -> usize {
        y as usize * self.width as usize + x as usize
    }

    /// The surface points of a texel.
    pub fn points_of(&self, texel: &Texel) -> &[SurfacePoint] {
        &self.points[texel.first_point as usize..][..texel.point_count as usize]
    }
}
