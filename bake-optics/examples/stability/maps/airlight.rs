//! Air-light of an isotropic lamp in uniform air.

use bake_optics::Real;
use bake_optics::airlight::{Airlight, Oracle, Quadrature, Sight, UniformAir, macklin};
use bake_optics::emitter::Emitter;
use bake_optics::quadrature::GaussLegendre;

use crate::map::{Axis, Map, Pair};

pub fn maps() -> Vec<Map> {
    vec![sun(), macklin()]
}

const LENGTH: f64 = 2.0;

fn sun() -> Map {
    Map {
        name: "airlight",
        title: "Air-light in uniform air",
        text: "A ray of optical length 2 at angle γ from a lamp at optical distance T. Textbook: e^{−T cos γ}/(2π T sin γ) (F(T sin γ, v₂) − F(T sin γ, v₁)) of Sun et al. \
               2005, eq. 11, F by 200 nodes in its angle: values and prefactor leave the number range backwards, the difference cancels near π. Ours: 24 + 24 \
               Gauss–Legendre nodes of positive terms.",
        x: Axis::decades("T", -2.0, 2.5, 28),
        y: Axis::linear("γ, rad", 0.02, 3.12, 20),
        single: Pair { textbook: sun_error::<f32, false>, ours: sun_error::<f32, true> },
        double: Pair { textbook: sun_error::<f64, false>, ours: sun_error::<f64, true> },
    }
}

fn unit_air<T: Real>() -> UniformAir<T> {
    UniformAir { sigma_s: T::one(), sigma_t: T::one(), ..UniformAir::default() }
}

fn sun_error<T: Real, const OURS: bool>(t: f64, gamma: f64) -> f64 {
    let (t, gamma, length) = (T::of(t), T::of(gamma), T::of(LENGTH));
    let exact = Sight::from_angle(gamma.as_f64(), t.as_f64(), LENGTH);
    let want = Oracle::default().radiance(&exact, &Emitter::Isotropic, &unit_air());
    if want < T::min_positive_value().as_f64() {
        return 0.0;
    }
    let got = if OURS {
        Quadrature::new(24).radiance(&Sight::from_angle(gamma, t, length), &Emitter::Isotropic, &unit_air())
    } else {
        textbook(t, gamma, length)
    };
    (got.as_f64() / want - 1.0).abs()
}

fn textbook<T: Real>(t: T, gamma: T, length: T) -> T {
    let half = T::of(0.5);
    let u = t * gamma.sin();
    let f = |v: T| GaussLegendre::<T>::cached(200).integrate(T::zero(), v, |x| (-u * x.tan()).exp());
    let v2 = T::FRAC_PI_4() + half * ((length - t * gamma.cos()) / u).atan();
    (-t * gamma.cos()).exp() / (T::of(2.0) * T::PI() * u) * (f(v2) - f(half * gamma))
}

fn macklin() -> Map {
    Map {
        name: "airlight_vacuum",
        title: "Integral of 1/r² along a ray",
        text: "A ray of length 1 whose start is z past the foot of a lamp h away. Textbook: (atan((z + 1)/h) − atan(z/h))/h, h = sqrt(c − b²) (Macklin 2010). Ours: one \
               atan2 of products, a series for flat angles.",
        x: Axis::decades("h", -6.0, 4.0, 28),
        y: Axis::decades("z", -2.0, 4.0, 16),
        single: Pair { textbook: macklin_error::<f32, false>, ours: macklin_error::<f32, true> },
        double: Pair { textbook: macklin_error::<f64, false>, ours: macklin_error::<f64, true> },
    }
}

fn macklin_error<T: Real, const OURS: bool>(h: f64, z: f64) -> f64 {
    let (h, z, one) = (T::of(h), T::of(z), T::one());
    let got = if OURS {
        macklin::inverse_square_integral(z, h, one)
    } else {
        let h = ((z * z + h * h) - z * z).sqrt();
        (((z + one) / h).atan() - (z / h).atan()) / h
    };
    let (h, z) = (h.as_f64(), z.as_f64());
    // 48 nodes a panel, panels no longer than their distance from the lamp.
    let rule = GaussLegendre::<f64>::cached(48);
    let (mut from, mut want) = (z, 0.0);
    while from < z + 1.0 {
        let to = (from + 0.5 * from.hypot(h)).min(z + 1.0);
        want += rule.integrate(from, to, |s| 1.0 / (s * s + h * h));
        from = to;
    }
    (got.as_f64() / want - 1.0).abs()
}
