//! The window: winit's events to egui, the stage's picture to a texture of it, both to the screen. Decides nothing.

use std::sync::Arc;
use std::time::{Duration, Instant};

use bake_formats::Package;
use bake_runtime::{Camera, Headless};
use winit::application::ApplicationHandler;
use winit::dpi::PhysicalSize;
use winit::event::{StartCause, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop};
use winit::window::WindowId;

use crate::error::ViewError;
use crate::keys::Viewer;
use crate::look::Look;
use crate::navigator::Navigator;
use crate::options::{CameraArgument, Options};
use crate::pace::Pace;
use crate::panel::{self, Facts, Touched};
use crate::screenshot::{open, png};
use crate::stage::{FORMAT, Stage};
use crate::turned::Turned;
use crate::widgets::WidgetFile;

/// Opens a window on a package and returns when it is closed.
pub fn window(package: Package, options: Options) -> Result<(), ViewError> {
    let events = EventLoop::new()?;
    let mut program = Program::Waiting(Some(Box::new((package, options))));
    events.run_app(&mut program)?;
    match program {
        Program::Failed(error) => Err(error),
        _ => Ok(()),
    }
}

/// winit gives a window only once its loop runs.
enum Program {
    Waiting(Option<Box<(Package, Options)>>),
    Open(Box<Desk>),
    Failed(ViewError),
}

impl ApplicationHandler for Program {
    fn resumed(&mut self, events: &ActiveEventLoop) {
        let Self::Waiting(waiting) = self else { return };
        let Some(waiting) = waiting.take() else { return };
        let (package, options) = *waiting;
        match Desk::new(events, package, &options) {
            Ok(desk) => *self = Self::Open(Box::new(desk)),
            Err(error) => {
                *self = Self::Failed(error);
                events.exit();
            }
        }
    }

    fn window_event(&mut self, events: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        let Self::Open(desk) = self else { return };
        match desk.on(&event, events) {
            Ok(true) => {}
            Ok(false) => events.exit(),
            Err(error) => {
                *self = Self::Failed(error);
                events.exit();
            }
        }
    }

    fn new_events(&mut self, _: &ActiveEventLoop, cause: StartCause) {
        if let (Self::Open(desk), StartCause::ResumeTimeReached { .. }) = (self, cause) {
            desk.window.request_redraw();
        }
    }
}

/// What the texture on the screen shows.
#[derive(PartialEq)]
struct Shown {
    camera: Camera,
    look: Look,
    size: [u32; 2],
}

/// A window and everything in it.
struct Desk {
    window: Arc<winit::window::Window>,
    surface: wgpu::Surface<'static>,
    config: wgpu::SurfaceConfiguration,
    egui: egui_winit::State,
    painter: egui_wgpu::Renderer,
    stage: Stage,
    viewer: Viewer,
    pace: Pace,
    target: wgpu::Texture,
    texture: egui::TextureId,
    shown: Option<Shown>,
    /// Texel of the picture that was read last.
    read: Option<[u32; 2]>,
    facts: Facts,
    widgets: Option<WidgetFile>,
}

