//! What a person asks to see, as text and as values.

use std::fmt;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use bake_formats::Term;
use bake_runtime::{Camera, Method, Show};
use glam::DVec3;

/// What is shown, and how.
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    /// Width and height, texels.
    pub size: [u32; 2],
    /// The camera; none: one that sees the whole scene.
    pub camera: Option<Camera>,
    /// Stops brighter (+) or darker (−) than the exposure that suits the lightmaps.
    pub exposure_stops: f32,
    /// How the air is drawn.
    pub air: Method,
    /// What is shown.
    pub show: View,
    /// Terms of the light that are shown; none: all.
    pub terms: Option<Vec<Term>>,
    /// What the right half of the picture shows instead.
    pub compare: Option<Compare>,
    /// Instead of two halves their difference in false colours, the strongest at this share of what is shown white.
    pub difference: Option<f32>,
    /// Distance from which on instanced clutter is thinned, metres; none: everything is drawn.
    pub prune_start_m: Option<f32>,
    /// File in which the window keeps the list of its widgets and their places.
    pub widgets: Option<PathBuf>,
}

/// What a package is compared with.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Compare {
    /// Itself, its air drawn in another way.
    Method(Method),
    /// Another package, by its folder.
    Package(PathBuf),
}

/// What is shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum View {
    /// Light, or geometry.
    Show(Show),
    /// The lightmap's standard error, white at 10 % of the light.
    Error,
    /// Baked texels white, filled ones black.
    Validity,
}

impl View {
    /// All of them, light first.
    pub const ALL: [Self; 8] = [
        Self::Show(Show::Light),
        Self::Show(Show::Irradiance),
        Self::Show(Show::Texels),
        Self::Show(Show::Density),
        Self::Show(Show::Charts),
        Self::Show(Show::Nodes),
        Self::Error,
        Self::Validity,
    ];

    /// Its name as flags and panels spell it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Show(Show::Light) => "light",
            Self::Show(Show::Irradiance) => "irradiance",
            Self::Show(Show::Texels) => "texels",
            Self::Show(Show::Density) => "density",
            Self::Show(Show::Charts) => "charts",
            Self::Show(Show::Nodes) => "nodes",
            Self::Error => "error",
            Self::Validity => "validity",
        }
    }
}

impl Default for Options {
    fn default() -> Self {
        Self {
            size: [1280, 720],
            camera: None,
            exposure_stops: 0.0,
            air: Method::Quadrature,
            show: View::Show(Show::Light),
            terms: None,
            compare: None,
            difference: None,
            prune_start_m: None,
            widgets: None,
        }
    }
}

/// Text that is not what it should be.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("'{value}' is not {expected}")]
pub struct OptionError {
    value: String,
    expected: &'static str,
}

/// A size, `1280x720`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SizeArgument(pub [u32; 2]);

impl FromStr for SizeArgument {
    type Err = OptionError;

    fn from_str(text: &str) -> Result<Self, OptionError> {
        let expected = "WIDTHxHEIGHT, each from 1 to 16384, like 1280x720";
        let side = |side: &str| side.parse().ok().filter(|side| (1..=16_384).contains(side));
        let parsed = text.split_once('x').and_then(|(w, h)| Some(Self([side(w)?, side(h)?])));
        parsed.ok_or_else(|| OptionError { value: text.into(), expected })
    }
}

/// A way to draw the air, by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct AirArgument(pub Method);

impl FromStr for AirArgument {
    type Err = OptionError;

    fn from_str(text: &str) -> Result<Self, OptionError> {
        let expected = "one of none, vacuum, lut, closed_form, quadrature, ray_march";
        Method::from_name(text).map(Self).ok_or_else(|| OptionError { value: text.into(), expected })
    }
}

/// What a package is compared with: a way to draw the air by name, or a folder.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CompareArgument(pub Compare);

impl FromStr for CompareArgument {
    type Err = OptionError;

    fn from_str(text: &str) -> Result<Self, OptionError> {
        let expected = "the folder of a package, nor one of none, vacuum, lut, closed_form, quadrature, ray_march";
        let package = || Path::new(text).exists().then(|| Compare::Package(text.into()));
        let found = Method::from_name(text).map(Compare::Method).or_else(package);
        found.map(Self).ok_or_else(|| OptionError { value: text.into(), expected })
    }
}

/// What is shown, by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ViewArgument(pub View);

impl FromStr for ViewArgument {
    type Err = OptionError;

    fn from_str(text: &str) -> Result<Self, OptionError> {
        let expected = "one of light, irradiance, texels, density, charts, nodes, error, validity";
        let found = View::ALL.into_iter().find(|view| view.name() == text);
        found.map(Self).ok_or_else(|| OptionError { value: text.into(), expected })
    }
}

