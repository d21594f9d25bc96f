//! The values of flags that are more than a number or a name, from text. Ranges are judged with the settings.

use bake_core::settings::{
    Bounds, Density, EffectName, Env, FogVolume, Medium, Node, Phase, Probes, Rgb, Scatter, Sun, Unlit, suggest,
};
use std::ops::RangeInclusive;
use std::path::PathBuf;
use std::str::FromStr;

/// A value, or `none`, which takes the setting back.
#[derive(Debug, Clone, PartialEq)]
pub struct Given<T>(pub Option<T>);

impl<T> From<Given<T>> for Option<T> {
    fn from(given: Given<T>) -> Self {
        given.0
    }
}

/// Allows `none` besides what `parse` takes.
pub fn optional<T>(
    parse: impl Fn(&str) -> Result<T, String> + Clone,
) -> impl Fn(&str) -> Result<Given<T>, String> + Clone {
    move |text| if text == "none" { Ok(Given(None)) } else { parse(text).map(|value| Given(Some(value))) }
}

/// Any text.
pub fn text(text: &str) -> Result<String, String> {
    Ok(text.to_owned())
}

/// A value without parts.
pub trait Plain: FromStr {
    /// What its text looks like.
    const FORM: &'static str;
}

impl Plain for f32 {
    const FORM: &'static str = "a number like 0.5";
}

impl Plain for f64 {
    const FORM: &'static str = f32::FORM;
}

impl Plain for u32 {
    const FORM: &'static str = "a whole number like 16, from 0 to 4294967295";
}

impl Plain for bool {
    const FORM: &'static str = "true or false";
}

/// A plain value.
pub fn plain<T: Plain>(text: &str) -> Result<T, String> {
    text.trim().parse().map_err(|_| not(text, T::FORM))
}

/// The refusal of a text that has not the form that belongs here.
fn not(text: &str, form: &str) -> String {
    format!("`{text}` is not {form}")
}

/// A share: `0.015` or `1.5%`.
pub fn share(text: &str) -> Result<f32, String> {
    let share = match text.strip_suffix('%') {
        Some(percent) => plain(percent).map(|percent: f32| percent / 100.0),
        None => plain(text),
    };
    share.map_err(|_| not(text, "a share like 0.015 or 1.5%"))
}

/// `EFFECT=on` or `EFFECT=off`.
pub fn forced(text: &str) -> Result<(EffectName, bool), String> {
    let (name, state) = text.split_once('=').ok_or(format!("`{text}` is no EFFECT=on or EFFECT=off"))?;
    let names = EffectName::ALL.map(|(name, _)| name);
    let known = EffectName::ALL.iter().find(|(known, _)| *known == name);
    let (_, effect) = known.ok_or_else(|| format!("unknown effect `{name}`; {}", suggest(name, &names)))?;
    match state {
        "on" => Ok((*effect, true)),
        "off" => Ok((*effect, false)),
        _ => Err(format!("`{state}` is neither `on` nor `off`")),
    }
}

/// A duration in seconds, or with a unit: `90`, `90s`, `10m`, `2h`.
pub fn seconds(text: &str) -> Result<f64, String> {
    let units = [("s", 1.0), ("m", 60.0), ("h", 3600.0)];
    let seconds = match units.iter().find_map(|(unit, factor)| Some((text.strip_suffix(unit)?, factor))) {
        Some((value, factor)) => plain(value).map(|value: f64| value * factor),
        None => plain(text),
    };
    seconds.map_err(|_| not(text, "a time like 90, 90s, 10m or 2h"))
}

/// A colour: one value for all channels, or three divided by `/` (or `,`).
pub fn rgb(text: &str) -> Result<Rgb, String> {
    let channels: Vec<f32> = text.split(['/', ',']).map(plain).collect::<Result<_, _>>().unwrap_or_default();
    match *channels {
        [value] => Ok([value; 3]),
        [r, g, b] => Ok([r, g, b]),
        _ => Err(not(text, "one value for all channels, like 0.5, or three, like 0.5/0.4/0.3")),
    }
}