impl Desk {
    fn new(events: &ActiveEventLoop, package: Package, options: &Options) -> Result<Self, ViewError> {
        let [width, height] = options.size;
        let attributes = winit::window::Window::default_attributes()
            .with_title(format!("{} - bake", package.manifest.name))
            .with_inner_size(PhysicalSize::new(width, height));
        let window = events.create_window(attributes).map_err(ViewError::no_display)?;
        let window = Arc::new(window);
        let display = Box::new(events.owned_display_handle());
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_with_display_handle_from_env(display));
        let surface = instance.create_surface(window.clone());
        let surface = surface.map_err(ViewError::no_display)?;
        let host = pollster::block_on(Headless::open_on(&instance, Some(&surface)))?;
        let config = configuration(&surface, &host, window.inner_size())?;
        surface.configure(&host.device, &config);
        let stage = open(package, options, host)?;
        window.set_title(&format!("{} - bake", stage.title()));
        let host = &stage.host;
        let painting = egui_wgpu::RendererOptions { dithering: false, ..Default::default() };
        let mut painter = egui_wgpu::Renderer::new(&host.device, config.format, painting);
        let target = host.target([1, 1], FORMAT);
        let view = target.create_view(&Default::default());
        let texture = painter.register_native_texture(&host.device, &view, wgpu::FilterMode::Nearest);
        let context = egui::Context::default();
        context.set_theme(egui::Theme::Dark);
        let side = host.device.limits().max_texture_dimension_2d as usize;
        let egui = egui_winit::State::new(context, egui::ViewportId::ROOT, &window, None, None, Some(side));
        let viewer = viewer(&stage, options);
        let facts = facts(&stage);
        let widgets = options.widgets.clone().map(WidgetFile::new);
        if widgets.is_some() {
            egui.egui_ctx().enable_accesskit();
        }
        let (pace, shown, read) = (Pace::default(), None, None);
        Ok(Self {
            window,
            surface,
            config,
            egui,
            painter,
            stage,
            viewer,
            pace,
            target,
            texture,
            shown,
            read,
            facts,
            widgets,
        })
    }

    /// Answers an event; `false`: the program is to end.
    fn on(&mut self, event: &WindowEvent, events: &ActiveEventLoop) -> Result<bool, ViewError> {
        let answer = self.egui.on_window_event(&self.window, event);
        if answer.repaint {
            self.window.request_redraw();
        }
        match event {
            WindowEvent::CloseRequested => return Ok(false),
            WindowEvent::Resized(size) => {
                (self.config.width, self.config.height) = (size.width.max(1), size.height.max(1));
                self.surface.configure(&self.stage.host.device, &self.config);
                self.window.request_redraw();
            }
            WindowEvent::RedrawRequested => {
                let rest = self.frame()?;
                match Instant::now().checked_add(rest) {
                    Some(next) if rest > Duration::ZERO => events.set_control_flow(ControlFlow::WaitUntil(next)),
                    Some(_) => self.window.request_redraw(),
                    None => events.set_control_flow(ControlFlow::Wait),
                }
            }
            _ => {}
        }
        Ok(!self.viewer.close)
    }

    /// Asks the hands, draws what changed, shows it; returns how long nothing will change by itself.
    fn frame(&mut self) -> Result<Duration, ViewError> {
        let input = self.egui.take_egui_input(&self.window);
        let context = self.egui.egui_ctx().clone();
        let mut touched = None;
        let output = context.run_ui(input, |ui| {
            touched = Some(panel::show(ui, &mut self.viewer, &self.facts, self.texture));
        });
        let touched = touched.expect("run_ui runs it");
        let drawn = self.draw(&touched, output.pixels_per_point)?;
        let stale = self.read(&touched, drawn)? || drawn;
        if std::mem::take(&mut self.viewer.save) {
            self.save()?;
        }
        if let Some((file, shown)) = self.widgets.as_mut().zip(output.platform_output.accesskit_update.as_ref()) {
            file.keep(shown, output.pixels_per_point)?;
        }
        self.egui.handle_platform_output(&self.window, output.platform_output);
        let triangles = context.tessellate(output.shapes, output.pixels_per_point);
        self.paint(&triangles, output.textures_delta, output.pixels_per_point);
        let rest = output.viewport_output.get(&egui::ViewportId::ROOT).map_or(Duration::MAX, |v| v.repaint_delay);
        Ok(if stale || touched.motion.is_walking() { Duration::ZERO } else { rest })
    }

    /// Draws the picture if it is not what is wanted; returns whether the panel's numbers are now old.
    fn draw(&mut self, touched: &Touched, pixels_per_point: f32) -> Result<bool, ViewError> {
        let pixels = (touched.area.size() * pixels_per_point).round().max(egui::vec2(1.0, 1.0));
        let full = [pixels.x as u32, pixels.y as u32];
        let divisor = self.pace.divisor(touched.held);
        let (camera, look) = (self.viewer.navigator.camera, self.viewer.look.clone());
        let size = full.map(|side| (side / divisor).max(1));
        let wanted = Shown { camera, look, size };
        let same = |shown: &Shown| shown.camera == camera && shown.look == wanted.look;
        let enough = |shown: &Shown| *shown == wanted || (touched.held && same(shown) && shown.size == full);
        if self.shown.as_ref().is_some_and(enough) {
            return Ok(false);
        }
        let host = &self.stage.host;
        if self.target.width() != size[0] || self.target.height() != size[1] {
            self.target = host.target(size, FORMAT);
            let filter = if divisor == 1 { wgpu::FilterMode::Nearest } else { wgpu::FilterMode::Linear };
            let view = self.target.create_view(&Default::default());
            self.painter.update_egui_texture_from_wgpu_texture(&host.device, &view, filter, self.texture);
        }
        let begin = Instant::now();
        let view = self.target.create_view(&Default::default());
        self.stage.draw(&camera, &wanted.look, (&view, size), self.viewer.panel)?;
        // A lost device shows itself at the surface.
        let _ = self.stage.host.device.poll(wgpu::PollType::wait_indefinitely());
        self.pace.drew(divisor, begin.elapsed().as_secs_f64());
        self.facts.picture = (begin.elapsed().as_secs_f64() * 1e3, divisor);
        self.facts.times = self.stage.milliseconds(&wanted.look);
        self.facts.full_difference = self.stage.full_difference(&wanted.look);
        self.facts.air_notes = self.stage.air_notes(&wanted.look).into_iter().collect();
        self.shown = Some(wanted);
        Ok(true)
    }

    /// Asks what lies under the cursor, if that may have changed; returns whether the panel's words are now old.
    fn read(&mut self, touched: &Touched, drawn: bool) -> Result<bool, ViewError> {
        let Some(shown) = self.shown.as_ref().filter(|_| self.viewer.panel && !touched.held) else { return Ok(false) };
        let texel = touched.cursor.map(|share| [share.x * shown.size[0] as f32, share.y * shown.size[1] as f32]);
        let texel = texel.map(|at| at.map(|at| at as u32));
        if texel == self.read && !drawn {
            return Ok(false);
        }
        self.read = texel;
        self.facts.readout = match texel {
            Some(texel) => self.stage.read(&shown.camera, &shown.look, shown.size, texel)?,
            None => None,
        };
        Ok(true)
    }

    /// Writes the picture beside where the program was started, under a name that is free.
    fn save(&mut self) -> Result<(), ViewError> {
        let bytes = png(&self.stage.host, &self.target)?;
        let name = self.stage.names().0;
        let names = (0..1000).map(|number| format!("{name}.view.{number:02}.png"));
        let free = names.into_iter().find(|name| !std::path::Path::new(name).exists());
        let camera = CameraArgument(self.viewer.navigator.camera);
        let written = free.map(|name| (std::fs::write(&name, &bytes), name));
        self.facts.status = match written {
            Some((Ok(()), name)) => format!("{name}: --camera {camera}"),
            Some((Err(error), name)) => format!("{name} cannot be written: {error}"),
            None => "too many pictures here already".into(),
        };
        eprintln!("{}", self.facts.status);
        Ok(())
    }

    /// Puts everything on the screen.
    fn paint(
        &mut self,
        triangles: &[egui::ClippedPrimitive],
        mut textures: egui::TexturesDelta,
        pixels_per_point: f32,
    ) {
        let (device, queue) = (&self.stage.host.device, &self.stage.host.queue);
        for (id, deltas) in textures.set.drain() {
            deltas.iter().for_each(|delta| self.painter.update_texture(device, queue, id, delta));
        }
        let size_in_pixels = [self.config.width, self.config.height];
        let screen = egui_wgpu::ScreenDescriptor { size_in_pixels, pixels_per_point };
        if let Some(frame) = next_frame(&self.surface, device, &self.config) {
            let mut encoder = device.create_command_encoder(&Default::default());
            let mut commands = self.painter.update_buffers(device, queue, &mut encoder, triangles, &screen);
            let view = frame.texture.create_view(&Default::default());
            let mut pass = begin(&mut encoder, &view).forget_lifetime();
            self.painter.render(&mut pass, triangles, &screen);
            drop(pass);
            commands.push(encoder.finish());
            queue.submit(commands);
            self.window.pre_present_notify();
            queue.present(frame);
        }
        textures.free.drain().for_each(|id| self.painter.free_texture(&id));
    }
}

