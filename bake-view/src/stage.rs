//! Packages on a device, drawn as a look asks for. Windows and pictures without one come from here alike.

use std::collections::BTreeSet;

use bake_formats::manifest::{LightKind, LightRecord};
use bake_formats::{Package, Term};
use bake_runtime::air::{AirSettings, Haze, Medium};
use bake_runtime::scene::{PageContent, Reading, TermPages, page_charts};
use bake_runtime::{Camera, Headless, Method, Model, Onto, Renderer, SceneData, Settings, Show};
use glam::{DVec3, Vec3};

use crate::error::ViewError;
use crate::look::{Look, Split};
use crate::options::View;
use crate::turned::Turned;

/// What pictures are drawn to.
pub const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

/// Side of the shadow maps of lamps that were added to a scene without any, texels.
const SHADOW_SIZE: u32 = 1024;

/// One or two packages, ready to be drawn.
pub struct Stage {
    /// Where they are drawn.
    pub host: Headless,
    left: Side,
    right: Option<Side>,
    renderers: [Renderer; 2],
    /// A brightness of the whole light, so that single terms keep their share of it, cd/m².
    white: f32,
}

/// What lies under a texel of the picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Readout {
    /// Position, metres.
    pub place: DVec3,
    /// Path of the node.
    pub node: String,
    /// Lightmap page, and what was baked there.
    pub lightmap: Option<(u32, Reading)>,
}

/// What a package has that can be turned.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Baked {
    /// Its name.
    pub name: String,
    /// Its air, medium by medium.
    pub haze: Vec<Haze>,
    /// Its lights: paths and kinds.
    pub lights: Vec<(String, &'static str)>,
}

/// A package on the device.
struct Side {
    package: Package,
    model: Model,
    /// What lies on the pages.
    content: PageContent,
    /// Terms, once they were asked for.
    terms: Option<TermPages>,
    /// The air as it was baked.
    media: Vec<Medium>,
    /// The lights as they were baked.
    lights: Vec<LightRecord>,
    /// What suits it.
    plain: Settings,
}

impl Side {
    fn new(host: &Headless, package: Package) -> Result<Self, ViewError> {
        let scene = SceneData::load(&package)?;
        let (media, lights) = (scene.media.clone(), scene.lights.clone());
        let model = Model::new(&host.device, &host.queue, scene)?;
        let (content, plain) = (PageContent::Terms(Term::ALL.to_vec()), Settings::for_model(&model));
        Ok(Self { package, model, content, terms: None, media, lights, plain })
    }

    /// The terms, read at first use.
    fn terms(&mut self) -> Result<&TermPages, ViewError> {
        if self.terms.is_none() {
            self.terms = Some(TermPages::open(&self.package)?);
        }
        Ok(self.terms.as_ref().expect("read above"))
    }

    /// What can be turned.
    fn baked(&self) -> Baked {
        let light = |light: &LightRecord| (light.path.clone(), kind(&light.kind));
        Baked {
            name: self.package.manifest.name.clone(),
            haze: self.media.iter().map(Haze::of).collect(),
            lights: self.lights.iter().map(light).collect(),
        }
    }

    /// Puts pages, air and lights into the state that the look asks for; `white`: a brightness of the scene, cd/m².
    fn prepare(&mut self, host: &Headless, look: &Look, turned: &Turned, white: f32) -> Result<(), ViewError> {
        let content = look.page_content();
        if content != self.content {
            let terms = self.terms()?;
            let pages: Vec<_> = (0..terms.len()).map(|page| terms.texels(page, &content)).collect();
            pages.iter().enumerate().for_each(|(page, texels)| self.model.set_irradiance(&host.queue, page, texels));
            self.content = content;
        }
        if look.view == View::Show(Show::Charts) && !self.model.has_charts() {
            let charts = page_charts(&self.package, &self.model.scene.instances)?;
            self.model.set_charts(&host.device, &charts);
        }
        let scene = &mut self.model.scene;
        scene.media = turned.media(&self.media);
        scene.lights = turned.lights(&self.lights);
        scene.dynamic_lights = look.lamps.iter().filter_map(|lamp| lamp.light(white)).collect();
        Ok(())
    }
}

