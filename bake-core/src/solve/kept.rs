//! Bakes whose paths are kept, and kept paths folded with other air: the same samples of the same texels, traced once.
//!
//! A chunk of the file holds, for each of its texels, the places where paths start and then the paths themselves, sequence by
//! sequence. How many samples were taken is decided by the bake that kept them; folding takes them all.

use super::in_air::with_tables;
pub use super::kept_size::FILE_SUFFIX;
use super::kept_size::{CHUNKS, MOST_SAMPLES};
use super::path::{Gather, Gathered};
use super::tables::TablePaths;
use super::tables::codec::{Damage, Decoder, Encoder, Limits};
use super::tables::factors::Local;
use super::tables::record::Path;
use super::work::{self, Work};
use super::{
    Counters, Estimate, Lightmap, LightmapSettings, PageSolver, REPLICATES, Rounds, Sampler, TEXELS_PER_TASK, hash,
    texels,
};
use crate::atlas::Atlas;
use crate::progress::{Interrupted, Progress};
use crate::trace::Tracer;
use bake_formats::FormatError;
use bake_formats::path_file::{Chunk, ChunkTag, PathHeader, PathReader, PathWriter};
use bake_optics::medium::MediumSet;
use rayon::prelude::*;
use std::io::{Read, Write};

/// Why paths could not be kept or folded.
#[derive(Debug, thiserror::Error)]
pub enum KeptError {
    /// The progress asked to stop.
    #[error("interrupted")]
    Interrupted,
    /// The file could not be written, or is none that can be folded.
    #[error(transparent)]
    File(#[from] FormatError),
}

impl From<Interrupted> for KeptError {
    fn from(_: Interrupted) -> Self {
        Self::Interrupted
    }
}

/// Solves every page by tables and keeps the paths; without air in `media` they are kept as well.
///
/// # Errors
/// The progress asks to stop, or `begin` or the disk refuses.
pub fn keep<W: Write>(
    tracer: &Tracer,
    media: &MediumSet,
    atlas: &Atlas,
    settings: &LightmapSettings,
    progress: &dyn Progress,
    begin: impl FnOnce(&PathHeader) -> Result<PathWriter<W>, FormatError>,
) -> Result<(Lightmap, W), KeptError> {
    with_tables(tracer, media, settings, progress, |paths| {
        let mut file = begin(&header(paths, atlas))?;
        let mut lightmap = Lightmap::default();
        let texels = atlas.pages.iter().map(|page| page.texels.len()).sum();
        let mut work = Work::begin(progress, "trace", texels, &Rounds::new(settings, settings.deadline));
        for (index, page) in atlas.pages.iter().enumerate() {
            let (deadline, seed) = (settings.deadline, hash(settings.seed, index as u32));
            let solver = PageSolver { paths, page, settings, deadline, seed };
            solver.keep(index as u32, &mut file, &mut lightmap, &mut work)?;
        }
        Ok((lightmap, file.finish()?))
    })
}

/// Folds kept paths with `media`; nothing is traced but what the factors take.
///
/// # Errors
/// The progress asks to stop, or the file is damaged or was kept by another bake.
pub fn fold<R: Read>(
    tracer: &Tracer,
    media: &MediumSet,
    atlas: &Atlas,
    settings: &LightmapSettings,
    progress: &dyn Progress,
    open: impl FnOnce(&PathHeader) -> Result<PathReader<R>, FormatError>,
) -> Result<Lightmap, KeptError> {
    with_tables(tracer, media, settings, progress, |paths| {
        let mut file = open(&header(paths, atlas))?;
        let mut lightmap = Lightmap::default();
        for (index, page) in atlas.pages.iter().enumerate() {
            let solver = PageSolver { paths, page, settings, deadline: None, seed: 0 };
            solver.fold(index as u32, &mut file, &mut lightmap, progress)?;
        }
        match file.peek() {
            None => Ok(lightmap),
            Some(tag) => Err(unexpected(&file, tag)),
        }
    })
}

fn header(paths: &TablePaths, atlas: &Atlas) -> PathHeader {
    PathHeader {
        texels: atlas.pages.iter().map(|page| page.texels.len() as u32).collect(),
        replicates: REPLICATES as u32,
        stations: paths.factors().stations().vertices.len() as u32,
    }
}

/// Samples in portions of which a chunk can hold those of its texels.
fn portions(samples: std::ops::Range<u32>) -> impl Iterator<Item = std::ops::Range<u32>> {
    let end = samples.end;
    samples.step_by(MOST_SAMPLES as usize).map(move |start| start..end.min(start + MOST_SAMPLES))
}

impl PageSolver<'_, TablePaths<'_, '_>> {
    fn keep<W: Write>(
        &self,
        page: u32,
        file: &mut PathWriter<W>,
        lightmap: &mut Lightmap,
        work: &mut Work,
    ) -> Result<(), KeptError> {
        let starts = self.starts(work)?;
        work.found(starts.len());
        let good: Vec<bool> = starts.iter().map(|starts| !starts.is_empty()).collect();
        let mut estimates = vec![Estimate::default(); starts.len()];
        let mut rounds = Rounds::new(self.settings, self.deadline);
        loop {
            for samples in portions(rounds.samples()) {
                for (batch, estimates) in estimates.chunks_mut(CHUNKS * TEXELS_PER_TASK).enumerate() {
                    let tasks = estimates.par_chunks_mut(TEXELS_PER_TASK).enumerate().map(|(task, estimates)| {
                        let first = (batch * CHUNKS + task) * TEXELS_PER_TASK;
                        let texels = [first as u32, estimates.len() as u32];
                        let tag = ChunkTag { page, texels, samples: [samples.start, samples.end] };
                        self.trace_chunk(&starts[first..first + estimates.len()], estimates, tag, work)
                    });
                    for (chunk, counters) in tasks.collect::<Result<Vec<_>, Interrupted>>()? {
                        file.add(&chunk)?;
                        lightmap.count(&counters);
                    }
                }
            }
            work.finish_round(starts.len(), &rounds.samples());
            let report = self.report(&good, &estimates, rounds.samples().end * REPLICATES as u32);
            let goes_on = rounds.go_on(report.error);
            work.expect(starts.len(), &rounds);
            if !goes_on {
                lightmap.reports.push(report);
                lightmap.pages.push(self.buffers(&good, &estimates, report.samples));
                return Ok(());
            }
        }
    }

