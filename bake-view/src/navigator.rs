//! How a person moves the camera: flying through the scene, or turning about a point of it. Knows no window.
//!
//! Units: metres, radians, seconds. Until it is moved the camera stays exactly the one that was given.

use bake_runtime::Camera;
use glam::{Quat, Vec2, Vec3};

/// Which way of moving.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mode {
    /// The mouse turns the head, keys walk.
    Fly,
    /// The mouse turns the camera about the point in the picture's middle at [`Navigator::distance`].
    Orbit,
}

/// What hands did between two pictures.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Motion {
    /// Keys held: right, up, forward, each −1, 0 or 1.
    pub walk: Vec3,
    /// Whether the key for haste is held.
    pub fast: bool,
    /// Time since the last picture, seconds.
    pub seconds: f32,
    /// Mouse drag with the turning button, as a share of the picture's height; x to the right, y down.
    pub turn: Vec2,
    /// Mouse drag with the shifting button, likewise.
    pub shift: Vec2,
    /// Notches of the wheel, away from the person.
    pub wheel: f32,
}

impl Motion {
    /// Whether time alone moves the camera on.
    pub fn is_walking(&self) -> bool {
        self.walk != Vec3::ZERO
    }
}

/// A camera and how it is moved.
#[derive(Debug, Clone, PartialEq)]
pub struct Navigator {
    /// Where the eye is now.
    pub camera: Camera,
    /// Which way of moving.
    pub mode: Mode,
    /// Metres a second.
    pub speed: f32,
    /// From the eye to the point about which orbits turn, metres.
    pub distance: f32,
    home: Camera,
}

/// Turning by the picture's whole height turns by this much.
const TURN: f32 = std::f32::consts::PI;

/// How near to straight up or down the camera looks.
const STEEPEST: f32 = 89f32 / 180.0 * std::f32::consts::PI;

/// Longest step in time, seconds: a slow picture is no leap through a wall.
const LONGEST: f32 = 0.25;

impl Navigator {
    /// Starts at `camera` in a scene that fills the box.
    pub fn new(camera: Camera, [low, high]: [Vec3; 2]) -> Self {
        let size = (high - low).length().max(1e-3);
        let distance = ((low + high) * 0.5 - camera.eye.as_vec3()).dot(camera.forward);
        let distance = distance.clamp(0.01 * size, 10.0 * size);
        Self { camera, mode: Mode::Fly, speed: 0.2 * size, distance, home: camera }
    }

    /// Back to where it started.
    pub fn go_home(&mut self) {
        self.camera = self.home;
    }

    /// A place in the picture's middle, half as far as the point about which orbits turn.
    pub fn ahead(&self) -> Vec3 {
        self.camera.eye.as_vec3() + self.camera.forward * (0.5 * self.distance)
    }

    /// The other way of moving.
    pub fn toggle_mode(&mut self) {
        self.mode = if self.mode == Mode::Fly { Mode::Orbit } else { Mode::Fly };
    }

    /// Moves the camera.
    pub fn go(&mut self, motion: &Motion) {
        let pivot = self.camera.eye + (self.camera.forward * self.distance).as_dvec3();
        self.turn(motion.turn);
        match self.mode {
            Mode::Fly => self.speed = (self.speed * 1.2f32.powf(motion.wheel)).clamp(1e-3, 1e6),
            Mode::Orbit => {
                self.distance = (self.distance * 0.9f32.powf(motion.wheel)).clamp(1e-3, 1e7);
                if motion.turn != Vec2::ZERO || motion.wheel != 0.0 {
                    self.camera.eye = pivot - (self.camera.forward * self.distance).as_dvec3();
                }
            }
        }
        self.shift(motion.shift);
        self.walk(motion);
    }

    /// Turns the view; to the right and down is positive.
    fn turn(&mut self, by: Vec2) {
        if by == Vec2::ZERO {
            return;
        }
        let (right, _) = self.camera.axes();
        let level = Vec3::Y.cross(right).normalize_or(Vec3::NEG_Z);
        let pitch = self.camera.forward.y.clamp(-1.0, 1.0).asin() - by.y * TURN;
        let pitch = pitch.clamp(-STEEPEST, STEEPEST);
        let level = Quat::from_rotation_y(-by.x * TURN) * level;
        self.camera.forward = (level * pitch.cos() + Vec3::Y * pitch.sin()).normalize();
        self.camera.up = Vec3::Y;
    }

    /// Shifts the eye across the picture, so that what lies at [`Self::distance`] stays under the mouse.
    fn shift(&mut self, by: Vec2) {
        let (right, up) = self.camera.axes();
        let height = 2.0 * (0.5 * self.camera.fov_y).tan() * self.distance;
        self.camera.eye += ((up * by.y - right * by.x) * height).as_dvec3();
    }

