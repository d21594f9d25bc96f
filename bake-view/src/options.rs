//! What a person asks to see, as text and as values.

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
    /// A second way to draw the air, for the right half of the picture.
    pub compare: Option<Method>,
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

/// What is shown, by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ViewArgument(pub View);

impl FromStr for ViewArgument {
    type Err = OptionError;

    fn from_str(text: &str) -> Result<Self, OptionError> {
        let expected = "one of light, irradiance, texels, nodes, error, validity";
        Ok(Self(match text {
            "light" => View::Show(Show::Light),
            "irradiance" => View::Show(Show::Irradiance),
            "texels" => View::Show(Show::Texels),
            "nodes" => View::Show(Show::Nodes),
            "error" => View::Error,
            "validity" => View::Validity,
            _ => return Err(OptionError { value: text.into(), expected }),
        }))
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
        assert_eq!("640x360".parse(), Ok(SizeArgument([640, 360])));
        for text in ["640", "0x360", "640x", "99999x3"] {
            assert!(text.parse::<SizeArgument>().is_err(), "{text}");
        }
        for method in Method::ALL {
            assert_eq!(method.name().parse(), Ok(AirArgument(method)));
        }
        assert!("fog".parse::<AirArgument>().is_err() && "fog".parse::<ViewArgument>().is_err());
    }
}
