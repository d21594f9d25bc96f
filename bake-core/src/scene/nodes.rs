//! The node hierarchy of the chosen scene, flattened: which mesh or light stands where.

use super::accessor::Accessors;
use super::document::{Document, Node, NodeExtensions};
use super::error::{Fault, Place, Refusal, lookup};
use super::files::{Allowance, shorten};
use super::options::SceneChoice;
use glam::{DAffine3, DMat4, DQuat, DVec3};

/// A node of the scene with its transform to the world.
pub(super) struct Placed<'a> {
    pub index: u32,
    pub node: &'a Node,
    /// Names from the root, `/`-separated; `node N` where there is none.
    pub path: String,
    pub world: DAffine3,
}

/// Index of the scene to load.
pub(super) fn choose(document: &Document, choice: Option<&SceneChoice>) -> Result<usize, Refusal> {
    let count = document.scenes.len();
    match choice {
        None => {
            let index = document.scene.unwrap_or(0);
            lookup(&document.scenes, "scenes", index, &Place::root("scene")).map(|_| index as usize)
        }
        Some(SceneChoice::Index(index)) if (*index as usize) < count => Ok(*index as usize),
        Some(SceneChoice::Index(index)) => Err(unknown_scene(index.to_string(), document)),
        Some(SceneChoice::Name(name)) => document
            .scenes
            .iter()
            .position(|scene| scene.name.as_ref() == Some(name))
            .ok_or_else(|| unknown_scene(format!("`{name}`"), document)),
    }
}

fn unknown_scene(chosen: String, document: &Document) -> Refusal {
    let name = |(i, s): (usize, &super::document::SceneRecord)| match &s.name {
        Some(name) => format!("{i} `{}`", shorten(name)),
        None => i.to_string(),
    };
    let names: Vec<_> = document.scenes.iter().enumerate().take(20).map(name).collect();
    Fault::value(chosen, format!("one of: {}", names.join(", "))).at(&Place::root("--scene"))
}

/// All visible nodes of a scene, parents before children, in file order; [`check_tree`] has seen the document.
pub(super) fn flatten<'a>(document: &'a Document, scene: usize, names: &Allowance) -> Result<Vec<Placed<'a>>, Refusal> {
    let mut open = Vec::new();
    for &root in document.scenes[scene].nodes.iter().rev() {
        open.push((root, String::new(), DAffine3::IDENTITY));
    }
    let mut placed: Vec<Placed> = Vec::new();
    while let Some((index, parent_path, parent)) = open.pop() {
        let node = &document.nodes[index as usize];
        if !is_visible(&node.extensions) {
            continue;
        }
        let at = Place::entry("nodes", index as usize);
        let world = parent * local(node, &at)?;
        if !world.is_finite() {
            return Err(Fault::value("not finite", "finite numbers once multiplied with its parents").at(&at));
        }
        let path = join(&parent_path, node, index);
        names.take(path.len() as u64, 1).map_err(|fault| fault.at(&at.field("name")))?;
        open.extend(node.children.iter().rev().map(|&child| (child, path.clone(), world)));
        placed.push(Placed { index, node, path, world });
    }
    Ok(placed)
}

fn is_visible(extensions: &NodeExtensions) -> bool {
    extensions.visibility.as_ref().and_then(|v| v.visible).unwrap_or(true)
}

fn join(parent: &str, node: &Node, index: u32) -> String {
    let name = node.name.clone().unwrap_or_else(|| format!("node {index}"));
    if parent.is_empty() { name } else { format!("{parent}/{name}") }
}

/// glTF 2.0, section 3.5.2: no node with two parents, no loops, scenes list roots. Checks all nodes of all scenes.
pub(super) fn check_tree(document: &Document) -> Result<(), Refusal> {
    let mut parent: Vec<Option<u32>> = vec![None; document.nodes.len()];
    for (index, node) in document.nodes.iter().enumerate() {
        let at = Place::entry("nodes", index);
        for (i, &child) in node.children.iter().enumerate() {
            lookup(&document.nodes, "nodes", child, &at.item("children", i))?;
            if parent[child as usize].replace(index as u32).is_some() {
                return Err(second_parent(child, index as u32));
            }
        }
    }
    // With one parent each, what no root reaches is a loop.
    let mut reached = vec![false; parent.len()];
    let mut open: Vec<u32> = (0..parent.len() as u32).filter(|&i| parent[i as usize].is_none()).collect();
    while let Some(index) = open.pop() {
        reached[index as usize] = true;
        open.extend(&document.nodes[index as usize].children);
    }
    if let Some(index) = reached.iter().position(|reached| !reached) {
        return Err(second_parent(index as u32, parent[index].unwrap_or_default()));
    }
    check_roots(document, &parent)
}

