use super::*;
use crate::quadrature::GaussLegendre;
use testkit::compare::Worst;

fn all() -> Vec<(&'static str, Phase<f64>)> {
    vec![
        ("isotropic", Phase::Isotropic),
        ("linear", Phase::Linear { a1: -0.7 }),
        ("rayleigh", Phase::Rayleigh),
        ("hg 0.5", Phase::HenyeyGreenstein { g: 0.5 }),
        ("hg -0.8", Phase::HenyeyGreenstein { g: -0.8 }),
        ("legendre", Phase::Legendre(vec![1.0, 0.9, 0.4, 0.1])),
    ]
}

#[test]
fn moments_agree_with_quadrature() {
    let rule = GaussLegendre::<f64>::cached(200);
    let mut worst = Worst::new("phase moments (absolute)", 1e-14);
    for (name, phase) in all() {
        for l in 0..12 {
            let integral = rule.integrate(-1.0, 1.0, |mu| phase.eval(mu) * legendre::legendre(l, mu));
            worst.record((2.0 * std::f64::consts::PI * integral - phase.moment(l)).abs(), || format!("{name} l {l}"));
        }
    }
    worst.check();
}
