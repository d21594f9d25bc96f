//! Paths as bytes: what `bake refog` reads back.
//!
//! Legs keep their bits: the lift of a vertex off its surface, a few roundings wide, decides whether a leg along a border of the air
//! lies inside. Normals and axes take 4 bytes (octahedral, at most 6.4e-5 rad off, axes of coordinates exact), strengths 2 a channel,
//! one channel where a vertex sees only greys. Strengths are rounded up or down at random, in proportion, so that their means keep no
//! bias.

use super::record::{Link, Lobe, Look, Once, Path, Step, Straight, Sunlit, Visit, Way};
use crate::solve::octahedron::{fold, unfold};
use crate::solve::path::Vertex;
use glam::{Vec2, Vec3};

/// Steps of a normal's coordinates from 0 to 1.
const NORMAL_STEPS: f32 = 32767.0;
/// No station.
const NOWHERE: u16 = u16::MAX;

/// What a vertex has.
mod has {
    pub const STRAIGHT: u8 = 1;
    pub const ONCE: u8 = 1 << 1;
    pub const LOBE: u8 = 1 << 2;
    pub const LOOK: u8 = 1 << 3;
    pub const GLOW: u8 = 1 << 4;
    pub const SKY: u8 = 1 << 5;
    pub const SUN: u8 = 1 << 6;
    pub const COLOUR: u8 = 1 << 7;
}

/// Writes paths.
#[derive(Debug, Default)]
pub struct Encoder {
    bytes: Vec<u8>,
    /// State of the generator behind random rounding.
    state: u32,
    colour: bool,
}

/// What indices may be.
#[derive(Debug, Clone, Copy)]
pub struct Limits {
    /// Finite emitters.
    pub emitters: u32,
    /// Lights of the scene.
    pub lights: u32,
}

/// Reads paths.
#[derive(Debug)]
pub struct Decoder<'b> {
    bytes: &'b [u8],
    limits: Limits,
    colour: bool,
}

/// The bytes are no paths of this scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum Damage {
    /// They end within a path.
    #[error("a path is cut off")]
    Short,
    /// They go on behind the last path.
    #[error("something follows the last path")]
    Long,
    /// An index points beyond the scene's lights.
    #[error("a path meets an emitter that the scene has not")]
    Emitter,
}

type Decoded<T> = Result<T, Damage>;

impl Encoder {
    /// Random numbers of rounding follow from `seed`.
    pub fn new(seed: u32) -> Self {
        Self { state: seed, ..Self::default() }
    }

