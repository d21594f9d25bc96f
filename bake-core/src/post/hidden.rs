//! Texels that no light could be found for, after all filling.
//!
//! Single texels may stay that touch no other of their chart: nobody sees them. An instance without a single texel of value
//! is another matter: it is turned inside out, or lies where it should not.

use crate::atlas::Atlas;
use crate::solve::buffers::{PageBuffers, Validity};

/// What stayed without value.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Hidden {
    /// Texels.
    pub texels: u64,
    /// Of those, texels of the instances below.
    pub lightless_texels: u64,
    /// Instances without a single texel of value.
    pub lightless: Vec<u32>,
}

/// Counts what stayed without value in finished pages.
pub fn hidden(atlas: &Atlas, pages: &[PageBuffers]) -> Hidden {
    let charts: u32 = atlas.placements.iter().flatten().map(|p| atlas.layouts[p.layout as usize].charts).sum();
    let mut texels = vec![[0u64; 2]; charts as usize]; // without and with a value
    for (page, buffers) in atlas.pages.iter().zip(pages) {
        for texel in &page.texels {
            let at = usize::from(texel.y) * page.width as usize + usize::from(texel.x);
            let has_value = buffers.validity[at] != Validity::Buried;
            texels[texel.chart as usize][usize::from(has_value)] += 1;
        }
    }
    let mut hidden = Hidden { texels: texels.iter().map(|[without, _]| without).sum(), ..Hidden::default() };
    for (instance, placement) in atlas.placements.iter().enumerate() {
        let Some(placement) = placement else { continue };
        let first = placement.first_chart as usize;
        let charts = &texels[first..first + atlas.layouts[placement.layout as usize].charts as usize];
        let [without, with] = charts.iter().fold([0, 0], |[a, b], [without, with]| [a + without, b + with]);
        if without > 0 && with == 0 {
            hidden.lightless_texels += without;
            hidden.lightless.push(instance as u32);
        }
    }
    hidden
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_scenes::quad_atlas;

    #[test]
    fn an_instance_is_lightless_only_as_a_whole() {
        let atlas = quad_atlas(4);
        let validity = vec![Validity::Buried; 16];
        let mut page =
            PageBuffers { width: 4, height: 4, terms: vec![], variance: vec![], samples: vec![], validity, sh1: None };
        let all = Hidden { texels: 16, lightless_texels: 16, lightless: vec![0] };
        assert_eq!(hidden(&atlas, std::slice::from_ref(&page)), all);
        page.validity[5] = Validity::Good;
        assert_eq!(hidden(&atlas, &[page]), Hidden { texels: 15, ..Hidden::default() });
    }
}