    fn trace_chunk(
        &self,
        starts: &[Vec<texels::Start>],
        estimates: &mut [Estimate],
        tag: ChunkTag,
        work: &Work,
    ) -> Result<(Chunk, Counters), Interrupted> {
        let counters = Counters::default();
        let mut encoder = Encoder::new(hash(tag.texels[0], tag.samples[0]));
        for (offset, (starts, estimate)) in starts.iter().zip(estimates.iter_mut()).enumerate() {
            work.check()?;
            encoder.starts(starts.iter().map(|start| &start.vertex));
            if starts.is_empty() {
                continue;
            }
            let known: Vec<Local> = starts.iter().map(|start| self.paths.factors().at(&start.vertex)).collect();
            let seed = self.texel_seed(tag.texels[0] as usize + offset);
            estimate.add(tag.samples[0]..tag.samples[1], |replicate, sample| {
                let mut sampler = Sampler::new(sample, hash(seed, replicate));
                let [u, ..] = sampler.next4();
                let start = texels::pick(starts, u);
                let path = self.paths.record(&starts[start].vertex, &mut sampler, &counters);
                encoder.path(start, &path);
                self.paths.fold(&path, &known[start])
            });
        }
        work.advance(estimates.len(), work::units(&(tag.samples[0]..tag.samples[1])))?;
        Ok((Chunk::pack(tag, encoder.bytes()), counters))
    }

