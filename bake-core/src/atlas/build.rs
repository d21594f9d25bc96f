//! From the scene to the atlas: choose coordinates and densities, place rectangles, cover texels.

use super::flatten::{self, FlatMesh, Shape, Source};
use super::layout::{self, Arrangement, Islands};
use super::pack::{self, Size, Spot};
use super::points::{self, Coverage};
use super::raster::{self, Fragment};
use super::unwrap::UnwrapReport;
use super::{
    Atlas, AtlasError, AtlasSettings, AtlasWarning, Layout, OwnUvProblem, Page, Placement, SurfacePoint, Texel,
};
use super::{density, own};
use crate::scene::Scene;
use glam::Vec2;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};
use std::time::{Duration, Instant};

/// Lays out all lightmapped instances of a scene.
///
/// Meshes keep their TEXCOORD_1 where it is a lightmap UV set: inside [0, 1], with area wherever the surface has
/// some, and less than 2 % of the covered texels shared by several triangles' areas or charts at the density chosen.
/// Others are unwrapped. Pages are cropped to what they hold, rounded up to 4 texels.
///
/// The result depends on scene and settings only, not on the number of threads (but see
/// [`AtlasSettings::unwrap_seconds`]).
///
/// # Errors
/// A setting out of range, or more charts than `max_pages` pages can hold at any density.
pub fn build(scene: &Scene, settings: &AtlasSettings) -> Result<(Atlas, Vec<AtlasWarning>), AtlasError> {
    settings.check()?;
    let mut warnings = Vec::new();
    let densities = density::per_instance(scene, settings, &mut warnings);
    let mut plan = Plan::new(scene, settings, densities);
    let (placed, shared) = loop {
        plan.flatten();
        let placed = plan.place()?;
        let shared = plan.shared_texels(&placed);
        // Unwrapping some meshes changes densities under max_pages, hence the overlap of the others: judge again.
        if !plan.unwrap_overlapping(&shared) {
            break (placed, shared);
        }
    };
    plan.warn(&placed, &shared, &mut warnings);
    Ok((plan.atlas(&placed), warnings))
}

/// One flattening: mesh, key of the shape, source of the coordinates.
type FlatKey = (u32, [i32; 6], bool);
/// One layout: flattening and density (bits of an f32: texels per metre of the shape).
type LayoutKey = (FlatKey, u32);

/// What is known before anything has a place.
struct Plan<'a> {
    scene: &'a Scene,
    settings: &'a AtlasSettings,
    /// Texels per metre, per instance; `None` without a lightmap.
    densities: Vec<Option<f64>>,
    shapes: Vec<Shape>,
    sources: BTreeMap<u32, (Source, Option<OwnUvProblem>)>,
    flats: BTreeMap<FlatKey, Flattened>,
    deadline: Option<Instant>,
}

struct Flattened {
    flat: FlatMesh,
    islands: Islands,
    report: UnwrapReport,
}

/// Rectangles with places.
struct Placed {
    /// Factor on all densities.
    factor: f64,
    layouts: BTreeMap<LayoutKey, LaidOut>,
    /// Per lightmapped instance, in order.
    spots: Vec<Spot>,
}

struct LaidOut {
    /// Number among the atlas's layouts.
    index: u32,
    /// Texels per metre of the shape, reached.
    density: f64,
    arrangement: Arrangement,
}

impl<'a> Plan<'a> {
    fn new(scene: &'a Scene, settings: &'a AtlasSettings, densities: Vec<Option<f64>>) -> Self {
        let lightmapped = scene.instances.iter().zip(&densities).filter(|(_, d)| d.is_some());
        let meshes: BTreeSet<u32> = lightmapped.map(|(instance, _)| instance.mesh).collect();
        let sources = meshes.into_par_iter().map(|m| (m, flatten::source_of(&scene.meshes[m as usize]))).collect();
        let shapes = scene.instances.iter().map(Shape::of).collect();
        let limit = Duration::try_from_secs_f64(settings.unwrap_seconds.max(0.0)).ok();
        let deadline = limit.and_then(|limit| Instant::now().checked_add(limit));
        Self { scene, settings, densities, shapes, sources, flats: BTreeMap::new(), deadline }
    }