/// The parts of `key=value,key=value`; every key is one of `allowed`.
fn pairs<'a>(text: &'a str, allowed: &[&str]) -> Result<Vec<(&'a str, &'a str)>, String> {
    let pair = |part: &'a str| {
        let (key, value) = part.split_once('=').ok_or(format!("`{part}` is no key=value"))?;
        match allowed.contains(&key) {
            true => Ok((key, value)),
            false => Err(format!("unknown key `{key}`; {}", suggest(key, allowed))),
        }
    };
    text.split(',').map(pair).collect()
}

/// The value of a key that must be there.
fn required<T>(value: Option<T>, key: &str) -> Result<T, String> {
    value.ok_or_else(|| format!("`{key}=…` is missing"))
}

/// `azimuth_deg=120,elevation_deg=35,lux=80000[,colour=…,angular_diameter_deg=…]`.
pub fn sun(text: &str) -> Result<Sun, String> {
    let (mut azimuth, mut elevation, mut lux) = (None, None, None);
    let (mut colour, mut diameter) = ([1.0; 3], Sun::SOLAR_DIAMETER_DEG);
    for (key, value) in pairs(text, &["azimuth_deg", "elevation_deg", "lux", "colour", "angular_diameter_deg"])? {
        match key {
            "azimuth_deg" => azimuth = Some(plain(value)?),
            "elevation_deg" => elevation = Some(plain(value)?),
            "lux" => lux = Some(plain(value)?),
            "colour" => colour = rgb(value)?,
            _ => diameter = plain(value)?,
        }
    }
    Ok(Sun {
        azimuth_deg: required(azimuth, "azimuth_deg")?,
        elevation_deg: required(elevation, "elevation_deg")?,
        lux: required(lux, "lux")?,
        colour,
        angular_diameter_deg: diameter,
    })
}

/// `FILE[,rotation_deg=90,scale=1]`.
pub fn env(text: &str) -> Result<Env, String> {
    let first_key = [",rotation_deg=", ",scale="].iter().filter_map(|key| text.find(key)).min();
    let (file, rest) = first_key.map_or((text, ""), |at| (&text[..at], &text[at + 1..]));
    let mut env = Env { file: PathBuf::from(file), rotation_deg: 0.0, scale: 1.0 };
    if !rest.is_empty() {
        for (key, value) in pairs(rest, &["rotation_deg", "scale"])? {
            match key {
                "rotation_deg" => env.rotation_deg = plain(value)?,
                _ => env.scale = plain(value)?,
            }
        }
    }
    Ok(env)
}

/// `NODE=FILE`.
pub fn ies(text: &str) -> Result<(String, PathBuf), String> {
    match text.split_once('=') {
        Some((node, file)) if !node.is_empty() && !file.is_empty() => Ok((node.into(), file.into())),
        _ => Err(format!("`{text}` is no NODE=FILE")),
    }
}

/// `black`, `reflect` or `emit=CD_PER_M2`.
pub fn unlit(text: &str) -> Result<Unlit, String> {
    match (text, text.strip_prefix("emit=")) {
        ("black", _) => Ok(Unlit::Black),
        ("reflect", _) => Ok(Unlit::Reflect),
        (_, Some(radiance)) => plain(radiance).map(Unlit::Emit),
        _ => Err("known are black, reflect, emit=CD_PER_M2".into()),
    }
}

/// `NODE:texels_per_m=64,lightmap=true`.
pub fn node(text: &str) -> Result<(String, Node), String> {
    let (name, rest) = text.rsplit_once(':').ok_or(format!("`{text}` is no NODE:key=value"))?;
    let mut node = Node::default();
    for (key, value) in pairs(rest, &["texels_per_m", "lightmap"])? {
        match key {
            "texels_per_m" => node.texels_per_m = Some(plain(value)?),
            _ => node.lightmap = Some(plain(value)?),
        }
    }
    Ok((name.to_owned(), node))
}

