//! Air with borders: rays whose way to the lamp passes corners and flanks of a medium's bounds.

use bake_optics::airlight::{Air, Airlight, MediumAlong, Oracle, PathPoint, Quadrature, Sight};
use bake_optics::emitter::Emitter;
use bake_optics::medium::{Bounds, Density, Medium, MediumSet, Ray, Scatter};
use bake_optics::phase::{Deflection, Phase};
use glam::{DVec3, DVec4};
use testkit::compare::{Worst, relative_error};

fn octahedron() -> Bounds {
    let normals = (0..8).map(|i| DVec3::from_array([1, 2, 4].map(|bit| if i & bit == 0 { 1.0 } else { -1.0 })));
    Bounds::Hull(normals.map(|n| n.normalize().extend(1.2)).collect::<Vec<DVec4>>().into())
}

fn media() -> Vec<(&'static str, Medium)> {
    let corner = DVec3::new(1.5, 1.0, 2.0);
    let of = |density, bounds| Medium {
        bounds,
        density,
        scatter: Scatter { sigma_s: [1.5; 3], sigma_a: [0.5; 3] },
        phase: Phase::HenyeyGreenstein { g: 0.5 },
    };
    let layer = Density::Exponential { base_m: 0.0, scale_height_m: 1.0 };
    let linear = Density::Linear { zero_m: 0.3, slope_per_m: -1.0 };
    vec![
        ("ball", of(Density::Uniform, Bounds::Sphere { centre: DVec3::new(0.2, 0.1, 0.0), radius: 1.3 })),
        ("box", of(layer, Bounds::Box { min: -corner, max: corner })),
        ("linear box", of(linear.clone(), Bounds::Box { min: -corner, max: corner })),
        ("octahedron", of(Density::Uniform, octahedron())),
        ("linear", of(linear, Bounds::Unbounded)),
    ]
}

/// A medium in thin air without end, so that light from beside it passes it, too.
fn in_thin_air(medium: Medium) -> MediumSet {
    let scatter = Scatter { sigma_s: [0.1; 3], sigma_a: [0.0; 3] };
    MediumSet { media: vec![medium, Medium { scatter, ..Medium::default() }] }
}

/// Rays past and through the media, lamps outside and inside.
fn views() -> Vec<(Ray, DVec3)> {
    let lamps = [DVec3::new(0.7, 2.6, -0.4), DVec3::new(-2.2, 0.3, 1.9), DVec3::new(0.3, 0.4, 0.1)];
    let eyes = [DVec3::new(-4.0, -0.6, 0.3), DVec3::new(-3.0, -2.0, -2.5), DVec3::new(0.1, -0.2, 0.3)];
    let towards = DVec3::new(2.5, -0.9, 0.2);
    let rays = eyes.map(|eye| Ray::new(eye, (towards - eye).normalize(), 7.5));
    rays.into_iter().flat_map(|ray| lamps.map(|lamp| (ray, lamp))).collect()
}

/// The same air without the kinks.
struct Unsplit<'a>(MediumAlong<'a>);
impl Air<f64> for Unsplit<'_> {
    fn common_transmittance(&self, sight: &Sight<f64>) -> f64 {
        self.0.common_transmittance(sight)
    }
    fn transmittance(&self, point: &PathPoint<f64>) -> f64 {
        self.0.transmittance(point)
    }
    fn scattering(&self, s: f64, deflection: Deflection<f64>) -> f64 {
        self.0.scattering(s, deflection)
    }
    fn end(&self, sight: &Sight<f64>, from: f64, depth: f64) -> f64 {
        self.0.end(sight, from, depth)
    }
}

