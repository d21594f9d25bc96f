//! Light from all directions: radiance by direction, and directions by radiance.
//!
//! The image is taken as constant over each texel, both as radiance and as density, so the sampled weight is the
//! same for every direction within a texel.

use crate::scene::Environment;
use glam::Vec3;
use std::f32::consts::{PI, TAU};

/// An environment with the distribution of its luminance over the sphere.
pub struct EnvironmentSampler<'s> {
    environment: &'s Environment,
    /// Cumulative share of rows, `height` entries.
    rows: Vec<f32>,
    /// Cumulative share within each row, `width` entries each.
    columns: Vec<f32>,
}

impl<'s> EnvironmentSampler<'s> {
    /// Prepares an environment; `None` if it is black.
    pub fn new(environment: &'s Environment) -> Option<Self> {
        let (width, height) = (environment.width as usize, environment.height as usize);
        let mut rows = Vec::with_capacity(height);
        let mut columns = Vec::with_capacity(width * height);
        let mut total = 0.0f64;
        for y in 0..height {
            let share = solid_angle(environment, y) * environment.width as f32;
            let mut sum = 0.0f64;
            for texel in &environment.radiance[y * width..][..width] {
                sum += f64::from(luminance(*texel));
                columns.push(sum as f32);
            }
            let scale = if sum > 0.0 { 1.0 / sum as f32 } else { 0.0 };
            columns[y * width..].iter_mut().for_each(|c| *c *= scale);
            total += sum / width as f64 * f64::from(share);
            rows.push(total as f32);
        }
        let scale = 1.0 / total as f32;
        rows.iter_mut().for_each(|r| *r *= scale);
        (total > 0.0).then_some(Self { environment, rows, columns })
    }

    /// Radiance (cd/m²) arriving from a unit direction.
    pub fn radiance(&self, dir: Vec3) -> Vec3 {
        self.environment.radiance[self.texel_of(dir)]
    }

    /// A unit direction and its density per solid angle.
    pub fn sample(&self, u: f32, v: f32) -> (Vec3, f32) {
        let (width, height) = (self.environment.width as usize, self.environment.height as usize);
        let (y, v) = pick(&self.rows, v);
        let (x, u) = pick(&self.columns[y * width..][..width], u);
        let (top, bottom) = row_cosines(self.environment, y);
        let cos = top + (bottom - top) * v;
        let sin = (1.0 - cos * cos).max(0.0).sqrt();
        let azimuth = TAU * (x as f32 + u) / width as f32 + self.environment.rotation;
        debug_assert!(y < height);
        (Vec3::new(sin * azimuth.sin(), cos, -sin * azimuth.cos()), self.texel_pdf(y * width + x))
    }

    /// Density per solid angle with which [`Self::sample`] gives a direction.
    pub fn pdf(&self, dir: Vec3) -> f32 {
        self.texel_pdf(self.texel_of(dir))
    }

    fn texel_pdf(&self, texel: usize) -> f32 {
        let width = self.environment.width as usize;
        let (y, x) = (texel / width, texel % width);
        let share = step(&self.rows, y) * step(&self.columns[y * width..][..width], x);
        share / solid_angle(self.environment, y)
    }

    fn texel_of(&self, dir: Vec3) -> usize {
        let (width, height) = (self.environment.width, self.environment.height);
        let azimuth = (dir.x.atan2(-dir.z) - self.environment.rotation).rem_euclid(TAU);
        let x = ((azimuth / TAU * width as f32) as u32).min(width - 1);
        let y = ((dir.y.clamp(-1.0, 1.0).acos() / PI * height as f32) as u32).min(height - 1);
        (y * width + x) as usize
    }
}

fn luminance(c: Vec3) -> f32 {
    c.dot(crate::solve::LUMINANCE)
}

/// Cosines of the polar angles that bound a row.
fn row_cosines(environment: &Environment, y: usize) -> (f32, f32) {
    let angle = |y: usize| PI * y as f32 / environment.height as f32;
    (angle(y).cos(), angle(y + 1).cos())
}

/// Solid angle of one texel of a row.
fn solid_angle(environment: &Environment, y: usize) -> f32 {
    let (top, bottom) = row_cosines(environment, y);
    (top - bottom) * TAU / environment.width as f32
}

/// The bin of a cumulative distribution in which `u` falls, and where in it.
fn pick(cumulative: &[f32], u: f32) -> (usize, f32) {
    let last = cumulative.len() - 1;
    let bin = cumulative.partition_point(|&c| c <= u).min(last);
    let below = if bin == 0 { 0.0 } else { cumulative[bin - 1] };
    let size = cumulative[bin] - below;
    let rest = if size > 0.0 { ((u - below) / size).clamp(0.0, 1.0 - f32::EPSILON) } else { 0.5 };
    (bin, rest)
}

fn step(cumulative: &[f32], bin: usize) -> f32 {
    cumulative[bin] - if bin == 0 { 0.0 } else { cumulative[bin - 1] }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gradient(width: u32, height: u32, rotation: f32) -> Environment {
        let radiance = (0..width * height).map(|i| Vec3::splat(0.5 + (i % 7) as f32 + (i / width) as f32)).collect();
        Environment { width, height, radiance, rotation }
    }

    #[test]
    fn directions_come_back_with_their_density() {
        let environment = gradient(16, 8, 0.7);
        let sampler = EnvironmentSampler::new(&environment).unwrap();
        for i in 0..1000 {
            let (u, v) = ((i as f32 + 0.5) / 1000.0, (i as f32 * 0.618_034).fract());
            let (dir, pdf) = sampler.sample(u, v);
            assert!((dir.length() - 1.0).abs() < 1e-5);
            assert!((sampler.pdf(dir) / pdf - 1.0).abs() < 1e-3, "{dir}: {} against {pdf}", sampler.pdf(dir));
        }
    }

    #[test]
    fn the_density_integrates_to_one_and_weights_give_the_flux() {
        let environment = gradient(16, 8, 0.0);
        let sampler = EnvironmentSampler::new(&environment).unwrap();
        let (mut mass, mut flux) = (0.0f64, 0.0f64);
        for (texel, radiance) in environment.radiance.iter().enumerate() {
            let omega = f64::from(solid_angle(&environment, texel / 16));
            mass += f64::from(sampler.texel_pdf(texel)) * omega;
            flux += f64::from(radiance.x) * omega;
        }
        assert!((mass - 1.0).abs() < 1e-5, "{mass}");
        let n = 1 << 14;
        let estimate = (0..n)
            .map(|i| {
                let (dir, pdf) = sampler.sample((i as f32 + 0.5) / n as f32, (i as f32 * 0.618_034).fract());
                f64::from(sampler.radiance(dir).x / pdf)
            })
            .sum::<f64>()
            / f64::from(n);
        assert!((estimate / flux - 1.0).abs() < 1e-3, "{estimate} against {flux}");
    }

    #[test]
    fn the_first_column_looks_along_minus_z() {
        let mut environment = gradient(4, 2, 0.0);
        environment.radiance.iter_mut().enumerate().for_each(|(i, c)| *c = Vec3::splat(i as f32));
        let sampler = EnvironmentSampler::new(&environment).unwrap();
        assert_eq!(sampler.radiance(Vec3::new(0.1, 0.5, -1.0).normalize()).x, 0.0);
        assert_eq!(sampler.radiance(Vec3::new(1.0, 0.5, 0.1).normalize()).x, 1.0);
        assert_eq!(sampler.radiance(Vec3::new(-0.1, -0.5, -1.0).normalize()).x, 7.0);
    }
}