    /// What was written.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// The places where the paths of a texel start.
    pub fn starts<'v>(&mut self, starts: impl ExactSizeIterator<Item = &'v Vertex>) {
        self.count(starts.len());
        for vertex in starts {
            self.vector(vertex.origin);
            self.normal(vertex.normal_geom);
            self.normal(vertex.normal_shading);
        }
    }

    /// A path from the start of this number.
    pub fn path(&mut self, start: usize, path: &Path) {
        self.count(start);
        let straights = path.straight.iter().map(|straight| straight.irradiance);
        self.colour = straights.chain(strengths(&path.start)).any(|c| !is_grey(c));
        self.bytes.push(path.straight.len() as u8);
        self.visit(&path.start);
        path.straight.iter().for_each(|straight| self.straight(straight));
        for chain in &path.chains {
            self.count(chain.len());
            chain.iter().for_each(|link| self.link(link));
        }
    }

    fn link(&mut self, Link { step, visit }: &Link) {
        self.colour = strengths(visit).chain([step.reflect]).any(|c| !is_grey(c));
        self.visit(visit);
        match step.way {
            Way::Ahead => self.bytes.push(0),
            Way::Beside { dir, length } => {
                self.bytes.push(1);
                self.vector(dir);
                self.number(length);
            }
        }
        self.strength(step.weight);
        self.normal(step.axis);
        self.rgb(step.reflect);
        self.vector(visit.origin);
        self.normal(visit.normal);
        self.bytes.extend(visit.station.map_or(NOWHERE, |s| s as u16).to_le_bytes());
    }

    fn visit(&mut self, visit: &Visit) {
        let look = visit.look.as_ref();
        let flag = |on: bool, bit: u8| if on { bit } else { 0 };
        self.bytes.push(
            flag(visit.straight.is_some(), has::STRAIGHT)
                | flag(visit.once.is_some(), has::ONCE)
                | flag(visit.lobe.is_some(), has::LOBE)
                | flag(look.is_some(), has::LOOK)
                | flag(look.is_some_and(|l| l.glow != Vec3::ZERO), has::GLOW)
                | flag(look.is_some_and(|l| l.sky != Vec3::ZERO), has::SKY)
                | flag(look.is_some_and(|l| l.sun.is_some()), has::SUN)
                | flag(self.colour, has::COLOUR),
        );
        visit.straight.iter().for_each(|straight| self.straight(straight));
        if let Some(Once { dir, distance, towards, rest, strength }) = visit.once {
            self.vector(dir);
            self.number(distance);
            self.vector(towards);
            self.number(rest);
            self.rgb(strength);
        }
        if let Some(Lobe { emitter, dir, length, axis, strength }) = visit.lobe {
            self.index(emitter);
            self.vector(dir);
            self.number(length);
            self.normal(axis);
            self.rgb(strength);
        }
        if let Some(Look { dir, length, glow, sky, sun }) = visit.look {
            self.vector(dir);
            self.number(length);
            [glow, sky].into_iter().filter(|c| *c != Vec3::ZERO).for_each(|c| self.rgb(c));
            if let Some(Sunlit { light, distance, strength }) = sun {
                self.index(light);
                self.number(distance);
                self.rgb(strength);
            }
        }
    }

    fn straight(&mut self, Straight { dir, length, irradiance }: &Straight) {
        self.vector(*dir);
        self.number(*length);
        self.rgb(*irradiance);
    }

    /// A small number: paths are cut long before it could be too large.
    fn count(&mut self, count: usize) {
        self.bytes.extend((count as u16).to_le_bytes());
    }

    fn index(&mut self, index: u32) {
        self.bytes.extend(&index.to_le_bytes()[..3]);
    }

    fn number(&mut self, number: f32) {
        self.bytes.extend(number.to_le_bytes());
    }

    /// Three numbers, exactly.
    pub fn vector(&mut self, vector: Vec3) {
        vector.to_array().into_iter().for_each(|x| self.number(x));
    }

    fn normal(&mut self, normal: Vec3) {
        let folded = fold(normal);
        for x in [folded.x, folded.y] {
            self.bytes.extend(((x * NORMAL_STEPS).round() as i16).to_le_bytes());
        }
    }

    fn rgb(&mut self, value: Vec3) {
        self.strength(value.x);
        if self.colour {
            self.strength(value.y);
            self.strength(value.z);
        }
    }

    /// The upper 16 of the 31 bits of a positive number.
    fn strength(&mut self, value: f32) {
        // Numerical Recipes' linear congruential generator; its upper bits are the random ones.
        self.state = self.state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let bits = ((value.max(0.0).to_bits() + (self.state >> 17)) >> 15) as u16;
        self.bytes.extend(bits.to_le_bytes());
    }
}

impl<'b> Decoder<'b> {
    /// Reads what an [`Encoder`] wrote.
    pub fn new(bytes: &'b [u8], limits: Limits) -> Self {
        Self { bytes, limits, colour: false }
    }

    /// Whether all was read.
    pub fn is_done(&self) -> bool {
        self.bytes.is_empty()
    }

    /// The places where the paths of a texel start.
    pub fn starts(&mut self) -> Decoded<Vec<Vertex>> {
        let count = self.count()?;
        let vertex =
            |_| Ok(Vertex { origin: self.vector()?, normal_geom: self.normal()?, normal_shading: self.normal()? });
        (0..count).map(vertex).collect()
    }