impl Stage {
    /// Puts packages on a device.
    pub fn new(host: Headless, left: Package, right: Option<Package>) -> Result<Self, ViewError> {
        let left = Side::new(&host, left)?;
        let right = right.map(|package| Side::new(&host, package)).transpose()?;
        let renderers = [(); 2].map(|()| Renderer::new(&host.device, &host.queue, FORMAT));
        let white = left.model.scene.typical_radiance();
        Ok(Self { host, left, right, renderers, white })
    }

    /// Box around everything, metres.
    pub fn bounds(&self) -> [Vec3; 2] {
        self.left.model.scene.bounds
    }

    /// Name of what is drawn, and of what it is compared with.
    pub fn names(&self) -> (&str, Option<&str>) {
        (&self.left.package.manifest.name, self.right.as_ref().map(|side| side.package.manifest.name.as_str()))
    }

    /// What of the packages is not drawn, in words.
    pub fn notes(&self) -> Vec<String> {
        self.sides().flat_map(|side| side.model.scene.notes.clone()).collect()
    }

    /// Terms that were baked, of either package.
    pub fn terms(&self) -> Vec<Term> {
        let terms: BTreeSet<Term> = self.sides().flat_map(|side| side.package.manifest.terms.clone()).collect();
        terms.into_iter().collect()
    }

    /// Whether there is light from infinitely far that is no sun.
    pub fn has_sky(&self) -> bool {
        self.sides().any(|side| side.model.scene.environment.is_some())
    }

    /// What can be turned of each package.
    pub fn baked(&self) -> Vec<Baked> {
        self.sides().map(Side::baked).collect()
    }

    fn sides(&self) -> impl Iterator<Item = &Side> {
        std::iter::once(&self.left).chain(&self.right)
    }

    /// Shaders that pictures called for so far, one a line: pass and effects.
    pub fn variants(&self) -> BTreeSet<String> {
        self.renderers.iter().flat_map(Renderer::variants).map(ToString::to_string).collect()
    }

    /// Why the air of a side that is shown is drawn in another way than `look` asks for.
    pub fn air_notes(&self, look: &Look) -> BTreeSet<String> {
        let shown = if look.split == Split::Off { 1 } else { 2 };
        let note = |(side, method): (&Side, Method)| {
            let plan = self.renderers[0].air_plan(&side.model, &settings(look, method, self.white, &side.plain))?;
            plan.note.map(|note| format!("{} stands in for {}: {note}", plan.method.name(), method.name()))
        };
        let sides = [(&self.left, look.air), (self.right.as_ref().unwrap_or(&self.left), look.right_air)];
        sides.into_iter().take(shown).filter_map(note).collect()
    }

    /// Draws to a target of [`FORMAT`]. Side by side: the column of the divider is left white.
    pub fn draw(
        &mut self,
        camera: &Camera,
        look: &Look,
        (target, size): (&wgpu::TextureView, [u32; 2]),
        timed: bool,
    ) -> Result<(), ViewError> {
        for (side, turned) in std::iter::once(&mut self.left).chain(&mut self.right).zip(&look.turned) {
            side.prepare(&self.host, look, turned, self.white)?;
        }
        let sides = [(&self.left, look.air), (self.right.as_ref().unwrap_or(&self.left), look.right_air)];
        let settings = sides.map(|(side, air)| Settings { timed, ..settings(look, air, self.white, &side.plain) });
        let draw = |renderer: &mut Renderer, side: usize, columns: std::ops::Range<u32>| {
            if !columns.is_empty() {
                let onto = Onto { view: target, size, columns };
                renderer.draw_columns(&sides[side].0.model, camera, &settings[side], &onto);
            }
        };
        let [left, right] = &mut self.renderers;
        match look.split {
            Split::Off => draw(left, 0, 0..size[0]),
            Split::Divided(_) => {
                let divider = look.divider(size[0]).unwrap_or(0);
                clear_white(&self.host, target);
                draw(left, 0, 0..divider);
                draw(right, 1, divider + 1..size[0]);
            }
            Split::Difference(share) => {
                draw(left, 0, 0..size[0]);
                draw(right, 1, 0..size[0]);
                left.draw_difference(right, share / settings[0].exposure, target);
            }
        }
        Ok(())
    }