    fn walk(&mut self, motion: &Motion) {
        let (right, _) = self.camera.axes();
        let Vec3 { x, y, z } = motion.walk;
        let way = (right * x + Vec3::Y * y + self.camera.forward * z).normalize_or_zero();
        let haste = if motion.fast { 4.0 } else { 1.0 };
        let step = way * (self.speed * haste * motion.seconds.clamp(0.0, LONGEST));
        self.camera.eye += step.as_dvec3();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    fn navigator() -> Navigator {
        let camera = Camera::look_at(DVec3::new(0.0, 1.0, 5.0), DVec3::new(0.0, 1.0, 0.0));
        Navigator::new(camera, [Vec3::new(-2.0, 0.0, -2.0), Vec3::new(2.0, 2.0, 2.0)])
    }

    #[test]
    fn nothing_done_leaves_the_camera_as_it_was_bit_by_bit() {
        for mode in [Mode::Fly, Mode::Orbit] {
            let mut navigator = Navigator { mode, ..navigator() };
            let before = navigator.camera;
            navigator.go(&Motion { seconds: 0.1, fast: true, ..Motion::default() });
            assert_eq!(navigator.camera, before);
        }
    }

    #[test]
    fn keys_walk_where_the_camera_looks_and_home_is_where_it_began() {
        let mut navigator = navigator();
        let start = navigator.camera;
        navigator.speed = 2.0;
        navigator.go(&Motion { walk: Vec3::Z, seconds: 0.2, ..Motion::default() });
        assert!((navigator.camera.eye - DVec3::new(0.0, 1.0, 4.6)).length() < 1e-6, "{}", navigator.camera.eye);
        navigator.go(&Motion { walk: Vec3::X, seconds: 0.2, fast: true, ..Motion::default() });
        assert!((navigator.camera.eye - DVec3::new(1.6, 1.0, 4.6)).length() < 1e-6, "{}", navigator.camera.eye);
        // A second's hiccup is no leap.
        navigator.go(&Motion { walk: Vec3::Y, seconds: 60.0, ..Motion::default() });
        assert!((navigator.camera.eye.y - 1.5).abs() < 1e-6, "{}", navigator.camera.eye);
        navigator.go_home();
        assert_eq!(navigator.camera, start);
    }

    #[test]
    fn flying_turns_the_head_and_never_over_the_top() {
        let mut navigator = navigator();
        let eye = navigator.camera.eye;
        navigator.go(&Motion { turn: Vec2::new(0.5, 0.0), ..Motion::default() });
        assert!(
            (navigator.camera.forward - Vec3::X).length() < 1e-6,
            "a quarter to the right: {}",
            navigator.camera.forward
        );
        for _ in 0..10 {
            navigator.go(&Motion { turn: Vec2::new(0.0, -0.3), ..Motion::default() });
        }
        let forward = navigator.camera.forward;
        assert!(forward.y > 0.999 && forward.x > 0.0, "upright, still to the right: {forward}");
        assert_eq!(navigator.camera.eye, eye);
    }

    #[test]
    fn orbits_keep_their_pivot_and_the_wheel_nears_it() {
        let mut navigator = Navigator { mode: Mode::Orbit, ..navigator() };
        let pivot = |n: &Navigator| n.camera.eye + (n.camera.forward * n.distance).as_dvec3();
        let (before, distance) = (pivot(&navigator), navigator.distance);
        for turn in [Vec2::new(0.3, 0.1), Vec2::new(-0.9, 0.4), Vec2::new(0.2, -2.0)] {
            navigator.go(&Motion { turn, wheel: 1.0, ..Motion::default() });
            assert!((pivot(&navigator) - before).length() < 1e-5, "{}", pivot(&navigator));
        }
        assert!((navigator.distance / distance - 0.9f32.powi(3)).abs() < 1e-6);
        // Dragged to the right, the scene goes to the right: the eye to the left.
        navigator.go_home();
        let right = navigator.camera.axes().0;
        navigator.go(&Motion { turn: Vec2::new(0.1, 0.0), ..Motion::default() });
        assert!((navigator.camera.eye - DVec3::new(0.0, 1.0, 5.0)).as_vec3().dot(right) < 0.0);
    }

    #[test]
    fn what_lies_at_the_distance_stays_under_a_shifting_mouse() {
        let mut navigator = navigator();
        let place = navigator.camera.eye.as_vec3() + navigator.camera.forward * navigator.distance;
        navigator.go(&Motion { shift: Vec2::new(0.25, 0.0), ..Motion::default() });
        let relative = place - navigator.camera.eye.as_vec3();
        let clip = navigator.camera.clip_from_relative(1.0) * relative.extend(1.0);
        assert!((clip.x / clip.w - 0.5).abs() < 1e-5, "a quarter of the height is half of [-1, 1]: {clip}");
    }
}
