//! Shadow maps: which lights have them, and the views that they are drawn with.

use glam::{DVec3, Mat4, Vec3};

use crate::camera::Camera;
use crate::layout::{Lamp, NO_SHADOW, ShadowView, Sun};

/// Most maps of one picture; lights beyond cast no shadow.
pub(crate) const MOST_MAPS: usize = 48;

/// Nearest thing that casts a shadow, metres from the lamp.
const NEAR: f32 = 0.01;

/// A cone wider than this takes a cube of maps.
const WIDEST_CONE: f32 = 2.4;

/// Gives lights their maps; returns the views, positions relative to the eye. `bounds`: box around everything, relative too.
pub(crate) fn assign(lamps: &mut [Lamp], suns: &mut [Sun], bounds: [Vec3; 2]) -> Vec<ShadowView> {
    let mut views = Vec::new();
    for sun in suns {
        if views.len() < MOST_MAPS {
            sun.shadow = views.len() as u32;
            views.push(sun_view(Vec3::from(sun.direction), bounds));
        }
    }
    for lamp in lamps {
        let opening = 2.0 * lamp.cos_outer.clamp(-1.0, 1.0).acos();
        let own = if lamp.shape == 1 && opening < WIDEST_CONE { cone_view(lamp, opening) } else { cube_views(lamp) };
        if views.len() + own.len() <= MOST_MAPS {
            (lamp.shadow, lamp.shadow_count) = (views.len() as u32, own.len() as u32);
            views.extend(own);
        } else {
            lamp.shadow = NO_SHADOW;
        }
    }
    views
}

fn view(clip: Mat4) -> ShadowView {
    ShadowView { clip_from_relative: clip.to_cols_array_2d() }
}

fn perspective(position: Vec3, forward: Vec3, fov_y: f32) -> ShadowView {
    let up = if forward.y.abs() > 0.9 { Vec3::Z } else { Vec3::Y };
    let camera = Camera { eye: DVec3::ZERO, forward, up, fov_y, near: NEAR };
    view(camera.clip_from_relative(1.0) * Mat4::from_translation(-position))
}

fn cone_view(lamp: &Lamp, opening: f32) -> Vec<ShadowView> {
    vec![perspective(lamp.position.into(), lamp.axis.into(), (opening * 1.05).max(0.02))]
}

/// Faces +x, −x, +y, −y, +z, −z, as `face_of` counts them.
fn cube_views(lamp: &Lamp) -> Vec<ShadowView> {
    let faces = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z];
    // A hair wider than the face, so that its edge is inside.
    faces.map(|forward| perspective(lamp.position.into(), forward, std::f32::consts::FRAC_PI_2 * 1.002)).to_vec()
}

/// The whole scene from the sun: x, y across its box, depth 1 at the nearest and 0.1 at the farthest place.
fn sun_view(direction: Vec3, [low, high]: [Vec3; 2]) -> ShadowView {
    let direction = direction.try_normalize().unwrap_or(Vec3::NEG_Y);
    let camera = Camera::look_at(DVec3::ZERO, direction.as_dvec3());
    let (right, up) = camera.axes();
    let (centre, radius) = ((low + high) * 0.5, (0.5 * (high - low).length()).max(1e-3));
    let row = |axis: Vec3, scale: f32, offset: f32| (axis * scale).extend(offset - axis.dot(centre) * scale);
    let depth = row(direction, -0.45 / radius, 0.55);
    let rows = [row(right, 1.0 / radius, 0.0), row(up, 1.0 / radius, 0.0), depth, glam::Vec4::W];
    view(Mat4::from_cols(rows[0], rows[1], rows[2], rows[3]).transpose())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearer_place_has_the_greater_depth_in_every_view() {
        let lamp =
            Lamp { position: [1.0, 2.0, 3.0], axis: [0.0, -1.0, 0.0], cos_outer: 0.8, shape: 1, ..Lamp::default() };
        let mut lamps = [lamp, Lamp { shape: 0, ..lamp }];
        let mut suns = [Sun { direction: [0.6, -0.8, 0.0], ..Sun::default() }];
        let views = assign(&mut lamps, &mut suns, [Vec3::splat(-5.0), Vec3::splat(5.0)]);
        assert_eq!((views.len(), suns[0].shadow, lamps[0].shadow, lamps[1].shadow), (8, 0, 1, 2));
        let depth = |view: &ShadowView, place: Vec3| {
            let clip = Mat4::from_cols_array_2d(&view.clip_from_relative) * place.extend(1.0);
            clip.truncate() / clip.w
        };
        let down = |at: f32| Vec3::new(1.0, 2.0 - at, 3.0);
        for view in [&views[1], &views[2 + 3]] {
            let (near, far) = (depth(view, down(1.0)), depth(view, down(2.0)));
            assert!(near.z > far.z && far.z > 0.0 && near.x.abs() < 1e-5 && near.y.abs() < 1e-5, "{near} {far}");
        }
        let along = Vec3::new(0.6, -0.8, 0.0);
        let (near, far) = (depth(&views[0], along * -4.0), depth(&views[0], along * 4.0));
        assert!(near.z > far.z && near.z < 1.0 && far.z > 0.1, "{near} {far}");
    }
}