    fn fold<R: Read>(
        &self,
        page: u32,
        file: &mut PathReader<R>,
        lightmap: &mut Lightmap,
        progress: &dyn Progress,
    ) -> Result<(), KeptError> {
        let texels = self.page.texels.len();
        let (mut estimates, mut good) = (vec![Estimate::default(); texels], vec![false; texels]);
        let mut done = 0;
        while let Some(tag) = file.peek().filter(|tag| tag.page == page) {
            let samples = tag.samples;
            progress.stage("fold", texels as u64);
            for batch in 0..texels.div_ceil(CHUNKS * TEXELS_PER_TASK) {
                let first = batch * CHUNKS * TEXELS_PER_TASK;
                let end = texels.min(first + CHUNKS * TEXELS_PER_TASK);
                let mut chunks = Vec::new();
                for from in (first..end).step_by(TEXELS_PER_TASK) {
                    let count = TEXELS_PER_TASK.min(end - from);
                    let expected = ChunkTag { page, texels: [from as u32, count as u32], samples };
                    match file.take()? {
                        Some(chunk) if chunk.tag == expected && samples[0] == done && samples[1] > done => {
                            chunks.push(chunk)
                        }
                        other => return Err(unexpected(file, other.map_or(expected, |chunk| chunk.tag))),
                    }
                }
                let (limits, name) = (self.paths.limits(), file.path());
                let tasks = estimates[first..end].par_chunks_mut(TEXELS_PER_TASK);
                let tasks = tasks.zip(good[first..end].par_chunks_mut(TEXELS_PER_TASK)).zip(chunks);
                tasks.try_for_each(|((estimates, good), chunk)| -> Result<(), KeptError> {
                    let records = chunk.unpack(name)?;
                    let mut decoder = Decoder::new(&records, limits);
                    let folded = self.fold_chunk(&mut decoder, estimates, good, samples);
                    folded.map_err(|damage| FormatError::damaged("paths", name, damage))?;
                    progress.advance(estimates.len() as u64);
                    if progress.is_cancelled() { Err(KeptError::Interrupted) } else { Ok(()) }
                })?;
            }
            done = samples[1];
        }
        if done == 0 && texels > 0 {
            return Err(FormatError::damaged("paths", file.path(), format!("page {page} has no paths")).into());
        }
        let report = self.report(&good, &estimates, done * REPLICATES as u32);
        lightmap.pages.push(self.buffers(&good, &estimates, report.samples));
        lightmap.reports.push(report);
        Ok(())
    }

    fn fold_chunk(
        &self,
        decoder: &mut Decoder,
        estimates: &mut [Estimate],
        good: &mut [bool],
        samples: [u32; 2],
    ) -> Result<(), Damage> {
        let (mut path, mut fault) = (Path::default(), None);
        for (estimate, good) in estimates.iter_mut().zip(good) {
            let starts = decoder.starts()?;
            *good = !starts.is_empty();
            if starts.is_empty() {
                continue;
            }
            let known: Vec<Local> = starts.iter().map(|start| self.paths.factors().at(start)).collect();
            estimate.add(samples[0]..samples[1], |_, _| {
                let read = fault.map_or_else(|| decoder.path(&starts, &mut path), Err);
                match read {
                    Ok(start) => self.paths.fold(&path, &known[start]),
                    Err(damage) => {
                        fault = Some(damage);
                        Gathered::default()
                    }
                }
            });
            fault.map_or(Ok(()), Err)?;
        }
        if decoder.is_done() { Ok(()) } else { Err(Damage::Long) }
    }
}

impl TablePaths<'_, '_> {
    fn limits(&self) -> Limits {
        Limits { emitters: self.emitters().finite_count() as u32, lights: self.tracer().scene().lights.len() as u32 }
    }
}

fn unexpected<R: Read>(file: &PathReader<R>, tag: ChunkTag) -> KeptError {
    let ChunkTag { page, texels: [first, _], samples: [start, _] } = tag;
    let reason = format!("samples from {start} on of texels from {first} on of page {page} are out of place");
    FormatError::damaged("paths", file.path(), reason).into()
}