    /// The number of a path's start, and the path into `path`, whose memory is used again.
    pub fn path(&mut self, starts: &[Vertex], path: &mut Path) -> Decoded<usize> {
        let index = self.count()? as usize;
        let start = starts.get(index).ok_or(Damage::Short)?;
        let [straights] = self.take()?;
        path.start = self.visit(Visit::at(start, None))?;
        path.straight.clear();
        for _ in 0..straights {
            let straight = self.straight()?;
            path.straight.push(straight);
        }
        for chain in &mut path.chains {
            chain.clear();
            for _ in 0..self.count()? {
                let link = self.link()?;
                chain.push(link);
            }
        }
        Ok(index)
    }

    fn link(&mut self) -> Decoded<Link> {
        let seen = self.visit(Visit::default())?;
        let [is_beside] = self.take()?;
        let way = if is_beside == 0 { Way::Ahead } else { Way::Beside { dir: self.vector()?, length: self.number()? } };
        let step = Step { way, weight: self.strength()?, axis: self.normal()?, reflect: self.rgb()? };
        let (origin, normal) = (self.vector()?, self.normal()?);
        let station = Some(u16::from_le_bytes(self.take()?)).filter(|&s| s != NOWHERE).map(u32::from);
        Ok(Link { step, visit: Visit { origin, normal, station, ..seen } })
    }

    /// `visit` with what is seen from it.
    fn visit(&mut self, mut visit: Visit) -> Decoded<Visit> {
        let [flags] = self.take()?;
        self.colour = flags & has::COLOUR != 0;
        if flags & has::STRAIGHT != 0 {
            visit.straight = Some(self.straight()?);
        }
        if flags & has::ONCE != 0 {
            let (dir, distance, towards) = (self.vector()?, self.number()?, self.vector()?);
            visit.once = Some(Once { dir, distance, towards, rest: self.number()?, strength: self.rgb()? });
        }
        if flags & has::LOBE != 0 {
            let emitter = self.index(self.limits.emitters)?;
            let (dir, length, axis) = (self.vector()?, self.number()?, self.normal()?);
            visit.lobe = Some(Lobe { emitter, dir, length, axis, strength: self.rgb()? });
        }
        if flags & has::LOOK != 0 {
            let (dir, length) = (self.vector()?, self.number()?);
            let glow = if flags & has::GLOW != 0 { self.rgb()? } else { Vec3::ZERO };
            let sky = if flags & has::SKY != 0 { self.rgb()? } else { Vec3::ZERO };
            let sun = if flags & has::SUN != 0 { Some(self.sunlit()?) } else { None };
            visit.look = Some(Look { dir, length, glow, sky, sun });
        }
        Ok(visit)
    }

    fn sunlit(&mut self) -> Decoded<Sunlit> {
        Ok(Sunlit { light: self.index(self.limits.lights)?, distance: self.number()?, strength: self.rgb()? })
    }

    fn straight(&mut self) -> Decoded<Straight> {
        Ok(Straight { dir: self.vector()?, length: self.number()?, irradiance: self.rgb()? })
    }

    #[inline]
    fn take<const N: usize>(&mut self) -> Decoded<[u8; N]> {
        let (taken, rest) = self.bytes.split_first_chunk::<N>().ok_or(Damage::Short)?;
        self.bytes = rest;
        Ok(*taken)
    }

    fn count(&mut self) -> Decoded<u16> {
        Ok(u16::from_le_bytes(self.take()?))
    }

    fn index(&mut self, limit: u32) -> Decoded<u32> {
        let [a, b, c] = self.take()?;
        let index = u32::from_le_bytes([a, b, c, 0]);
        if index < limit { Ok(index) } else { Err(Damage::Emitter) }
    }

