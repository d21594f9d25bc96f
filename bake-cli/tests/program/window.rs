//! `bake view` as a person uses it: a window on a virtual display, keys and mouse, compared with pictures without a window.

use std::time::Duration;

use crate::bake::{Desk, Ended};
use crate::person::{Display, ESCAPE, Pixels, Seen, TAB};

const CAMERA: &str = "--camera 0,1.5,6.2:0,1.5,0:38";

/// The window paints the very bytes; one step of 255 is left to displays that round.
pub const SAME: f64 = 1.0;

/// Other pictures differ by several times that much.
pub const OTHER: f64 = 4.0;

/// A display and a baked room, or a counted skip.
fn room() -> Option<(Display, Desk)> {
    baked(Desk::with_room(), "sigma_t=0.5,albedo=0.9")
}

/// A display and a desk whose room is baked in a medium, or a counted skip.
pub fn baked(desk: Desk, fog: &str) -> Option<(Display, Desk)> {
    let Some(display) = Display::start() else {
        testkit::reference::skip("no Xvfb for a window (Debian: xvfb)");
        return None;
    };
    let baked = desk.bake(&format!("-q run room.glb --quality preview --texels-per-m 2 --samples 16 --fog {fog}"));
    assert!(matches!(baked.code, Some(0 | 3)), "{baked:#?}");
    let first = desk.bake("view room.bake --screenshot first.png --size 8x8");
    if first.err.contains("no graphics adapter") {
        testkit::reference::skip("no graphics adapter");
        return None;
    }
    first.expect(0, &[]);
    Some((display, desk))
}

/// The picture without a window.
pub fn picture(desk: &Desk, size: [u32; 2], flags: &str) -> Pixels {
    let [width, height] = size;
    desk.bake(&format!("view room.bake --screenshot still.png --size {width}x{height} {flags}")).expect(0, &[]);
    Pixels::read(&desk.path("still.png"))
}

#[track_caller]
fn shows(window: &mut Seen, what: &str, picture: &Pixels) {
    window.until(what, |seen| seen.distance(picture) < SAME);
}

#[test]
fn a_person_walks_looks_and_closes_and_sees_what_pictures_without_a_window_show() {
    let Some((display, desk)) = room() else { return };
    let size = [320, 200];
    let still = picture(&desk, size, CAMERA);
    // Negative control: another camera, and the same room without its direct light, are told apart.
    let aside = picture(&desk, size, "--camera 0.6,1.5,6.2:0,1.5,0:38");
    let dim = picture(&desk, size, &format!("{CAMERA} --terms indirect,single,multiple"));
    assert!(still.distance(&aside) > OTHER && still.distance(&dim) > OTHER && aside.distance(&dim) > OTHER);

    let mut window = display.open(desk.command(&format!("view room.bake --size 320x200 {CAMERA}")));
    let dark = |[r, g, b]: [u8; 3]| r == g && g == b && r > 0 && r < 64;
    window.until("the panel beside the picture", |seen| {
        seen.size == size && seen.columns(60..320).rgb.iter().filter(|&&pixel| dark(pixel)).count() > 260 * 200 / 2
    });
    window.press(TAB);
    shows(&mut window, "the picture alone", &still);

    window.hold_until(b'w'.into(), "a walk forward", |seen| seen.distance(&still) > OTHER);
    window.press(b'h'.into());
    shows(&mut window, "home again", &still);

    window.drag_until([[160, 100], [200, 100]], "a turned head", |seen| seen.distance(&still) > OTHER);
    window.press(b'h'.into());
    shows(&mut window, "home from a turn", &still);

    window.press(b'1'.into());
    shows(&mut window, "no direct light", &dim);
    window.press(b'1'.into());
    shows(&mut window, "direct light again", &still);

    window.press(b'l'.into());
    window.until("a lamp that was not baked", |seen| seen.distance(&still) > OTHER);
    window.press(b'l'.into());
    shows(&mut window, "the lamp gone", &still);

    window.press(b'p'.into());
    let saved = desk.path("room.view.00.png");
    window.until("a saved picture", |_| std::fs::metadata(&saved).is_ok_and(|file| file.len() > 0));
    std::thread::sleep(Duration::from_millis(100));
    assert!(Pixels::read(&saved) == still, "the saved picture is another");

    let small = [240, 150];
    let still = picture(&desk, small, CAMERA);
    window.resize(small);
    shows(&mut window, "the picture in another size", &still);

    window.press(ESCAPE);
    assert_eq!(window.ended(), Some(0));
}

#[test]
fn two_sides_stand_beside_each_other_the_divider_moves_and_their_difference_has_colours() {
    let Some((display, desk)) = room() else { return };
    let size = [320, 200];
    let airless = picture(&desk, size, &format!("{CAMERA} --air none"));
    let both = picture(&desk, size, &format!("{CAMERA} --compare none"));
    let difference = picture(&desk, size, &format!("{CAMERA} --compare none --difference=0.1"));
    assert!(airless.distance(&both) > OTHER && difference.distance(&both) > OTHER);

    let mut window = display.open(desk.command(&format!("view room.bake --size 320x200 --compare none {CAMERA}")));
    window.press(TAB);
    shows(&mut window, "two sides", &both);
    // Above the room all is black but the divider.
    let line = |seen: &Pixels, columns| seen.columns(columns).rgb.iter().any(|pixel| pixel[0] > 200);
    let at_left = |seen: &Pixels| line(&seen.rows(0..4), 2..20) && !line(&seen.rows(0..4), 20..320);
    assert!(line(&both.rows(0..4), 150..170) && !at_left(&both));
    window.drag_until([[160, 100], [8, 100]], "the divider at the left", at_left);
    // Whatever a busy window took for a turn of the head.
    window.press(b'h'.into());
    let right = |pixels: &Pixels| pixels.columns(20..320);
    window.until("the right side nearly alone", |seen| right(seen).distance(&right(&airless)) < SAME);
    window.press(b'x'.into());
    shows(&mut window, "the difference", &difference);
    window.press(b'q'.into());
    assert_eq!(window.ended(), Some(0));
}

#[test]
fn without_a_display_the_way_to_a_picture_is_named() {
    let desk = Desk::with_room();
    let baked = desk.bake("-q run room.glb --quality preview --texels-per-m 1 --samples 16");
    assert!(matches!(baked.code, Some(0 | 3)), "{baked:#?}");
    for display in [None, Some(":4095")] {
        let mut command = desk.command("view room.bake");
        command.env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY").env_remove("WAYLAND_SOCKET");
        display.map(|name| command.env("DISPLAY", name));
        let ended = Ended::from(command.output().expect("the program starts"));
        ended.expect(1, &["no display for a window", "--screenshot FILE"]);
    }
}
