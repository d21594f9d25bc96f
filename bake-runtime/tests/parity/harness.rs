//! Runs one shader function over rows of inputs on the adapter and compares it with its twin.

use bake_runtime::Headless;
use bake_runtime::layout::Medium;
use bake_runtime::shader;
use bake_runtime::variant::{Pass, Variant};
use testkit::compare::Worst;
use wgpu::util::DeviceExt;

/// Numbers a row: three vec4f, `a`, `b`, `c`.
const ROW: usize = 12;

/// What the twin says of a row: values, and a scale below which errors count as absolute.
pub type Twin = Box<dyn Fn(&[f64]) -> (Vec<f64>, f64)>;

/// A function, its inputs and its twin.
pub struct Case {
    pub name: &'static str,
    pub variant: Variant,
    pub roots: &'static [&'static str],
    /// An expression of type vec4f in `a`, `b`, `c`.
    pub call: String,
    /// At most [`ROW`] numbers a row, all exact in f32.
    pub inputs: Vec<Vec<f64>>,
    pub limit: f64,
    pub twin: Twin,
    pub media: Vec<Medium>,
    pub coefficients: Vec<f32>,
    pub moments: Vec<f32>,
}

impl Default for Case {
    fn default() -> Self {
        Self {
            name: "",
            variant: Variant::new(Pass::Air),
            roots: &[],
            call: String::new(),
            inputs: Vec::new(),
            limit: 0.0,
            twin: Box::new(|_| (Vec::new(), 0.0)),
            media: Vec::new(),
            coefficients: Vec::new(),
            moments: Vec::new(),
        }
    }
}

/// The adapter.
pub struct Harness {
    headless: Headless,
}

impl Harness {
    /// `None`, a counted skip, where there is no adapter.
    pub fn open() -> Option<Self> {
        crate::common::headless().map(|headless| Self { headless })
    }

    /// The worst error of a case; `edit` may change the shader's text.
    pub fn compare(&self, case: &Case, edit: impl Fn(String) -> String) -> Worst {
        let tail = format!(
            "@group(0) @binding(20) var<storage, read> rows: array<vec4f>;\n\
             @group(0) @binding(21) var<storage, read_write> results: array<vec4f>;\n\
             @compute @workgroup_size(64) fn main(@builtin(global_invocation_id) id: vec3u) {{\n\
             if id.x >= arrayLength(&results) {{ return; }}\n\
             let a = rows[3u * id.x];\nlet b = rows[3u * id.x + 1u];\nlet c = rows[3u * id.x + 2u];\n\
             results[id.x] = {};\n}}\n",
            case.call
        );
        let text = edit(shader::compose_with(&case.variant, case.roots, &tail));
        let results = self.run(case, text);
        let mut worst = Worst::new(format!("WGSL {}", case.name), case.limit);
        for (row, got) in case.inputs.iter().zip(&results) {
            let (want, scale) = (case.twin)(row);
            for (channel, (&got, want)) in got.iter().zip(want).enumerate() {
                let error = (f64::from(got) - want).abs() / want.abs().max(scale).max(1e-30);
                worst.record(if got.is_finite() { error } else { f64::NAN }, || {
                    format!("{row:?} channel {channel}: {got:e}, not {want:e}")
                });
            }
        }
        worst
    }

    fn run(&self, case: &Case, text: String) -> Vec<[f32; 4]> {
        let device = &self.headless.device;
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(case.name),
            source: wgpu::ShaderSource::Wgsl(text.clone().into()),
        });
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(case.name),
            layout: None,
            module: &module,
            entry_point: Some("main"),
            compilation_options: Default::default(),
            cache: None,
        });
        let rows: Vec<f32> =
            case.inputs.iter().flat_map(|row| (0..ROW).map(|i| row.get(i).map_or(0.0, |&x| x as f32))).collect();
        let buffer = |bytes: &[u8], usage| {
            let contents = if bytes.is_empty() { &[0; 16] } else { bytes };
            device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: None, contents, usage })
        };
        let storage = wgpu::BufferUsages::STORAGE;
        // A sentinel: what was not written is not zero.
        let sentinel = vec![[f32::NAN; 4]; case.inputs.len()];
        let results = buffer(bytemuck::cast_slice(&sentinel), storage | wgpu::BufferUsages::COPY_SRC);
        let resources = [
            (20, buffer(bytemuck::cast_slice(&rows), storage)),
            (11, buffer(bytemuck::cast_slice(&case.media), wgpu::BufferUsages::UNIFORM)),
            (10, buffer(bytemuck::cast_slice(&case.coefficients), storage)),
            (13, buffer(bytemuck::cast_slice(&case.moments), storage)),
        ];
        let mut entries: Vec<_> = (resources.iter())
            .filter(|(binding, _)| text.contains(&format!("@binding({binding})")))
            .map(|(binding, buffer)| wgpu::BindGroupEntry { binding: *binding, resource: buffer.as_entire_binding() })
            .collect();
        entries.push(wgpu::BindGroupEntry { binding: 21, resource: results.as_entire_binding() });
        let tails = text.contains("tail_texels").then(|| bake_runtime::air::tail_texels(device, &self.headless.queue));
        if let Some(tails) = &tails {
            entries.push(wgpu::BindGroupEntry { binding: 12, resource: wgpu::BindingResource::TextureView(tails) });
        }
        let layout = pipeline.get_bind_group_layout(0);
        let group =
            device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout: &layout, entries: &entries });
        let mut encoder = device.create_command_encoder(&Default::default());
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.dispatch_workgroups(case.inputs.len().div_ceil(64) as u32, 1, 1);
        drop(pass);
        self.headless.queue.submit([encoder.finish()]);
        let bytes = self.headless.read_buffer(&results).expect("results come back");
        bytes.chunks_exact(16).map(bytemuck::pod_read_unaligned).collect()
    }
}