/// Light of the whole ray against the sum of its parts, cut at places that have nothing to do with the kinks.
#[test]
fn parts_add_up_to_the_whole_ray() {
    let mut worst = Worst::new("oracle: parts of the ray against the whole", 1e-13);
    for (name, medium) in media() {
        let set = in_thin_air(medium);
        for (ray, lamp) in views() {
            let light = |part: Ray| {
                let along = MediumAlong::new(&set, 0, part, lamp);
                Oracle::default().radiance(&along.sight(DVec3::Y), &Emitter::Isotropic, &along)
            };
            let whole = light(ray);
            let cuts = [0.0, 1.03, 2.71, 3.3, 4.77, ray.length];
            let parts = cuts.windows(2).map(|ends| {
                let before = Ray { length: ends[0], ..ray };
                set.transmittance(&before)[0] * light(Ray::new(ray.at(ends[0]), ray.dir, ends[1] - ends[0]))
            });
            worst.relative(parts.sum(), whole, || format!("{name} {ray:?} {lamp}"));
        }
    }
    worst.check();
}

#[test]
fn known_kinks_are_worth_digits() {
    // Beside a flank the light goes as a square root of the distance from it, which no polynomial rule follows.
    let mut split = Worst::new("quadrature 48+48, flanks of a ball known, against the oracle", 5e-5);
    let mut corners = Worst::new("quadrature 48+48, corners known, against the oracle", 1e-12);
    let mut unsplit = Worst::new("quadrature 48+48, kinks not known (negative control)", 1e-4);
    for (name, medium) in media() {
        let set = in_thin_air(medium);
        for (ray, lamp) in views() {
            let along = MediumAlong::new(&set, 0, ray, lamp);
            let sight = along.sight(DVec3::Y);
            let want = Oracle::default().radiance(&sight, &Emitter::Isotropic, &along);
            let method = Quadrature::new(48);
            let place = || format!("{name} {ray:?} {lamp}");
            let got = method.radiance(&sight, &Emitter::Isotropic, &along);
            if name == "ball" { &mut split } else { &mut corners }.relative(got, want, place);
            unsplit.relative(method.radiance(&sight, &Emitter::Isotropic, &Unsplit(along)), want, place);
        }
    }
    split.check();
    corners.check();
    assert!(!unsplit.holds(), "the kinks must matter: {}", unsplit.measured());
}

/// A ball seen from the lamp: the way first touches it where the tangent meets the ray.
#[test]
fn kinks_lie_where_geometry_puts_them() {
    let ball = Bounds::Sphere { centre: DVec3::new(0.0, 1.0, 0.0), radius: 0.5 };
    let set = MediumSet { media: vec![Medium { bounds: ball, ..media()[0].1.clone() }] };
    let ray = Ray::new(DVec3::new(-5.0, 0.0, 0.0), DVec3::X, 10.0);
    // Lamp 1 above the centre: tangents at asin(0.5) = 30° from the vertical, 2 above the ray.
    let along = MediumAlong::new(&set, 0, ray, DVec3::new(0.0, 2.0, 0.0));
    let reach = 2.0 * 30f64.to_radians().tan();
    assert_eq!(along.breaks().len(), 2);
    for (got, want) in along.breaks().iter().zip([5.0 - reach, 5.0 + reach]) {
        assert!(relative_error(*got, want) < 1e-14, "{got} {want}");
    }
    // A box from (-1, 0.5) to (1, 1): its lower corners, then its upper ones, all seen from the lamp.
    let square = Bounds::Box { min: DVec3::new(-1.0, 0.5, -1.0), max: DVec3::new(1.0, 1.0, 1.0) };
    let set = MediumSet { media: vec![Medium { bounds: square, ..media()[0].1.clone() }] };
    let along = MediumAlong::new(&set, 0, ray, DVec3::new(0.0, 2.0, 0.0));
    let want = [5.0 - 2.0, 5.0 - 4.0 / 3.0, 5.0 + 4.0 / 3.0, 5.0 + 2.0];
    assert_eq!(along.breaks().len(), 4);
    along.breaks().iter().zip(want).for_each(|(got, want)| assert!(relative_error(*got, want) < 1e-14, "{got} {want}"));
}
