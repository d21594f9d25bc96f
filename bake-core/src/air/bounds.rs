//! Regions of the world: the scene's box, and the inside of nodes, which then are no surfaces.

use super::{AirError, decimal, point};
use crate::scene::{Instance, Scene};
use crate::settings::{self, Settings, suggest};
use bake_optics::medium::Bounds;
use bake_optics::medium::mesh::ClosedMesh;
use glam::DVec3;
use std::sync::Arc;

/// Most planes of a convex node that are clipped one by one; a tree over triangles is faster beyond.
const MOST_PLANES: usize = 32;

/// What all media of a scene share.
pub struct Regions {
    /// The box around all surfaces.
    pub scene: [DVec3; 2],
    /// Keys of the nodes that are no surfaces.
    nodes: Vec<String>,
}

impl Regions {
    /// Divides the scene into surfaces and nodes that bound media.
    pub fn new(records: &[settings::Medium], scene: &Scene) -> Self {
        let key = |record: &settings::Medium| match &record.bounds {
            settings::Bounds::Node(key) => Some(key.clone()),
            _ => None,
        };
        let mut regions = Self { scene: [DVec3::ZERO; 2], nodes: records.iter().filter_map(key).collect() };
        regions.scene = scene.bounds_of(|instance| !regions.bounds_air(instance)).map(|corner| corner.as_dvec3());
        regions
    }

    fn bounds_air(&self, instance: &Instance) -> bool {
        self.nodes.iter().any(|key| Settings::key_fits(key, &instance.path))
    }

    /// Takes the nodes that bound media out of the scene.
    pub fn take_out(&self, scene: &mut Scene) {
        scene.instances.retain(|instance| !self.bounds_air(instance));
    }

    /// The region of a medium.
    pub fn resolve(&self, record: &settings::Medium, name: &str, scene: &Scene) -> Result<Bounds, AirError> {
        Ok(match &record.bounds {
            settings::Bounds::Scene => self.scene_box(name)?,
            settings::Bounds::Unbounded => Bounds::Unbounded,
            settings::Bounds::Box { min, max } => Bounds::Box { min: point(*min), max: point(*max) },
            settings::Bounds::Sphere { centre, radius } => {
                Bounds::Sphere { centre: point(*centre), radius: decimal(*radius) }
            }
            settings::Bounds::Node(key) => inside_of(key, name, scene)?,
        })
    }

    fn scene_box(&self, name: &str) -> Result<Bounds, AirError> {
        let [min, max] = self.scene;
        let size = max - min;
        match size.cmpgt(DVec3::ZERO).all() {
            true => Ok(Bounds::Box { min, max }),
            false => Err(AirError::FlatScene { medium: name.into(), size: size.max(DVec3::ZERO) }),
        }
    }
}

/// The inside of all meshes of a node and below it.
fn inside_of(key: &str, name: &str, scene: &Scene) -> Result<Bounds, AirError> {
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for instance in scene.instances.iter().filter(|instance| Settings::key_fits(key, &instance.path)) {
        let mesh = &scene.meshes[instance.mesh as usize];
        let first = positions.len() as u32;
        let world = |p: &glam::Vec3| instance.world_from_object.transform_point3(*p).as_dvec3();
        positions.extend(mesh.positions.iter().map(world));
        triangles.extend(mesh.triangles.iter().map(|corners| corners.map(|corner| corner + first)));
    }
    if triangles.is_empty() {
        let names: Vec<&str> = scene.instances.iter().flat_map(|instance| instance.path.split('/')).collect();
        let hint = match suggest(key, &names) {
            hint if hint.starts_with("did you mean") => hint,
            _ => "name a node of the scene that carries a closed mesh".into(),
        };
        return Err(AirError::UnknownNode { medium: name.into(), node: key.into(), hint });
    }
    let mesh = ClosedMesh::new(&positions, &triangles).map_err(|source| AirError::Mesh {
        medium: name.into(),
        node: key.into(),
        source,
    })?;
    Ok(match mesh.convex_planes(MOST_PLANES) {
        Some(planes) => Bounds::Hull(planes.into()),
        None => Bounds::Mesh(Arc::new(mesh)),
    })
}
