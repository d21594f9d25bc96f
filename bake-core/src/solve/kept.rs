//! Bakes whose paths are kept, and kept paths folded with other air: the same samples of the same texels, traced once.
//!
//! A chunk of the file holds, for each of its texels, the places where paths start and then the paths themselves, sequence by
//! sequence; behind them stand means by sequence and term in known airs. How many samples were taken is decided by the bake that
//! kept them. Of several paths one is kept: what the others know is in the means (see [`super::control`]).

use super::control::{AIRS, Known, Terms, Thinned, correct};
use super::in_air::with_tables;
pub use super::kept_size::FILE_SUFFIX;
use super::kept_size::{CHUNKS, MOST_SAMPLES, THINNING};
use super::path::{Gather, Gathered};
use super::tables::TablePaths;
use super::tables::codec::{Damage, Decoder, Encoder, Limits};
use super::tables::factors::Local;
use super::tables::record::Path;
use super::work::{self, Work};
use super::{
    Counters, Estimate, Lightmap, LightmapSettings, PageSolver, REPLICATES, Rounds, Sampler, Start, TEXELS_PER_TASK,
    hash, texels,
};
use crate::atlas::Atlas;
use crate::progress::{Interrupted, Progress};
use crate::trace::Tracer;
use bake_formats::FormatError;
use bake_formats::path_file::{Chunk, ChunkTag, PathHeader, PathReader, PathWriter};
use bake_optics::medium::MediumSet;
use glam::Vec3;
use rayon::prelude::*;
use std::io::{Read, Write};
use std::ops::Range;

/// The bake's own air and the hazes.
type Airs<'t, 'a, 's> = [&'t TablePaths<'a, 's>; AIRS];

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
    with_tables(tracer, media, settings, progress, |own| {
        let file = begin(&header(own, atlas))?;
        let [thin, thick] = own.hazes();
        with_tables(tracer, &thin, settings, progress, |thin| {
            with_tables(tracer, &thick, settings, progress, |thick| {
                keep_pages([own, thin, thick], (atlas, settings), progress, file)
            })
        })
    })
}

/// Solves every page in the first of the airs.
fn keep_pages<W: Write>(
    airs: Airs,
    (atlas, settings): (&Atlas, &LightmapSettings),
    progress: &dyn Progress,
    mut file: PathWriter<W>,
) -> Result<(Lightmap, W), KeptError> {
    let mut lightmap = Lightmap::default();
    let texels = atlas.pages.iter().map(|page| page.texels.len()).sum();
    let mut work = Work::begin(progress, "trace", texels, &Rounds::new(settings, settings.deadline));
    for (index, page) in atlas.pages.iter().enumerate() {
        let (deadline, seed) = (settings.deadline, hash(settings.seed, index as u32));
        let solver = PageSolver { paths: airs[0], page, settings, deadline, seed };
        solver.keep(index as u32, &airs, &mut file, (&mut lightmap, &mut work))?;
    }
    Ok((lightmap, file.finish()?))
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
        thinning: paths.thinning(),
        stations: paths.factors().stations().vertices.len() as u32,
    }
}

/// Samples of a range whose paths are kept: the first, because they are spread evenly by themselves.
fn few(samples: &Range<u32>, thinning: u32) -> Range<u32> {
    samples.start..samples.start + (samples.end - samples.start).div_ceil(thinning)
}

/// Samples in portions of which a chunk can hold those of its texels.
fn portions(samples: Range<u32>) -> impl Iterator<Item = Range<u32>> {
    let end = samples.end;
    samples.step_by(MOST_SAMPLES as usize).map(move |start| start..end.min(start + MOST_SAMPLES))
}

/// Where a sample's path starts, and the numbers that it goes on with.
fn draw(starts: &[Start], seed: u32, replicate: u32, sample: u32) -> (usize, Sampler) {
    let mut sampler = Sampler::new(sample, hash(seed, replicate));
    let [u, ..] = sampler.next4();
    (texels::pick(starts, u), sampler)
}

/// The starts of a texel that its kept paths take, ascending.
fn used(starts: &[Start], seed: u32, few: &Range<u32>) -> Vec<usize> {
    if starts.is_empty() {
        return vec![];
    }
    let of = |replicate: u32| few.clone().map(move |sample| draw(starts, seed, replicate, sample).0);
    let mut used: Vec<usize> = (0..REPLICATES as u32).flat_map(of).collect();
    used.sort_unstable();
    used.dedup();
    used
}