/// Terms of the light, divided by commas.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TermsArgument(pub Vec<Term>);

impl FromStr for TermsArgument {
    type Err = OptionError;

    fn from_str(text: &str) -> Result<Self, OptionError> {
        let term = |name: &str| Term::ALL.into_iter().find(|term| term.name() == name.trim());
        let terms = text.split(',').map(term).collect::<Option<_>>().map(Self);
        let expected = "a list of terms like direct,single (direct, indirect, single, multiple)";
        terms.ok_or_else(|| OptionError { value: text.into(), expected })
    }
}

/// A camera, `EYE:TARGET` or `EYE:TARGET:HEIGHT_DEG`, points as `x,y,z` in metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CameraArgument(pub Camera);

impl FromStr for CameraArgument {
    type Err = OptionError;

    fn from_str(text: &str) -> Result<Self, OptionError> {
        let expected = "EYE:TARGET or EYE:TARGET:DEGREES, like 0,1.5,6:0,1.5,0:40 (two different points in metres)";
        parse_camera(text).map(Self).ok_or_else(|| OptionError { value: text.into(), expected })
    }
}

impl fmt::Display for CameraArgument {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Camera { eye, forward, fov_y, .. } = self.0;
        let target = eye + forward.as_dvec3();
        write!(f, "{},{},{}:{},{},{}:{}", eye.x, eye.y, eye.z, target.x, target.y, target.z, fov_y.to_degrees())
    }
}

fn parse_camera(text: &str) -> Option<Camera> {
    let mut parts = text.split(':');
    let (eye, target) = (point(parts.next()?)?, point(parts.next()?)?);
    if eye == target {
        return None;
    }
    let mut camera = Camera::look_at(eye, target);
    if let Some(height) = parts.next() {
        let degrees: f32 = height.parse().ok().filter(|degrees| (1.0..=170.0).contains(degrees))?;
        camera.fov_y = degrees.to_radians();
    }
    parts.next().is_none().then_some(camera)
}

fn point(text: &str) -> Option<DVec3> {
    let numbers: Vec<f64> = text.split(',').map(|n| n.trim().parse().ok()).collect::<Option<_>>()?;
    let [x, y, z] = numbers[..] else { return None };
    DVec3::new(x, y, z).is_finite().then_some(DVec3::new(x, y, z))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cameras_and_sizes_are_read_and_nonsense_is_refused_with_the_right_form() {
        let CameraArgument(camera) = "1,2,3:1,2,-5:90".parse().expect("a camera");
        assert_eq!((camera.eye, camera.forward), (DVec3::new(1.0, 2.0, 3.0), glam::Vec3::NEG_Z));
        assert!((camera.fov_y.to_degrees() - 90.0).abs() < 1e-4);
        for text in ["", "1,2:3,4,5", "1,2,3:1,2,3", "1,2,3:4,5,6:200", "1,2,3:4,5,6:50:7", "1,2,nan:4,5,6"] {
            let error = text.parse::<CameraArgument>().expect_err(text);
            assert!(error.to_string().contains("EYE:TARGET"), "{error}");
        }
        let mut odd = Camera::look_at(DVec3::new(0.1, -7.25, 1e3 / 3.0), DVec3::new(-4.0, 0.3, 12.0));
        odd.fov_y = 0.9;
        let CameraArgument(again) = CameraArgument(odd).to_string().parse().expect("what is written is read");
        assert_eq!((again.eye, again.up), (odd.eye, odd.up));
        assert!((again.forward - odd.forward).length() < 1e-6 && (again.fov_y - odd.fov_y).abs() < 1e-6);
        assert_eq!("640x360".parse(), Ok(SizeArgument([640, 360])));
        for text in ["640", "0x360", "640x", "99999x3"] {
            assert!(text.parse::<SizeArgument>().is_err(), "{text}");
        }
        for method in Method::ALL {
            assert_eq!(method.name().parse(), Ok(AirArgument(method)));
            assert!("fog".parse::<AirArgument>().expect_err("no method").expected.contains(method.name()));
            assert!("fog".parse::<CompareArgument>().expect_err("no method").expected.contains(method.name()));
        }
        for view in View::ALL {
            assert_eq!(view.name().parse(), Ok(ViewArgument(view)));
            assert!("fog".parse::<ViewArgument>().expect_err("no view").expected.contains(view.name()));
        }
        assert_eq!("lut".parse(), Ok(CompareArgument(Compare::Method(Method::Lut))));
        assert_eq!("src".parse(), Ok(CompareArgument(Compare::Package("src".into()))));
    }
}