    /// The lightmapped instances with their densities.
    fn lightmapped(&self) -> impl Iterator<Item = (usize, f64)> {
        self.densities.iter().enumerate().filter_map(|(i, density)| density.map(|d| (i, d)))
    }

    fn flat_key(&self, instance: usize) -> FlatKey {
        let mesh = self.scene.instances[instance].mesh;
        (mesh, self.shapes[instance].key, self.sources[&mesh].0 == Source::Own)
    }

    fn layout_key(&self, instance: usize, density: f64) -> LayoutKey {
        let in_shape = density * f64::from(self.shapes[instance].size);
        // Sizes that differ by rounding share a layout: the last 8 of 24 bits are dropped.
        (self.flat_key(instance), ((in_shape as f32).to_bits() + 0x80) & !0xff)
    }

    /// Flattens what is not yet flat.
    fn flatten(&mut self) {
        let mut missing: BTreeMap<FlatKey, &Shape> = BTreeMap::new();
        for (i, _) in self.lightmapped() {
            let key = self.flat_key(i);
            if !self.flats.contains_key(&key) {
                missing.entry(key).or_insert(&self.shapes[i]);
            }
        }
        let done: Vec<_> = missing
            .into_par_iter()
            .map(|(key, shape)| {
                let source = if key.2 { Source::Own } else { Source::Unwrap };
                let (flat, report) = flatten::flatten(self.scene, key.0, shape, source, self.deadline);
                (key, Flattened { islands: Islands::of(&flat), flat, report })
            })
            .collect();
        self.flats.extend(done);
    }

    /// Places everything, at lower densities where the pages ask for it.
    fn place(&self) -> Result<Placed, AtlasError> {
        let found = match self.settings.max_pages {
            None => self.place_scaled(1.0, u32::MAX).map(|placed| (1.0, placed)),
            Some(pages) => layout::highest(1.0, |factor| self.place_scaled(factor, pages)),
        };
        found.map(|(_, placed)| placed).ok_or_else(|| AtlasError::TooManyCharts {
            charts: self.lightmapped().map(|(i, _)| self.flats[&self.flat_key(i)].flat.charts).sum(),
            pages: self.settings.max_pages.unwrap_or(1),
            page_size: self.settings.page_size,
        })
    }

    /// Places everything at `factor` times the densities; `None` where it does not fit. With a limit on pages no
    /// instance is scaled by itself, so that all keep one density.
    fn place_scaled(&self, factor: f64, max_pages: u32) -> Option<Placed> {
        let (padding, limit) = (self.settings.padding, self.settings.page_size);
        let keys: BTreeSet<LayoutKey> = self.lightmapped().map(|(i, d)| self.layout_key(i, d * factor)).collect();
        let arranged = keys.into_par_iter().map(|key| {
            let islands = &self.flats[&key.0].islands;
            let density = f64::from(f32::from_bits(key.1));
            let found = match max_pages {
                u32::MAX => islands.arrange_at_most(density, padding, limit)?,
                _ => (density, islands.arrange(density, padding, limit)?),
            };
            Some((key, found))
        });
        let arranged: Option<Vec<_>> = arranged.collect();
        let layouts: BTreeMap<_, _> = (0..)
            .zip(arranged?)
            .map(|(index, (key, (density, arrangement)))| (key, LaidOut { index, density, arrangement }))
            .collect();
        let sizes: Vec<Size> =
            self.lightmapped().map(|(i, d)| layouts[&self.layout_key(i, d * factor)].arrangement.size).collect();
        let spots = pack::pack(&sizes, padding, [limit, limit], max_pages)?;
        Some(Placed { factor, layouts, spots })
    }

    /// Per mesh with own coordinates: texels that several charts or triangles cover, of all covered, in its worst layout.
    fn shared_texels(&self, placed: &Placed) -> BTreeMap<u32, Shared> {
        let own: Vec<_> = placed.layouts.iter().filter(|(key, _)| key.0.2).collect();
        let counts: Vec<_> = own
            .into_par_iter()
            .map(|(key, laid_out)| {
                let layout = self.layout(key, laid_out);
                (key.0.0, Shared::count(&layout, &raster::fragments(&layout, laid_out.arrangement.size)))
            })
            .collect();
        let mut worst: BTreeMap<u32, Shared> = BTreeMap::new();
        for (mesh, shared) in counts {
            let entry = worst.entry(mesh).or_insert(shared);
            if shared.share() > entry.share() {
                *entry = shared;
            }
        }
        worst
    }