    #[inline]
    fn number(&mut self) -> Decoded<f32> {
        Ok(f32::from_le_bytes(self.take()?))
    }

    /// Three numbers, exactly.
    #[inline]
    pub fn vector(&mut self) -> Decoded<Vec3> {
        Ok(Vec3::new(self.number()?, self.number()?, self.number()?))
    }

    #[inline]
    fn normal(&mut self) -> Decoded<Vec3> {
        let mut of = || Ok(f32::from(i16::from_le_bytes(self.take()?)) / NORMAL_STEPS);
        Ok(unfold(Vec2::new(of()?, of()?)))
    }

    #[inline]
    fn rgb(&mut self) -> Decoded<Vec3> {
        let x = self.strength()?;
        if self.colour { Ok(Vec3::new(x, self.strength()?, self.strength()?)) } else { Ok(Vec3::splat(x)) }
    }

    #[inline]
    fn strength(&mut self) -> Decoded<f32> {
        Ok(f32::from_bits(u32::from(u16::from_le_bytes(self.take()?)) << 15))
    }
}

fn strengths(visit: &Visit) -> impl Iterator<Item = Vec3> {
    let look = visit.look.map(|l| [l.glow, l.sky, l.sun.map_or(Vec3::ZERO, |s| s.strength)]);
    let others = [visit.straight.map(|s| s.irradiance), visit.once.map(|o| o.strength), visit.lobe.map(|l| l.strength)];
    others.into_iter().flatten().chain(look.into_iter().flatten())
}

