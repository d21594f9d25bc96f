//! Which chart of the lightmap each corner belongs to.

use bake_formats::Package;
use bake_formats::baked_scene::BakedScene;
use bake_formats::sample::charts_of;

use crate::error::Result;
use crate::layout::Instance;

/// Chart numbers in the order of the page coordinates of `instances`. Corners at which two charts of a shape touch
/// without sharing an edge count for one of them.
pub fn page_charts(package: &Package, instances: &[Instance]) -> Result<Vec<u32>> {
    let file = package.baked_scene();
    let baked = BakedScene::from_bytes(&package.path(&file), &package.read(&file)?)?;
    let (mut numbers, mut next) = (Vec::new(), 0);
    for node in instances.iter().filter_map(|instance| baked.nodes.get(instance.node as usize)) {
        let Some(lightmap) = &node.lightmap else { continue };
        let geometry = &baked.geometries[node.geometry as usize];
        let first = numbers.len();
        numbers.resize(first + lightmap.uv.len(), next);
        let charts = charts_of(geometry, &lightmap.uv, &mut next);
        let triangles = geometry.primitives.iter().flat_map(|primitive| &primitive.triangles);
        for (triangle, chart) in triangles.zip(charts) {
            triangle.iter().for_each(|&corner| numbers[first + corner as usize] = chart);
        }
    }
    Ok(numbers)
}