/// Scenes list roots, each once.
fn check_roots(document: &Document, parent: &[Option<u32>]) -> Result<(), Refusal> {
    for (index, scene) in document.scenes.iter().enumerate() {
        let place = Place::entry("scenes", index);
        let mut seen = std::collections::HashSet::new();
        for (i, &root) in scene.nodes.iter().enumerate() {
            let at = place.item("nodes", i);
            lookup(&document.nodes, "nodes", root, &at)?;
            if let Some(parent) = parent[root as usize] {
                return Err(second_parent(root, parent));
            }
            if !seen.insert(root) {
                return Err(Fault::value(root, "each node once").at(&at));
            }
        }
    }
    Ok(())
}

fn second_parent(child: u32, parent: u32) -> Refusal {
    Fault::NotATree { parent: format!("nodes[{parent}]") }.at(&Place::entry("nodes", child as usize))
}

/// The node's own transform.
fn local(node: &Node, at: &Place) -> Result<DAffine3, Refusal> {
    let check = |values: &[f64], name: &str| match values.iter().find(|v| !v.is_finite()) {
        Some(bad) => Err(Fault::value(bad, "a finite number").at(&at.field(name))),
        None => Ok(()),
    };
    if let Some(matrix) = node.matrix {
        check(&matrix, "matrix")?;
        return Ok(DAffine3::from_mat4(DMat4::from_cols_array(&matrix)));
    }
    let (t, r, s) = (
        node.translation.unwrap_or([0.0; 3]),
        node.rotation.unwrap_or([0.0, 0.0, 0.0, 1.0]),
        node.scale.unwrap_or([1.0; 3]),
    );
    check(&t, "translation")?;
    check(&r, "rotation")?;
    check(&s, "scale")?;
    let rotation = DQuat::from_array(r);
    if !(0.5..=2.0).contains(&rotation.length()) {
        return Err(Fault::value(format!("{r:?}"), "a unit quaternion").at(&at.field("rotation")));
    }
    Ok(DAffine3::from_scale_rotation_translation(s.into(), rotation.normalize(), t.into()))
}

/// Transforms of EXT_mesh_gpu_instancing, relative to the node.
pub(super) fn instance_transforms(
    placed: &Placed,
    accessors: &Accessors,
    allowance: &Allowance,
) -> Result<Option<Vec<DAffine3>>, Refusal> {
    let Some(instancing) = &placed.node.extensions.instancing else { return Ok(None) };
    let node = Place::entry("nodes", placed.index as usize);
    let at = node.field("extensions.EXT_mesh_gpu_instancing.attributes");
    let open = |name: &'static str, width: usize| -> Result<_, Refusal> {
        let Some(&index) = instancing.attributes.get(name) else { return Ok(None) };
        let view = accessors.open(index, &at.field(name))?;
        if view.width != width {
            return Err(Fault::value(format!("{} components wide", view.width), width.to_string()).at(&at.field(name)));
        }
        Ok(Some(view))
    };
    let (translation, rotation, scale) = (open("TRANSLATION", 3)?, open("ROTATION", 4)?, open("SCALE", 3)?);
    let counts = [&translation, &rotation, &scale].map(|v| v.as_ref().map(|v| v.count));
    let Some(count) = counts.iter().flatten().copied().next() else { return Ok(None) };
    if let Some(other) = counts.iter().flatten().find(|c| **c != count) {
        return Err(Fault::value(format!("{count} and {other} instances"), "equal counts").at(&at));
    }
    allowance.take(count, 128).map_err(|fault| fault.at(&at))?;
    let transform = |i: u64| {
        let vector = |view: &Option<super::accessor::View>, default: f64| {
            view.as_ref().map_or(DVec3::splat(default), |v| glam::Vec3::from(v.floats::<3>(i)).as_dvec3())
        };
        let quaternion = rotation.as_ref().map_or(DQuat::IDENTITY, |v| glam::Quat::from_array(v.floats(i)).as_dquat());
        let usable = (0.5..=2.0).contains(&quaternion.length());
        let (s, t) = (vector(&scale, 1.0), vector(&translation, 0.0));
        if !usable || !s.is_finite() || !t.is_finite() {
            let value = format!("instance {i}: translation {t}, rotation {quaternion}, scale {s}");
            return Err(Fault::value(value, "finite numbers and unit quaternions").at(&at));
        }
        Ok(DAffine3::from_scale_rotation_translation(s, quaternion.normalize(), t))
    };
    (0..count).map(transform).collect::<Result<_, _>>().map(Some)
}

