//! How long each pass took on the device, where it can tell.

use crate::error::Result;
use crate::headless::read_buffer;

/// Most passes that are timed.
const MOST: u32 = 8;

/// Two timestamps a pass.
#[derive(Debug)]
pub(crate) struct Timer {
    queries: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    names: Vec<&'static str>,
}

impl Timer {
    /// `None` where the device has no timestamps.
    pub fn new(device: &wgpu::Device) -> Option<Self> {
        if !device.features().contains(wgpu::Features::TIMESTAMP_QUERY) {
            return None;
        }
        let queries = device.create_query_set(&wgpu::QuerySetDescriptor {
            label: Some("passes"),
            ty: wgpu::QueryType::Timestamp,
            count: 2 * MOST,
        });
        let resolved = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("timestamps"),
            size: u64::from(2 * MOST) * 8,
            usage: wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        });
        Some(Self { queries, resolved, names: Vec::new() })
    }

    /// Forgets the last picture's passes.
    pub fn begin(&mut self) {
        self.names.clear();
    }

    /// Where a pass writes its timestamps; `None` beyond the most.
    pub fn writes(&mut self, name: &'static str) -> Option<wgpu::RenderPassTimestampWrites<'_>> {
        self.writes_part(name, true, true)
    }

    /// The same of a pass in a row of them that are timed as one: the first begins, the last ends.
    pub fn writes_part(
        &mut self,
        name: &'static str,
        first: bool,
        last: bool,
    ) -> Option<wgpu::RenderPassTimestampWrites<'_>> {
        if first && self.names.len() < MOST as usize {
            self.names.push(name);
        }
        let index = 2 * (self.names.len() as u32).checked_sub(1)?;
        let own = self.names.last() == Some(&name) && (first || last);
        own.then_some(wgpu::RenderPassTimestampWrites {
            query_set: &self.queries,
            beginning_of_pass_write_index: first.then_some(index),
            end_of_pass_write_index: last.then_some(index + 1),
        })
    }

    /// Makes the timestamps readable once the commands are done.
    pub fn resolve(&self, encoder: &mut wgpu::CommandEncoder) {
        encoder.resolve_query_set(&self.queries, 0..2 * self.names.len() as u32, &self.resolved, 0);
    }

    /// Milliseconds of each pass of the last picture.
    pub fn milliseconds(&self, device: &wgpu::Device, queue: &wgpu::Queue) -> Result<Vec<(&'static str, f64)>> {
        let bytes = read_buffer(device, queue, &self.resolved)?;
        let stamps: Vec<u64> = bytes.chunks_exact(8).map(bytemuck::pod_read_unaligned).collect();
        let unit = f64::from(queue.get_timestamp_period()) * 1e-6;
        let span = |at: usize| stamps[2 * at + 1].saturating_sub(stamps[2 * at]) as f64 * unit;
        Ok(self.names.iter().enumerate().map(|(at, &name)| (name, span(at))).collect())
    }
}
