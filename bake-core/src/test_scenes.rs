//! Small scenes built in memory for this crate's tests.

use crate::atlas::{Atlas, Layout, Page, Placement, SurfacePoint, Texel};
use crate::scene::{Instance, Light, LightKind, Material, Mesh, Primitive, Scene};
use glam::{Affine3A, Vec2, Vec3, Vec4};

/// A mesh from a list of corners and triangles, one material, flat normals by triangle vertex where `normals` is empty.
pub fn mesh(positions: Vec<Vec3>, normals: Vec<Vec3>, triangles: Vec<[u32; 3]>, material: u32) -> Mesh {
    let count = positions.len();
    let primitive = Primitive { triangles: 0..triangles.len() as u32, vertices: 0..count as u32, material };
    Mesh {
        name: "test".into(),
        normals: if normals.is_empty() { vec![Vec3::Y; count] } else { normals },
        texcoords: std::array::from_fn(|_| vec![Vec2::ZERO; count]),
        colors: vec![Vec4::ONE; count],
        positions,
        triangles,
        primitives: vec![primitive],
        has_texcoord_1: false,
    }
}

/// A parallelogram: corner, two edges; its front looks along `u × v`.
pub fn quad(corner: Vec3, u: Vec3, v: Vec3, material: u32) -> Mesh {
    let normal = u.cross(v).normalize();
    let corners = vec![corner, corner + u, corner + u + v, corner + v];
    mesh(corners, vec![normal; 4], vec![[0, 1, 2], [0, 2, 3]], material)
}

/// The inside (or outside) of a box, as one mesh with shared corners.
pub fn closed_box(min: Vec3, max: Vec3, inward: bool, material: u32) -> Mesh {
    let corner =
        |i: usize| Vec3::from_array(std::array::from_fn(|axis| if i >> axis & 1 == 1 { max[axis] } else { min[axis] }));
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let mut triangles = Vec::new();
    for [a, b, c, d] in faces {
        for [p, q, r] in [[a, b, c], [a, c, d]] {
            triangles.push(if inward { [p, r, q] } else { [p, q, r] });
        }
    }
    mesh((0..8).map(corner).collect(), vec![Vec3::ZERO; 8], triangles, material)
}

/// A Lambertian material.
pub fn matte(albedo: f32) -> Material {
    Material { base_color: Vec3::splat(albedo).extend(1.0), ..Material::default() }
}

/// A scene of meshes placed once, unmoved.
pub fn scene(meshes: Vec<Mesh>, materials: Vec<Material>) -> Scene {
    let instances = (0..meshes.len() as u32).map(|mesh| instance(mesh, Affine3A::IDENTITY)).collect();
    Scene { name: "test".into(), meshes, instances, materials, ..Scene::default() }
}

/// A placement.
pub fn instance(mesh: u32, world_from_object: Affine3A) -> Instance {
    Instance { path: format!("node {mesh}"), node: mesh, mesh, world_from_object, lightmapped: true }
}

/// A point light of 1 mm.
pub fn point_light(position: Vec3, intensity: f32) -> Light {
    let kind = LightKind::Point { position, radius: 1e-3, range: None, profile: None };
    Light { path: "lamp".into(), color: Vec3::splat(intensity), kind }
}

/// An atlas with one page of `size`² texels on the first quad (triangles 0 and 1) of instance 0, a point at each centre.
pub fn quad_atlas(size: u32) -> Atlas {
    let mut page = Page { width: size, height: size, ..Page::default() };
    for y in 0..size {
        for x in 0..size {
            let (s, t) = ((x as f32 + 0.5) / size as f32, (y as f32 + 0.5) / size as f32);
            // quad corners 0, u, u+v, v: triangle 0 holds s ≥ t, triangle 1 the rest
            let (triangle, barycentric) = if s >= t { (0, Vec2::new(s - t, t)) } else { (1, Vec2::new(s, t - s)) };
            let first_point = page.points.len() as u32;
            page.points.push(SurfacePoint { instance: 0, triangle, barycentric, weight: 1.0 });
            page.texels.push(Texel { x: x as u16, y: y as u16, chart: 0, first_point, point_count: 1 });
        }
    }
    let layout = Layout { mesh: 0, charts: 1, ..Layout::default() };
    let placement = Placement { layout: 0, page: 0, offset: Vec2::ZERO, scale: Vec2::ONE, first_chart: 0 };
    Atlas { pages: vec![page], layouts: vec![layout], placements: vec![Some(placement)] }
}