    /// Has meshes unwrapped whose own coordinates overlap on too many texels; whether there were any.
    fn unwrap_overlapping(&mut self, shared: &BTreeMap<u32, Shared>) -> bool {
        let overlapping = shared.iter().filter(|(_, shared)| shared.share() > own::OVERLAP_ALLOWED);
        let mut any = false;
        for (mesh, shared) in overlapping {
            let problem = OwnUvProblem::Overlap { share: shared.share() };
            self.sources.insert(*mesh, (Source::Unwrap, Some(problem)));
            any = true;
        }
        any
    }

    fn layout(&self, key: &LayoutKey, laid_out: &LaidOut) -> Layout {
        let flattened = &self.flats[&key.0];
        flattened.islands.layout(&flattened.flat, key.0.0, laid_out.density, &laid_out.arrangement)
    }

    /// What the user should know.
    fn warn(&self, placed: &Placed, shared: &BTreeMap<u32, Shared>, warnings: &mut Vec<AtlasWarning>) {
        let name = |mesh: u32| self.scene.meshes[mesh as usize].name.clone();
        for (mesh, (_, problem)) in &self.sources {
            warnings.extend(problem.map(|problem| AtlasWarning::OwnUvRejected { mesh: name(*mesh), problem }));
        }
        if placed.factor < 1.0 {
            let asked = self.settings.texels_per_m;
            warnings.push(AtlasWarning::DensityScaled { asked, reached: asked * placed.factor as f32 });
        }
        let used: BTreeSet<FlatKey> = self.lightmapped().map(|(i, _)| self.flat_key(i)).collect();
        for (key, report) in used.iter().map(|key| (key, self.flats[key].report)).filter(|(_, r)| r.projected > 0) {
            let (triangles, timed_out) = (report.projected, report.timed_out);
            warnings.push(AtlasWarning::UnwrapFallback { mesh: name(key.0), triangles, timed_out });
        }
        for (i, asked) in self.lightmapped() {
            let asked = asked * placed.factor;
            let reached = placed.layouts[&self.layout_key(i, asked)].density / f64::from(self.shapes[i].size);
            // Less than the rounding of layout keys is no scaling.
            if reached < 0.999 * asked {
                let path = self.scene.instances[i].path.clone();
                warnings.push(AtlasWarning::InstanceScaled { path, asked: asked as f32, reached: reached as f32 });
            }
        }
        for (mesh, Shared { texels, covered }) in shared.iter().filter(|(_, shared)| shared.texels > 0) {
            warnings.push(AtlasWarning::SharedTexels { mesh: name(*mesh), texels: *texels, covered: *covered });
        }
    }

    /// The finished atlas.
    fn atlas(&self, placed: &Placed) -> Atlas {
        let layouts: Vec<_> =
            placed.layouts.iter().collect::<Vec<_>>().into_par_iter().map(|(key, l)| self.layout(key, l)).collect();
        let sizes: Vec<Size> = placed.layouts.values().map(|l| l.arrangement.size).collect();
        let mut instances = Vec::with_capacity(placed.spots.len());
        let mut first_chart = 0;
        for ((i, density), spot) in self.lightmapped().zip(&placed.spots) {
            let layout = placed.layouts[&self.layout_key(i, density * placed.factor)].index;
            instances.push(Rectangle {
                instance: i as u32,
                layout,
                size: sizes[layout as usize],
                spot: *spot,
                first_chart,
            });
            first_chart += layouts[layout as usize].charts;
        }
        let mut placements = vec![None; self.scene.instances.len()];
        let mut pages = Vec::new();
        for number in 0..instances.iter().map(|r| r.spot.page + 1).max().unwrap_or(0) {
            let on_page: Vec<_> = instances.iter().filter(|r| r.spot.page == number).copied().collect();
            let page = fill(&on_page, &layouts, self.settings.points_per_texel);
            for rectangle in &on_page {
                placements[rectangle.instance as usize] = Some(rectangle.placement([page.width, page.height]));
            }
            pages.push(page);
        }
        Atlas { pages, layouts, placements }
    }
}