impl PageSolver<'_, TablePaths<'_, '_>> {
    fn keep<W: Write>(
        &self,
        page: u32,
        airs: &Airs,
        file: &mut PathWriter<W>,
        (lightmap, work): (&mut Lightmap, &mut Work),
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
                        self.trace_chunk(&starts[first..first + estimates.len()], estimates, tag, airs, work)
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
        starts: &[Vec<Start>],
        estimates: &mut [Estimate],
        tag: ChunkTag,
        airs: &Airs,
        work: &Work,
    ) -> Result<(Chunk, Counters), Interrupted> {
        let counters = Counters::default();
        let samples = tag.samples[0]..tag.samples[1];
        let few = few(&samples, self.paths.thinning());
        let mut encoder = Encoder::new(hash(tag.texels[0], tag.samples[0]));
        for (offset, (starts, estimate)) in starts.iter().zip(estimates.iter_mut()).enumerate() {
            work.check()?;
            let seed = self.texel_seed(tag.texels[0] as usize + offset);
            let used = used(starts, seed, &few);
            encoder.starts(used.iter().map(|&start| &starts[start].vertex));
            if starts.is_empty() {
                continue;
            }
            let locals: Vec<_> = starts.iter().map(|start| airs.map(|air| air.factors().at(&start.vertex))).collect();
            let mut known = Known::default();
            estimate.add(samples.clone(), |replicate, sample| {
                let (start, mut sampler) = draw(starts, seed, replicate, sample);
                let path = self.paths.record(&starts[start].vertex, &mut sampler, &counters);
                let folded: [Gathered; AIRS] = std::array::from_fn(|air| airs[air].fold(&path, &locals[start][air]));
                let terms = folded.map(|gathered| gathered.terms);
                known.add(1, replicate, &terms, samples.len());
                if let (true, Ok(number)) = (few.contains(&sample), used.binary_search(&start)) {
                    encoder.path(number, &path);
                    known.add(0, replicate, &terms, few.len());
                }
                folded[0]
            });
            known.means_mut().for_each(|mean| encoder.vector(*mean));
        }
        work.advance(estimates.len(), work::units(&samples))?;
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
        // A corrected mean of nearly nothing may fall below it.
        estimates.iter_mut().flat_map(|estimate| &mut estimate.terms).for_each(|term| *term = term.max(Vec3::ZERO));
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
        let samples = samples[0]..samples[1];
        let (mut path, count) = (Path::default(), few(&samples, self.paths.thinning()).len());
        let mut texels = vec![Thinned::default(); estimates.len()];
        for (texel, good) in texels.iter_mut().zip(good) {
            let starts = decoder.starts()?;
            *good = !starts.is_empty();
            if starts.is_empty() {
                continue;
            }
            let locals: Vec<Local> = starts.iter().map(|start| self.paths.factors().at(start)).collect();
            for mean in &mut texel.few {
                for _ in 0..count {
                    let start = decoder.path(&starts, &mut path)?;
                    let terms = self.paths.fold(&path, &locals[start]).terms;
                    mean.iter_mut().zip(terms).for_each(|(mean, term)| *mean += term / count as f32);
                }
            }
            for mean in texel.known.means_mut() {
                *mean = decoder.vector()?;
            }
        }
        correct(&mut texels);
        let sum =
            |mean: &Terms| Gathered { terms: mean.map(|term| term * samples.len() as f32), ..Gathered::default() };
        for (estimate, texel) in estimates.iter_mut().zip(&texels) {
            estimate.add_sums(samples.clone(), &texel.few.each_ref().map(sum));
        }
        if decoder.is_done() { Ok(()) } else { Err(Damage::Long) }
    }
}

impl TablePaths<'_, '_> {
    fn thinning(&self) -> u32 {
        THINNING[usize::from(self.is_closed())]
    }

    fn limits(&self) -> Limits {
        Limits { emitters: self.emitters().finite_count() as u32, lights: self.tracer().scene().lights.len() as u32 }
    }
}

fn unexpected<R: Read>(file: &PathReader<R>, tag: ChunkTag) -> KeptError {
    let ChunkTag { page, texels: [first, _], samples: [start, _] } = tag;
    let reason = format!("samples from {start} on of texels from {first} on of page {page} are out of place");
    FormatError::damaged("paths", file.path(), reason).into()
}