fn is_grey(colour: Vec3) -> bool {
    colour.x == colour.y && colour.y == colour.z
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMITS: Limits = Limits { emitters: 9, lights: 2 };

    fn direction(i: u32) -> Vec3 {
        let u = |k: u32| crate::solve::sampler::hash(i, k) as f32 / u32::MAX as f32;
        crate::solve::warp::uniform_sphere(u(1), u(2))
    }

    /// A path with everything that a path can have, from vertex 1 of two.
    fn path(colour: Vec3) -> Path {
        let straight = Straight { dir: direction(1), length: f32::INFINITY, irradiance: 3.0 * colour };
        let look = |length, sun| Look { dir: direction(2), length, glow: 0.1 * colour, sky: Vec3::ZERO, sun };
        let once =
            Once { dir: direction(3), distance: 0.7, towards: direction(4), rest: 12.5, strength: 7e-9 * colour };
        let lobe = Lobe { emitter: 8, dir: direction(5), length: 3e-4, axis: direction(6), strength: 6e20 * colour };
        let sun = Sunlit { light: 1, distance: 1e6, strength: colour };
        let visit = |station, sun| Visit {
            normal: direction(7),
            station,
            straight: Some(straight),
            once: Some(once),
            lobe: Some(lobe),
            look: Some(look(2.0, sun)),
            origin: 5.0 * direction(10),
        };
        let step = |way| Step { way, weight: 0.5, axis: direction(8), reflect: 0.3 * colour };
        let beside = Way::Beside { dir: direction(9), length: 0.2 };
        let links = [
            Link { step: step(Way::Ahead), visit: visit(Some(77), None) },
            Link { step: step(beside), visit: visit(None, Some(sun)) },
        ];
        Path { straight: vec![straight; 3], start: visit(None, Some(sun)), chains: [links.to_vec(), vec![links[0]]] }
    }

    fn written(colour: Vec3) -> (Encoder, [Vertex; 2]) {
        let vertex = |i| Vertex { origin: 5.0 * direction(i), normal_geom: direction(i), normal_shading: direction(i) };
        let starts = [vertex(20), vertex(21)];
        let mut encoder = Encoder::new(1);
        encoder.starts(starts.iter());
        encoder.path(1, &path(colour));
        (encoder, starts)
    }

    #[test]
    fn what_is_written_is_read_again() {
        for colour in [Vec3::ONE, Vec3::new(0.9, 0.01, 0.3)] {
            let (encoder, starts) = written(colour);
            let mut decoder = Decoder::new(encoder.bytes(), LIMITS);
            let found = decoder.starts().expect("starts");
            assert_eq!(found[1].origin, starts[1].origin);
            let (mut got, want) = (Path::default(), path(colour));
            assert_eq!(decoder.path(&found, &mut got), Ok(1));
            assert!(decoder.is_done());
            assert_eq!(got.chains.each_ref().map(Vec::len), [2, 1]);
            let near = |got: Vec3, want: Vec3| assert!((got / want - 1.0).abs().max_element() < 4.1e-3, "{got} {want}");
            near(got.straight[2].irradiance, want.straight[2].irradiance);
            let (a, b) = (&got.chains[0][1], &want.chains[0][1]);
            near(a.step.reflect, b.step.reflect);
            near(a.visit.once.unwrap().strength, b.visit.once.unwrap().strength);
            near(a.visit.lobe.unwrap().strength, b.visit.lobe.unwrap().strength);
            assert_eq!(got.chains[0][0].visit.station, Some(77));
            assert_eq!(a.visit.station, None);
            let (a, b) = (got.start.look.unwrap(), want.start.look.unwrap());
            assert_eq!((a.dir, a.length), (b.dir, b.length));
            assert!(got.straight[0].length.is_infinite());
            near(a.sun.unwrap().strength, b.sun.unwrap().strength);
            assert_eq!(got.chains[0][0].visit.origin, want.chains[0][0].visit.origin);
        }
    }

    #[test]
    fn octahedra_turn_normals_by_little_everywhere() {
        let turned = |normal: Vec3| {
            let mut encoder = Encoder::new(0);
            encoder.normal(normal);
            Decoder::new(encoder.bytes(), LIMITS).normal().expect("four bytes").distance(normal)
        };
        for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
            assert_eq!([turned(axis), turned(-axis)], [0.0; 2]);
        }
        let worst = (0..20_000).map(|i| turned(direction(i))).fold(0.0, f32::max);
        assert!((1e-6..6.4e-5).contains(&worst), "{worst}");
    }

    /// 0.1 lies between two numbers of 16 bits: the mean of many is nearer than either.
    #[test]
    fn rounding_keeps_means() {
        let mut encoder = Encoder::new(3);
        (0..4096).for_each(|_| encoder.strength(0.1));
        let mut decoder = Decoder::new(encoder.bytes(), LIMITS);
        let values: Vec<f64> = (0..4096).map(|_| f64::from(decoder.strength().expect("two bytes"))).collect();
        let mean = values.iter().sum::<f64>() / 4096.0;
        assert!(values.iter().all(|v| (v / 0.1 - 1.0).abs() > 5e-4), "every value is off");
        assert!((mean / 0.1 - 1.0).abs() < 1e-4, "{mean}");
    }

    #[test]
    fn cut_and_foreign_bytes_are_told() {
        let (encoder, starts) = written(Vec3::ONE);
        let all = encoder.bytes();
        for end in 0..all.len() {
            let mut decoder = Decoder::new(&all[..end], LIMITS);
            let read = decoder.starts().and_then(|starts| decoder.path(&starts, &mut Path::default()));
            assert_eq!(read, Err(Damage::Short), "{end} of {} bytes", all.len());
        }
        let fewer = Limits { emitters: 8, lights: 2 };
        let mut decoder = Decoder::new(all, fewer);
        let found = decoder.starts().expect("starts");
        assert_eq!(decoder.path(&found, &mut Path::default()), Err(Damage::Emitter));
        // Whatever is flipped, reading ends.
        for i in 0..all.len() {
            let mut flipped = all.to_vec();
            flipped[i] ^= 0x55;
            let mut decoder = Decoder::new(&flipped, LIMITS);
            let _ = decoder.path(&starts, &mut Path::default());
        }
    }
}
