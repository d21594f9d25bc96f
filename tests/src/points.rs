//! Points spread evenly over the lightmapped surfaces of a package.

use bake_formats::{BakedScene, Package};
use glam::{DVec2, DVec3};

/// A point on a lightmapped triangle.
#[derive(Debug, Clone)]
pub struct Point {
    /// Path of the node.
    pub node: String,
    /// World position, metres.
    pub position: DVec3,
    /// Geometric normal of the front, unit.
    pub normal: DVec3,
    /// Edge of a texel here, metres.
    pub texel: f64,
}

/// A lightmapped triangle in world space.
struct Triangle<'a> {
    node: &'a str,
    corners: [DVec3; 3],
    normal: DVec3,
    area: f64,
    texel: f64,
}

/// `count` points, as many per area everywhere: a Hammersley set over the surfaces laid end to end.
pub fn on_surfaces(package: &Package, count: u32) -> Vec<Point> {
    let file = package.baked_scene();
    let bytes = package.read(&file).expect("the package's scene can be read");
    let scene = BakedScene::from_bytes(&package.path(&file), &bytes).expect("the package's scene is valid");
    let triangles = triangles(&scene, package);
    let total: f64 = triangles.iter().map(|triangle| triangle.area).sum();
    let (mut index, mut before) = (0, 0.0);
    let point = |i: u32| {
        let along = total * (f64::from(i) + 0.5) / f64::from(count);
        while along > before + triangles[index].area && index + 1 < triangles.len() {
            before += triangles[index].area;
            index += 1;
        }
        let within = ((along - before) / triangles[index].area).clamp(0.0, 1.0);
        triangles[index].point(within, f64::from(i.reverse_bits()) / 2f64.powi(32))
    };
    (0..count).map(point).collect()
}

fn triangles<'a>(scene: &'a BakedScene, package: &Package) -> Vec<Triangle<'a>> {
    let mut triangles = Vec::new();
    for node in &scene.nodes {
        let Some(lightmap) = &node.lightmap else { continue };
        let page = &package.manifest.pages[lightmap.page as usize];
        let size = DVec2::new(page.width.into(), page.height.into());
        let geometry = &scene.geometries[node.geometry as usize];
        for corners in geometry.primitives.iter().flat_map(|primitive| &primitive.triangles) {
            let world = |i: u32| node.world_from_object.transform_point3(geometry.positions[i as usize]).as_dvec3();
            let texel = |i: u32| lightmap.uv[i as usize].as_dvec2() * size;
            let ([a, b, c], uv) = (corners.map(world), corners.map(texel));
            let facing = f64::from(node.world_from_object.matrix3.determinant().signum());
            let cross = facing * (b - a).cross(c - a);
            let area = cross.length() / 2.0;
            let texels = (uv[1] - uv[0]).perp_dot(uv[2] - uv[0]).abs() / 2.0;
            if area > 0.0 && texels > 0.0 {
                let texel = (area / texels).sqrt();
                triangles.push(Triangle {
                    node: &node.path,
                    corners: [a, b, c],
                    normal: cross.normalize(),
                    area,
                    texel,
                });
            }
        }
    }
    triangles
}

impl Triangle<'_> {
    /// The point of the unit square's area-preserving map onto the triangle.
    fn point(&self, s: f64, t: f64) -> Point {
        let [a, b, c] = self.corners;
        let root = s.sqrt();
        let position = a + root * ((1.0 - t) * (b - a) + t * (c - a));
        Point { node: self.node.to_owned(), position, normal: self.normal, texel: self.texel }
    }
}

impl Point {
    /// Places around the point, `reach` texels away along the surface.
    pub fn around(&self, reach: f64) -> impl Iterator<Item = DVec3> + '_ {
        let u = self.normal.any_orthonormal_vector();
        let v = self.normal.cross(u);
        let step = reach * self.texel;
        (0..8).map(move |i| {
            self.position
                + step
                    * (DVec2::from_angle(f64::from(i) * std::f64::consts::FRAC_PI_4).x * u
                        + DVec2::from_angle(f64::from(i) * std::f64::consts::FRAC_PI_4).y * v)
        })
    }
}