/// An instance's place, in texels.
#[derive(Debug, Clone, Copy)]
struct Rectangle {
    instance: u32,
    layout: u32,
    size: Size,
    spot: Spot,
    first_chart: u32,
}

impl Rectangle {
    fn placement(&self, page: Size) -> Placement {
        let whole = Vec2::new(page[0] as f32, page[1] as f32);
        Placement {
            layout: self.layout,
            page: self.spot.page,
            offset: Vec2::new(self.spot.x as f32, self.spot.y as f32) / whole,
            scale: Vec2::new(self.size[0] as f32, self.size[1] as f32) / whole,
            first_chart: self.first_chart,
        }
    }
}

/// One page: instances of the same layout share its coverage, as they lie on whole texels.
fn fill(rectangles: &[Rectangle], layouts: &[Layout], points_per_texel: u32) -> Page {
    let used: BTreeMap<u32, Size> = rectangles.iter().map(|r| (r.layout, r.size)).collect();
    let coverage: BTreeMap<u32, Coverage> = used
        .into_par_iter()
        .map(|(index, size)| {
            let layout = &layouts[index as usize];
            (index, points::cover(layout, size, &raster::fragments(layout, size), points_per_texel))
        })
        .collect();
    let extent = |k: usize| {
        let far = rectangles.iter().map(|r| r.size[k] + if k == 0 { r.spot.x } else { r.spot.y });
        far.max().unwrap_or(0).next_multiple_of(4)
    };
    let mut page = Page { width: extent(0), height: extent(1), ..Page::default() };
    page.texels.reserve_exact(rectangles.iter().map(|r| coverage[&r.layout].texels.len()).sum());
    page.points.reserve_exact(rectangles.iter().map(|r| coverage[&r.layout].points.len()).sum());
    let mut open: Vec<(Rectangle, &Coverage, usize)> =
        rectangles.iter().map(|r| (*r, &coverage[&r.layout], 0)).collect();
    open.sort_by_key(|(r, ..)| (r.spot.x, r.spot.y));
    for y in 0..page.height {
        for (rectangle, coverage, next) in
            open.iter_mut().filter(|(r, ..)| (r.spot.y..r.spot.y + r.size[1]).contains(&y))
        {
            let row = coverage.texels[*next..].iter().take_while(|t| u32::from(t.y) + rectangle.spot.y == y);
            let count = row.map(|texel| append(&mut page, rectangle, coverage, texel)).count();
            *next += count;
        }
    }
    page
}

/// Copies a layout's texel to its place on the page.
fn append(page: &mut Page, rectangle: &Rectangle, coverage: &Coverage, texel: &Texel) {
    let first_point = page.points.len() as u32;
    let points = &coverage.points[texel.first_point as usize..][..texel.point_count as usize];
    page.points.extend(points.iter().map(|p| SurfacePoint { instance: rectangle.instance, ..*p }));
    page.texels.push(Texel {
        x: texel.x + rectangle.spot.x as u16,
        y: texel.y + rectangle.spot.y as u16,
        chart: texel.chart + rectangle.first_chart,
        first_point,
        point_count: texel.point_count,
    });
}

/// Area above which a second chart counts as present in a texel, and the excess above which triangles overlap.
const SHARED_AREA: f64 = 0.02;

/// How far a layout is from one surface a texel.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Shared {
    /// Texels that several charts touch or triangles cover more than once.
    texels: u32,
    /// Texels covered at all.
    covered: u32,
}

impl Shared {
    fn share(&self) -> f32 {
        self.texels as f32 / self.covered.max(1) as f32
    }

    fn count(layout: &Layout, fragments: &[Fragment]) -> Self {
        let mut count = Self { texels: 0, covered: 0 };
        let chart = |f: &Fragment| layout.chart[f.triangle as usize];
        for group in fragments.chunk_by(|a, b| a.texel == b.texel) {
            let area = |other: bool| {
                let counted = group.iter().filter(|f| (chart(f) != chart(&group[0])) == other);
                counted.map(|f| f64::from(f.area)).sum::<f64>()
            };
            let (first, others) = (area(false), area(true));
            count.covered += 1;
            count.texels += u32::from(first + others > 1.0 + SHARED_AREA || first.min(others) > SHARED_AREA);
        }
        count
    }
}

#[cfg(test)]
mod assets;
#[cfg(test)]
mod tests;