/// Metres between probes; or `spacing_m=1[,bounds=x0:y0:z0:x1:y1:z1]`, `spacing_m=1,origin=x:y:z,count=x:y:z`,
/// `spacing_m=1,points=x:y:z/x:y:z`, each with `visibility=true`.
pub fn probes(text: &str) -> Result<Probes, String> {
    let mut probes = Probes::default();
    if !text.contains('=') {
        let spacing_m = plain(text)
            .map_err(|_| not(text, "a distance in metres, like 0.5, or a record like spacing_m=0.5,visibility=true"))?;
        return Ok(Probes { spacing_m, ..probes });
    }
    for (key, value) in pairs(text, &["spacing_m", "bounds", "origin", "count", "points", "visibility"])? {
        match key {
            "spacing_m" => probes.spacing_m = plain(value)?,
            "bounds" => probes.bounds = corners(value)?,
            "origin" => probes.origin = Some(triple(value)?),
            "count" => probes.count = Some(triple(value)?),
            "points" => probes.points = value.split('/').map(triple).collect::<Result<_, _>>()?,
            _ => probes.visibility = plain(value)?,
        }
    }
    Ok(probes)
}

/// Size of the cells of a fog volume, metres.
pub fn fog_volume(text: &str) -> Result<FogVolume, String> {
    let spacing_m = if text.is_empty() { None } else { Some(plain(text)?) };
    Ok(FogVolume { spacing_m })
}

/// `x:y:z`.
fn triple<T: Plain>(text: &str) -> Result<[T; 3], String> {
    let numbers = text.split(':').map(plain).collect::<Result<Vec<T>, _>>()?;
    numbers.try_into().map_err(|_| format!("`{text}`: three numbers belong here, divided by `:`"))
}

/// `sigma_t=0.5,albedo=0.9[,g=0.3,bounds=x0:y0:z0:x1:y1:z1]`: one uniform medium.
pub fn fog(text: &str) -> Result<Vec<Medium>, String> {
    let (mut sigma_t, mut albedo) = (None, None);
    let (mut phase, mut bounds) = (Phase::Isotropic, Bounds::Scene);
    for (key, value) in pairs(text, &["sigma_t", "albedo", "g", "bounds"])? {
        match key {
            "sigma_t" => sigma_t = Some(rgb(value)?),
            "albedo" => albedo = Some(rgb(value)?),
            "g" => phase = Phase::HenyeyGreenstein(within("g", [plain(value)?], -0.999..=0.999)?[0]),
            _ => bounds = corners(value)?,
        }
    }
    let sigma_t = within("sigma_t", required(sigma_t, "sigma_t")?, 0.0..=1e6)?;
    let albedo = within("albedo", required(albedo, "albedo")?, 0.0..=1.0)?;
    let s = std::array::from_fn(|channel| sigma_t[channel] * albedo[channel]);
    let a = std::array::from_fn(|channel| sigma_t[channel] * (1.0 - albedo[channel]));
    let scatter = Scatter::Sigma { s, a };
    Ok(vec![Medium { name: "fog".into(), bounds, density: Density::Uniform, scatter, phase }])
}

/// Values of a key, each within a range.
fn within<const N: usize>(key: &str, values: [f32; N], allowed: RangeInclusive<f32>) -> Result<[f32; N], String> {
    match values.iter().find(|value| !allowed.contains(value)) {
        None => Ok(values),
        Some(value) => Err(format!("`{key}` is {value}; allowed is {} to {}", allowed.start(), allowed.end())),
    }
}