    /// Luminance of the strongest colour of differences, cd/m².
    pub fn full_difference(&self, look: &Look) -> Option<f32> {
        let Split::Difference(share) = look.split else { return None };
        Some(share / settings(look, look.air, self.white, &self.left.plain).exposure)
    }

    /// What lies under a texel of a picture that was drawn like this.
    pub fn read(
        &mut self,
        camera: &Camera,
        look: &Look,
        size: [u32; 2],
        texel: [u32; 2],
    ) -> Result<Option<Readout>, ViewError> {
        let beyond = look.divider(size[0]).is_some_and(|divider| texel[0] > divider);
        let side = self.right.as_mut().filter(|_| beyond).unwrap_or(&mut self.left);
        let settings = settings(look, look.air, self.white, &side.plain);
        let hit = self.renderers[0].pick(&side.model, camera, &settings, (size, texel))?;
        let Some(hit) = hit else { return Ok(None) };
        let node = side.model.scene.nodes.get(hit.node as usize).map_or(String::new(), |node| node.path.clone());
        let lightmap = match hit.page {
            Some((page, uv)) => side.terms()?.read(page as usize, uv).map(|reading| (page, reading)),
            None => None,
        };
        Ok(Some(Readout { place: hit.place, node, lightmap }))
    }

    /// What the two sides are called together.
    pub fn title(&self) -> String {
        match self.names() {
            (name, Some(other)) => format!("{name} | {other}"),
            (name, None) => name.to_owned(),
        }
    }

    /// Milliseconds of each pass of the last picture, where the device tells; of the right side only where it was drawn.
    pub fn milliseconds(&self, look: &Look) -> [Vec<(&'static str, f64)>; 2] {
        let of = |renderer: &Renderer| renderer.milliseconds().and_then(Result::ok).unwrap_or_default();
        let [left, right] = &self.renderers;
        [of(left), if look.split == Split::Off { Vec::new() } else { of(right) }]
    }
}

/// How a side is drawn; `white`: what exposure goes by, `plain`: what suits its model.
fn settings(look: &Look, method: Method, white: f32, plain: &Settings) -> Settings {
    let stops = look.exposure_stops.exp2();
    let air = AirSettings { method, sky_distance_m: look.sky_distance_m, ..plain.air };
    let shadow_size = plain.shadow_size.or((!look.lamps.is_empty()).then_some(SHADOW_SIZE));
    let (exposure, prune_start_m) = (0.5 / white * stops, look.prune_start_m);
    let settings = Settings { air, exposure, prune_start_m, shadow_size, ..plain.clone() };
    let pages = Settings { show: Show::Irradiance, filmic: false, ..settings.clone() };
    match look.view {
        View::Show(Show::Irradiance) => Settings { exposure: settings.exposure / std::f32::consts::PI, ..pages },
        View::Show(show @ (Show::Nodes | Show::Charts | Show::Density)) => {
            Settings { show, exposure: stops, filmic: false, ..settings }
        }
        View::Show(show) => Settings { show, ..settings },
        View::Error => Settings { exposure: 10.0 * stops, ..pages },
        View::Validity => Settings { exposure: stops, ..pages },
    }
}

/// A kind of light in a word.
fn kind(kind: &LightKind) -> &'static str {
    match kind {
        LightKind::Point { profile: None, .. } => "point",
        LightKind::Spot { profile: None, .. } => "spot",
        LightKind::Point { .. } | LightKind::Spot { .. } => "measured",
        LightKind::Directional { .. } => "sun",
    }
}

fn clear_white(host: &Headless, target: &wgpu::TextureView) {
    let mut encoder = host.device.create_command_encoder(&Default::default());
    let ops = wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::WHITE), store: wgpu::StoreOp::Store };
    let attachment = wgpu::RenderPassColorAttachment { view: target, depth_slice: None, resolve_target: None, ops };
    drop(encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("divider"),
        color_attachments: &[Some(attachment)],
        ..Default::default()
    }));
    host.queue.submit([encoder.finish()]);
}