/// Where a person begins.
fn viewer(stage: &Stage, options: &Options) -> Viewer {
    let [low, high] = stage.bounds();
    let camera = options.camera.unwrap_or_else(|| Camera::overview(low, high));
    let mut look = Look::new(options);
    for (turned, baked) in look.turned.iter_mut().zip(stage.baked()) {
        *turned = Turned::nothing(baked.haze.len(), baked.lights.len());
    }
    Viewer::new(Navigator::new(camera, [low, high]), look)
}

/// What does not change while the window is open.
fn facts(stage: &Stage) -> Facts {
    Facts {
        title: stage.title(),
        adapter: stage.host.info.name.clone(),
        notes: stage.notes(),
        terms: stage.terms(),
        baked: stage.baked(),
        sky: stage.has_sky(),
        ..Facts::default()
    }
}

/// Colours that egui paints best to, and no tearing.
fn configuration(
    surface: &wgpu::Surface,
    host: &Headless,
    size: PhysicalSize<u32>,
) -> Result<wgpu::SurfaceConfiguration, ViewError> {
    let no = |reason: &str| ViewError::NoSurface { adapter: host.info.name.clone(), reason: reason.into() };
    let config = surface.get_default_config(&host.adapter, size.width.max(1), size.height.max(1));
    let config = config.ok_or_else(|| no("it knows no format for it"))?;
    let formats = surface.get_capabilities(&host.adapter).formats;
    let format = egui_wgpu::preferred_framebuffer_format(&formats).map_err(|error| no(&error.to_string()))?;
    Ok(wgpu::SurfaceConfiguration { format, view_formats: Vec::new(), ..config })
}

/// The texture that the screen shows next; none while the window is hidden or its surface is made anew.
fn next_frame(
    surface: &wgpu::Surface,
    device: &wgpu::Device,
    config: &wgpu::SurfaceConfiguration,
) -> Option<wgpu::SurfaceTexture> {
    use wgpu::CurrentSurfaceTexture::{Lost, Outdated, Suboptimal, Success};
    match surface.get_current_texture() {
        Success(frame) | Suboptimal(frame) => Some(frame),
        Outdated | Lost => {
            surface.configure(device, config);
            match surface.get_current_texture() {
                Success(frame) | Suboptimal(frame) => Some(frame),
                _ => None,
            }
        }
        _ => None,
    }
}

fn begin<'a>(encoder: &'a mut wgpu::CommandEncoder, view: &wgpu::TextureView) -> wgpu::RenderPass<'a> {
    let ops = wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::BLACK), store: wgpu::StoreOp::Store };
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("window"),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view,
            depth_slice: None,
            resolve_target: None,
            ops,
        })],
        ..Default::default()
    })
}