/// `x0:y0:z0:x1:y1:z1`, metres.
fn corners(text: &str) -> Result<Bounds, String> {
    let numbers: Vec<f32> = text.split(':').map(plain).collect::<Result<_, _>>()?;
    match *numbers {
        [x0, y0, z0, x1, y1, z1] => Ok(Bounds::Box { min: [x0, y0, z0], max: [x1, y1, z1] }),
        _ => Err(format!("`{text}` is no x0:y0:z0:x1:y1:z1")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_and_shares() {
        assert_eq!(share("1.5%"), Ok(0.015));
        assert_eq!(share("0.015"), Ok(0.015));
        assert_eq!(
            [seconds("90"), seconds("90s"), seconds("1.5m"), seconds("2h")].map(Result::unwrap),
            [90.0, 90.0, 90.0, 7200.0]
        );
        for wrong in ["", "m", "10 parsecs", "1:30"] {
            assert!(seconds(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn effects_are_forced_by_name() {
        assert_eq!(forced("multiple=off"), Ok((EffectName::Multiple, false)));
        assert!(forced("multipel=off").unwrap_err().contains("did you mean `multiple`?"));
        assert!(forced("colour=maybe").unwrap_err().contains("neither"));
        assert!(forced("colour").unwrap_err().contains("EFFECT=on"));
    }

    #[test]
    fn colours() {
        assert_eq!(rgb("2"), Ok([2.0; 3]));
        assert_eq!(rgb("1/2/3"), Ok([1.0, 2.0, 3.0]));
        assert_eq!(rgb("1,2,3"), Ok([1.0, 2.0, 3.0]));
        for wrong in ["", "1/2", "1/2/3/4", "red"] {
            assert!(rgb(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn records_name_what_is_missing_or_unknown() {
        assert!(sun("azimuth_deg=1,elevation_deg=2").unwrap_err().contains("lux"));
        assert!(sun("azimut_deg=1").unwrap_err().contains("did you mean `azimuth_deg`?"));
        assert!(sun("90").unwrap_err().contains("key=value"));
        assert!(fog("albedo=0.9").unwrap_err().contains("sigma_t"));
        assert!(fog("sigma_t=1,albedo=2").unwrap_err().contains("`albedo` is 2; allowed is 0 to 1"));
        assert!(fog("sigma_t=1/nan/1,albedo=1").unwrap_err().contains("`sigma_t` is NaN; allowed is 0 to 1000000"));
        assert!(fog("sigma_t=1,albedo=1,bounds=1:2:3").is_err());
        assert!(node("Statue").is_err());
        assert!(ies("Lamp").is_err());
    }

    #[test]
    fn probes_stand_in_a_box_or_by_hand() {
        let spaced = Probes { spacing_m: 0.5, ..Probes::default() };
        assert_eq!(probes("0.5"), Ok(spaced.clone()));
        assert_eq!(probes("spacing_m=0.5,visibility=true"), Ok(Probes { visibility: true, ..spaced.clone() }));
        let bounds = Bounds::Box { min: [0.0; 3], max: [1.0, 2.0, 3.0] };
        assert_eq!(probes("spacing_m=0.5,bounds=0:0:0:1:2:3"), Ok(Probes { bounds, ..spaced.clone() }));
        let points = vec![[0.0, 1.5, -1.0], [2.0, 1.5, 3.0]];
        let listed = Probes { points, ..spaced.clone() };
        assert_eq!(probes("spacing_m=0.5,points=0:1.5:-1/2:1.5:3"), Ok(listed));
        let by_hand = Probes { origin: Some([1.0, 0.0, -1.0]), count: Some([2, 3, 4]), ..spaced };
        assert_eq!(probes("spacing_m=0.5,origin=1:0:-1,count=2:3:4"), Ok(by_hand));
        for wrong in
            ["", "x", "spacing_m=1,count=1:2", "spacing=1", "spacing_m=1,points=0:1/0:1:2", "spacing_m=1,points="]
        {
            assert!(probes(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn environment_files_may_hold_commas() {
        let env = env("a,b.hdr,scale=2,rotation_deg=90").expect("valid");
        assert_eq!((env.file, env.scale, env.rotation_deg), ("a,b.hdr".into(), 2.0, 90.0));
    }

    #[test]
    fn fog_splits_extinction_by_albedo() {
        let media = fog("sigma_t=1/2/4,albedo=0.75,g=0.3,bounds=0:0:0:1:2:3").expect("valid");
        let scatter = Scatter::Sigma { s: [0.75, 1.5, 3.0], a: [0.25, 0.5, 1.0] };
        let bounds = Bounds::Box { min: [0.0; 3], max: [1.0, 2.0, 3.0] };
        assert_eq!((&media[0].scatter, &media[0].bounds), (&scatter, &bounds));
        assert_eq!(media[0].phase, Phase::HenyeyGreenstein(0.3));
    }
}
