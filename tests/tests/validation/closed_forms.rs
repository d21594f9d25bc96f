//! Baked scenes whose light is known exactly, each against its closed form and against a wrong one.
//!
//! Points are spread over a surface; those within the reach of a bilinear filter from an edge of light are left out,
//! since a texel's mean is not the value at a point there. The bake's own variance is subtracted from the squared
//! error: what remains is the texels' size.

use bake_formats::metrics::{self, Metrics};
use bake_formats::sample::Sample;
use bake_tests::ledger::Ledger;
use bake_tests::points::{Point, on_surfaces};
use bake_tests::program::Baked;
use glam::{DVec3, Vec3};

/// Points asked for.
const POINTS: u32 = 4000;
/// Largest bias allowed. A wrong twin is off by 2 %.
const BIAS: f64 = 0.005;
/// Largest relative RMSE allowed, the bake's own variance subtracted.
const RMSE: f64 = 0.02;
/// Texels that a bilinear look-up reaches: one and a half to the far corner's edge, and the slant.
const REACH: f64 = 2.2;
/// Change of light within the reach beyond which a point is left out.
const SMOOTH: f64 = 0.1;

/// Baked and exact light at the same points.
#[derive(Default)]
struct Pairs {
    bake: Vec<Vec3>,
    exact: Vec<Vec3>,
    variance: Vec<Vec3>,
}

impl Pairs {
    fn push(&mut self, sample: Sample, exact: DVec3) {
        self.bake.push(sample.irradiance);
        self.variance.push(sample.variance);
        self.exact.push(exact.as_vec3());
    }

    fn metrics(&self, scale: f32) -> Metrics {
        let exact: Vec<Vec3> = self.exact.iter().map(|value| scale * value).collect();
        metrics::compare(&self.bake, &exact, &vec![true; exact.len()], Some(&self.variance))
    }
}

/// Largest bias of luminance and channels, without its sign.
fn bias(metrics: &Metrics) -> f64 {
    let channels = metrics.channels.iter().map(|error| error.bias.abs());
    channels.fold(metrics.luminance.bias.abs(), f64::max)
}

/// Whether a function of place changes little within the reach of a look-up.
fn is_smooth(point: &Point, exact: &impl Fn(DVec3) -> DVec3) -> bool {
    let here = exact(point.position);
    let change = |place: DVec3| (exact(place) - here).abs().max_element();
    point.around(REACH).chain(point.around(0.5 * REACH)).all(|place| change(place) <= SMOOTH * here.max_element())
}

/// Light on a node's surfaces where the closed form is smooth.
fn on_node(baked: &Baked, node: &str, exact: impl Fn(DVec3) -> DVec3) -> Pairs {
    let sampler = baked.sampler();
    let mut pairs = Pairs::default();
    for point in on_surfaces(&baked.package, POINTS).iter().filter(|point| point.node == node) {
        if is_smooth(point, &exact) {
            let sample = sampler.sample(point.position.as_vec3(), point.normal.as_vec3()).expect("on a surface");
            pairs.push(sample, exact(point.position));
        }
    }
    pairs
}

fn check(name: &str, pairs: &Pairs) {
    let ledger = Ledger::new("Closed forms", name);
    ledger.at_least("points compared", pairs.exact.len() as f64, 200.0);
    let right = pairs.metrics(1.0);
    ledger.at_most("|bias|", bias(&right), BIAS);
    ledger.at_most("relative RMSE", right.luminance.relative_rmse, RMSE);
    ledger.refused("|bias| of a closed form 2 % too bright", bias(&pairs.metrics(1.02)), BIAS);
}

const SMALL: &str = "--page-size 64 --max-pages 1 --samples 256";

#[test]
fn point_light() {
    check("plane_point", &on_node(&Baked::own("plane_point", SMALL), "floor", scenes::plane_point::irradiance));
}

#[test]
fn rectangular_lamp() {
    check("plane_rect", &on_node(&Baked::own("plane_rect", SMALL), "floor", scenes::plane_rect::irradiance));
}

#[test]
fn sun_with_shadow() {
    let baked = Baked::own("plane_sun", SMALL);
    check("plane_sun", &on_node(&baked, "floor", scenes::plane_sun::irradiance));
}

#[test]
fn sky_behind_a_wall() {
    check("plane_sky", &on_node(&Baked::own("plane_sky", SMALL), "floor", scenes::plane_sky::irradiance));
}