#[cfg(test)]
mod tests {
    use super::super::files::Files;
    use super::*;

    fn document(json: &str) -> Document {
        serde_json::from_str(json).expect("valid JSON")
    }

    fn paths(json: &str) -> Result<Vec<String>, String> {
        let document = document(json);
        let files = Files::new(std::path::Path::new("a.gltf"), json.as_bytes());
        check_tree(&document)
            .and_then(|()| flatten(&document, 0, &files.geometry))
            .map(|nodes| nodes.into_iter().map(|n| n.path).collect())
            .map_err(|refusal| refusal.into_error(std::path::Path::new("a.gltf")).to_string())
    }

    #[test]
    fn nodes_come_in_file_order_with_their_paths() {
        let json =
            r#"{"scenes":[{"nodes":[2,0]}],"nodes":[{"name":"a","children":[1,3]},{"name":"b"},{},{"name":"c"}]}"#;
        assert_eq!(paths(json).expect("a tree"), ["node 2", "a", "a/b", "a/c"]);
    }

    #[test]
    fn transforms_multiply_from_the_root() {
        let json = r#"{"scenes":[{"nodes":[0]}],"nodes":[{"scale":[2,2,2],"children":[1]},{"translation":[1,0,0]}]}"#;
        let document = document(json);
        let files = Files::new(std::path::Path::new("a.gltf"), &[]);
        let nodes = flatten(&document, 0, &files.geometry).expect("a tree");
        assert_eq!(nodes[1].world.transform_point3(DVec3::X), DVec3::new(4.0, 0.0, 0.0));
    }

    #[test]
    fn invisible_nodes_hide_their_children() {
        let json = r#"{"scenes":[{"nodes":[0]}],"nodes":[{"children":[1],"extensions":{"KHR_node_visibility":{"visible":false}}},{}]}"#;
        assert!(paths(json).expect("a tree").is_empty());
    }

    #[test]
    fn loops_second_parents_and_strangers_are_refused_by_place() {
        for (json, place) in [
            (r#"{"scenes":[{"nodes":[0]}],"nodes":[{"children":[0]}]}"#, "nodes[0] is reached"),
            (r#"{"scenes":[{}],"nodes":[{"children":[1]},{"children":[0]}]}"#, "nodes[0] is reached"),
            (r#"{"scenes":[{"nodes":[0,1]}],"nodes":[{"children":[2]},{"children":[2]},{}]}"#, "nodes[2] is reached"),
            (r#"{"scenes":[{"nodes":[0,1]}],"nodes":[{"children":[1]},{}]}"#, "nodes[1] is reached"),
            (r#"{"scenes":[{"nodes":[0,0]}],"nodes":[{}]}"#, "scenes[0].nodes[1] is 0"),
            (r#"{"scenes":[{"nodes":[5]}],"nodes":[{}]}"#, "scenes[0].nodes[0] refers to nodes[5]"),
            (r#"{"scenes":[{"nodes":[0]}],"nodes":[{"children":[9]}]}"#, "nodes[0].children[0] refers to nodes[9]"),
            (r#"{"scenes":[{"nodes":[0]}],"nodes":[{"rotation":[0,0,0,0]}]}"#, "nodes[0].rotation is"),
            (
                r#"{"scenes":[{"nodes":[0]}],"nodes":[{"scale":[1e200,1,1],"children":[1]},{"scale":[1e200,1,1]}]}"#,
                "nodes[1] is",
            ),
        ] {
            let refusal = paths(json).expect_err(json);
            assert!(refusal.contains(place), "{json}: {refusal}");
        }
    }
}
