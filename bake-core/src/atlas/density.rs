//! Texels per metre of each instance, from the settings.

use super::{AtlasSettings, AtlasWarning};
use crate::scene::Scene;

/// Per instance its density; `None` where it takes no lightmap. Warns of names that fit no lightmapped node.
pub(super) fn per_instance(
    scene: &Scene,
    settings: &AtlasSettings,
    warnings: &mut Vec<AtlasWarning>,
) -> Vec<Option<f64>> {
    let overrides = &settings.node_texels_per_m;
    let lightmapped = || scene.instances.iter().filter(|i| i.lightmapped);
    for node in overrides.keys().filter(|node| !lightmapped().any(|i| names(&i.path, node))) {
        warnings.push(AtlasWarning::UnknownNode { node: node.clone() });
    }
    let density = |path: &str| {
        let fitting = overrides.iter().filter(|(node, _)| names(path, node));
        // Longest name first; of equals the one that sorts last, by the map's order.
        fitting.max_by_key(|(node, _)| node.len()).map_or(settings.texels_per_m, |(_, density)| *density)
    };
    scene.instances.iter().map(|i| i.lightmapped.then(|| f64::from(density(&i.path)))).collect()
}

/// Whether `node` is a run of whole names within `path`.
fn names(path: &str, node: &str) -> bool {
    let node = node.trim_matches('/');
    !node.is_empty() && format!("/{path}/").contains(&format!("/{node}/"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Instance;
    use glam::Affine3A;

    #[test]
    fn the_longest_run_of_whole_names_wins() {
        let instance = |path: &str, lightmapped| Instance {
            path: path.into(),
            node: 0,
            mesh: 0,
            world_from_object: Affine3A::IDENTITY,
            lightmapped,
        };
        let paths = ["hall/Statue/head", "hall/Statues", "hall/lamp"];
        let mut instances: Vec<_> = paths.map(|p| instance(p, true)).into();
        instances.push(instance("grass", false));
        let scene = Scene { instances, ..Scene::default() };
        let mut settings = AtlasSettings { texels_per_m: 8.0, ..AtlasSettings::default() };
        for (node, density) in [("Statue", 64.0), ("hall", 4.0), ("hall/lamp", 2.0), ("Stat", 1.0), ("grass", 1.0)] {
            settings.node_texels_per_m.insert(node.into(), density);
        }
        let mut warnings = Vec::new();
        let densities = per_instance(&scene, &settings, &mut warnings);
        assert_eq!(densities, [Some(64.0), Some(4.0), Some(2.0), None]);
        let unknown = |node: &str| AtlasWarning::UnknownNode { node: node.into() };
        assert_eq!(warnings, [unknown("Stat"), unknown("grass")]);
    }
}