#[test]
fn sun_through_sheets() {
    let baked = Baked::own("occluders", "--page-size 128 --max-pages 1 --samples 64");
    check("occluders", &on_node(&baked, "floor", scenes::occluders::irradiance));
}

#[test]
fn furnace() {
    let exact = |bounces| move |_| scenes::furnace::irradiance(bounces);
    let baked = Baked::own("furnace", SMALL);
    check("furnace, walls", &on_node(&baked, "room", exact(None)));
    check("furnace, block", &on_node(&baked, "block", exact(None)));
    let twice = Baked::own("furnace", &format!("{SMALL} --bounces 2"));
    check("furnace, 2 bounces", &on_node(&twice, "room", exact(Some(2))));
    let once_more = bias(&on_node(&twice, "room", exact(Some(3))).metrics(1.0));
    Ledger::new("Closed forms", "furnace, 2 bounces").refused("|bias| against 3 bounces", once_more, BIAS);
}

#[test]
fn concentric_spheres() {
    let baked = Baked::own("spheres", SMALL);
    check("spheres, outer", &on_node(&baked, "outer", |_| scenes::spheres::outer_irradiance(None)));
    check("spheres, inner", &on_node(&baked, "inner", |_| scenes::spheres::inner_irradiance()));
}

/// The mean over all surfaces is exact whatever the shapes; points are many, for light varies much.
#[test]
fn mean_over_a_closed_room() {
    let baked = Baked::own("lit_room", SMALL);
    let sampler = baked.sampler();
    let mut pairs = Pairs::default();
    for point in on_surfaces(&baked.package, 8 * POINTS) {
        let sample = sampler.sample(point.position.as_vec3(), point.normal.as_vec3()).expect("on a surface");
        pairs.push(sample, scenes::lit_room::mean_irradiance(None));
    }
    let ledger = Ledger::new("Closed forms", "lit_room");
    ledger.at_most("|bias| of the mean", bias(&pairs.metrics(1.0)), BIAS);
    ledger.refused("|bias| of the mean 2 % too bright", bias(&pairs.metrics(1.02)), BIAS);
}

/// One mesh placed four times, mirrored by its node, its parent, and both, is lit alike. Each has its own grid of texels,
/// so that places near a hard shadow's edge, where light changes within a look-up's reach, are left out.
#[test]
fn mirrored_instances() {
    let baked = Baked::own("instances", SMALL);
    let sampler = baked.sampler();
    let against = |mirror: DVec3, turn: DVec3| {
        let mut pairs = Pairs::default();
        for point in on_surfaces(&baked.package, POINTS) {
            let place = |v: DVec3| (mirror * v).as_vec3();
            let light = |place: DVec3| sampler.sample(place.as_vec3(), point.normal.as_vec3()).expect("on a surface");
            let here = light(point.position);
            let change = |place: DVec3| (light(place).irradiance - here.irradiance).abs().max_element();
            if point.around(REACH).any(|place| change(place) > 0.3 * here.irradiance.max_element()) {
                continue;
            }
            let Some(there) = sampler.sample(place(point.position + turn), place(point.normal)) else { continue };
            let both = Sample { variance: here.variance + there.variance, ..here };
            pairs.push(both, there.irradiance.as_dvec3());
        }
        assert!(pairs.exact.len() > 200, "{} places", pairs.exact.len());
        pairs.metrics(1.0)
    };
    let ledger = Ledger::new("Closed forms", "instances");
    for (name, mirror) in
        [("x", DVec3::new(-1.0, 1.0, 1.0)), ("z", DVec3::new(1.0, 1.0, -1.0)), ("x and z", DVec3::new(-1.0, 1.0, -1.0))]
    {
        let metrics = against(mirror, DVec3::ZERO);
        ledger.at_most(&format!("|bias| of the image mirrored in {name}"), bias(&metrics), BIAS);
        ledger.at_most(&format!("relative RMSE, mirrored in {name}"), metrics.luminance.relative_rmse, RMSE);
    }
    let shifted = against(DVec3::new(-1.0, 1.0, 1.0), DVec3::new(0.2, 0.0, 0.0));
    ledger.refused("relative RMSE, the image 20 cm aside", shifted.luminance.relative_rmse, RMSE);
}
