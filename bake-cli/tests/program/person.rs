//! A person before a virtual display: starts the program, presses keys, moves the mouse, looks at the window.

use std::io::{BufRead, BufReader};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use x11rb::connection::Connection;
use x11rb::protocol::xproto::{self, ConnectionExt, ImageFormat, MapState, Window};
use x11rb::protocol::xtest::ConnectionExt as _;
use x11rb::rust_connection::RustConnection;

/// How long the window may take to show what it should.
pub const PATIENCE: Duration = Duration::from_secs(120);

/// How long a tap on a key takes.
const A_MOMENT: Duration = Duration::from_millis(50);

/// Keys without a letter (X11 keysyms).
pub const TAB: u32 = 0xff09;
/// Escape.
pub const ESCAPE: u32 = 0xff1b;

/// A display of our own, which goes with the test.
pub struct Display {
    server: Child,
    name: String,
    connection: RustConnection,
    root: Window,
}

/// A picture without opacity, row by row from the top.
#[derive(Clone, PartialEq)]
pub struct Pixels {
    pub size: [u32; 2],
    pub rgb: Vec<[u8; 3]>,
}

impl Pixels {
    /// A PNG file's.
    pub fn read(path: &std::path::Path) -> Self {
        let image = image::open(path).unwrap_or_else(|error| panic!("{}: {error}", path.display())).into_rgb8();
        Self { size: [image.width(), image.height()], rgb: image.pixels().map(|pixel| pixel.0).collect() }
    }

    /// Some of its columns.
    pub fn columns(&self, columns: std::ops::Range<usize>) -> Self {
        let rows = self.rgb.chunks_exact(self.size[0] as usize);
        let rgb = rows.flat_map(|row| &row[columns.clone()]).copied().collect();
        Self { size: [columns.len() as u32, self.size[1]], rgb }
    }

    /// Some of its rows.
    pub fn rows(&self, rows: std::ops::Range<usize>) -> Self {
        let width = self.size[0] as usize;
        let rgb = self.rgb[rows.start * width..rows.end * width].to_vec();
        Self { size: [self.size[0], rows.len() as u32], rgb }
    }

    /// The mean difference of channels, of 255; 255 where the sizes differ.
    pub fn distance(&self, other: &Self) -> f64 {
        if self.size != other.size {
            return 255.0;
        }
        let channels = self.rgb.iter().flatten().zip(other.rgb.iter().flatten());
        channels.map(|(a, b)| f64::from(a.abs_diff(*b))).sum::<f64>() / (3 * self.rgb.len()) as f64
    }
}

impl Display {
    /// Starts a display; `None` where the machine has none to start.
    pub fn start() -> Option<Self> {
        let mut command = Command::new("Xvfb");
        command.args(["-displayfd", "1", "-screen", "0", "1280x800x24", "-nolisten", "tcp"]);
        let mut server = command.stdout(Stdio::piped()).stderr(Stdio::null()).spawn().ok()?;
        let mut number = String::new();
        BufReader::new(server.stdout.take()?).read_line(&mut number).ok()?;
        // A server that found no place for its socket ends without a number.
        let name = format!(":{}", number.trim().parse::<u32>().ok()?);
        let (connection, screen) = x11rb::connect(Some(&name)).expect("the display that was just started answers");
        let root = connection.setup().roots[screen].root;
        Some(Self { server, name, connection, root })
    }

    /// Starts a program on it and waits for its window.
    pub fn open(&self, mut command: Command) -> Seen<'_> {
        command.env("DISPLAY", &self.name).env_remove("WAYLAND_DISPLAY").env_remove("WAYLAND_SOCKET");
        let program = command.stderr(Stdio::piped()).spawn().expect("the program starts");
        let mut seen = Seen { display: self, program, window: self.root };
        let begin = Instant::now();
        while seen.window == self.root {
            if let Some(status) = seen.program.try_wait().expect("a child can be asked") {
                panic!("no window: {status}, {}", seen.words());
            }
            assert!(begin.elapsed() < PATIENCE, "no window after {PATIENCE:?}");
            std::thread::sleep(Duration::from_millis(20));
            seen.window = self.visible_window().unwrap_or(self.root);
        }
        let focus = self.connection.set_input_focus(xproto::InputFocus::PARENT, seen.window, x11rb::CURRENT_TIME);
        focus.expect("sent").check().expect("a visible window takes the focus");
        seen
    }

    fn visible_window(&self) -> Option<Window> {
        let children = self.connection.query_tree(self.root).ok()?.reply().ok()?.children;
        children.into_iter().find(|&window| {
            let attributes = self.connection.get_window_attributes(window).ok().and_then(|cookie| cookie.reply().ok());
            let geometry = self.connection.get_geometry(window).ok().and_then(|cookie| cookie.reply().ok());
            attributes.is_some_and(|a| a.map_state == MapState::VIEWABLE) && geometry.is_some_and(|g| g.width > 64)
        })
    }

    /// One event as if from a keyboard or mouse.
    fn send(&self, kind: u8, detail: u8, [x, y]: [i16; 2]) {
        let sent = self.connection.xtest_fake_input(kind, detail, x11rb::CURRENT_TIME, self.root, x, y, 0);
        sent.expect("sent").check().expect("the display takes fake input");
    }

    fn keycode(&self, keysym: u32) -> u8 {
        let setup = self.connection.setup();
        let (first, count) = (setup.min_keycode, setup.max_keycode - setup.min_keycode + 1);
        let map = self.connection.get_keyboard_mapping(first, count).expect("sent").reply().expect("a keyboard");
        let per_key = map.keysyms_per_keycode as usize;
        let at = map.keysyms.chunks(per_key).position(|symbols| symbols.first() == Some(&keysym));
        first + at.unwrap_or_else(|| panic!("no key for {keysym:#x}")) as u8
    }
}

impl Drop for Display {
    fn drop(&mut self) {
        // Gone already is as good.
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

/// A program's window, seen by a person.
pub struct Seen<'a> {
    display: &'a Display,
    program: Child,
    window: Window,
}

impl Seen<'_> {
    /// Presses a key and lets it go.
    pub fn press(&self, keysym: u32) {
        let code = self.display.keycode(keysym);
        self.display.send(xproto::KEY_PRESS_EVENT, code, [0, 0]);
        std::thread::sleep(A_MOMENT);
        self.display.send(xproto::KEY_RELEASE_EVENT, code, [0, 0]);
    }

    /// Holds a key until the window shows something of which `right` is true.
    #[track_caller]
    pub fn hold_until(&mut self, keysym: u32, what: &str, right: impl Fn(&Pixels) -> bool) {
        let code = self.display.keycode(keysym);
        self.display.send(xproto::KEY_PRESS_EVENT, code, [0, 0]);
        self.until(what, right);
        self.display.send(xproto::KEY_RELEASE_EVENT, code, [0, 0]);
    }

    /// Drags with the left button until the window shows something of which `right` is true; if it does not, the camera goes
    /// home and the person tries again, slower: a window that was busy took the button for another place's.
    #[track_caller]
    pub fn drag_until(&mut self, [from, to]: [[i16; 2]; 2], what: &str, right: impl Fn(&Pixels) -> bool) {
        let begin = Instant::now();
        let mut wait = 2 * A_MOMENT;
        let mut seen = false;
        while !seen {
            assert!(begin.elapsed() < PATIENCE, "{what}: not seen after {PATIENCE:?}");
            self.move_to(from, wait);
            self.display.send(xproto::BUTTON_PRESS_EVENT, 1, [0, 0]);
            std::thread::sleep(wait);
            seen = (0i16..8).any(|step| {
                let share = |axis: usize| from[axis] + (to[axis] - from[axis]) * (step + 1).min(4) / 4;
                self.move_to([share(0) + step % 2, share(1)], wait);
                self.look().is_some_and(|pixels| right(&pixels))
            });
            self.display.send(xproto::BUTTON_RELEASE_EVENT, 1, [0, 0]);
            std::thread::sleep(wait);
            if !seen {
                self.press(b'h'.into());
            }
            wait = (2 * wait).min(Duration::from_secs(5));
        }
    }

    fn move_to(&self, place: [i16; 2], wait: Duration) {
        self.display.send(xproto::MOTION_NOTIFY_EVENT, 0, place);
        std::thread::sleep(wait);
    }

    /// Points at a place.
    pub fn point_at(&self, place: [i16; 2]) {
        self.move_to(place, A_MOMENT);
    }

    /// Clicks at a place with the left button. So fast that a window that is busy sees no long press in it.
    pub fn click(&self, place: [i16; 2]) {
        self.point_at(place);
        self.display.send(xproto::BUTTON_PRESS_EVENT, 1, [0, 0]);
        self.display.send(xproto::BUTTON_RELEASE_EVENT, 1, [0, 0]);
    }

    /// Holds the left button at a place until the window shows something of which `right` is true.
    #[track_caller]
    pub fn hold_at(&mut self, place: [i16; 2], what: &str, right: impl Fn(&Pixels) -> bool) {
        self.point_at(place);
        self.display.send(xproto::BUTTON_PRESS_EVENT, 1, [0, 0]);
        self.until(what, right);
        self.display.send(xproto::BUTTON_RELEASE_EVENT, 1, [0, 0]);
        // A window that is busy would take what follows for the same movement.
        std::thread::sleep(4 * A_MOMENT);
    }

    /// Gives the window another size.
    pub fn resize(&self, [width, height]: [u32; 2]) {
        let size = xproto::ConfigureWindowAux::new().width(width).height(height);
        let sent = self.display.connection.configure_window(self.window, &size);
        sent.expect("sent").check().expect("a window takes another size");
    }

    /// What the window shows.
    pub fn look(&self) -> Option<Pixels> {
        let connection = &self.display.connection;
        let geometry = connection.get_geometry(self.window).ok()?.reply().ok()?;
        let (width, height) = (geometry.width, geometry.height);
        let image = connection.get_image(ImageFormat::Z_PIXMAP, self.window, 0, 0, width, height, u32::MAX);
        let data = image.ok()?.reply().ok()?.data;
        let rgb = data.chunks_exact(4).map(|bgrx| [bgrx[2], bgrx[1], bgrx[0]]).collect();
        Some(Pixels { size: [width.into(), height.into()], rgb })
    }

    /// Waits until the window shows something of which `right` is true, and returns it.
    #[track_caller]
    pub fn until(&mut self, what: &str, right: impl Fn(&Pixels) -> bool) -> Pixels {
        let begin = Instant::now();
        let mut last = None;
        while begin.elapsed() < PATIENCE {
            last = self.look();
            if let Some(pixels) = last.take_if(|pixels| right(pixels)) {
                return pixels;
            }
            if let Some(status) = self.program.try_wait().expect("a child can be asked") {
                panic!("{what}: the program ended with {status}, {}", self.words());
            }
            std::thread::sleep(Duration::from_millis(50));
        }
        if let Some(pixels) = last {
            let bytes: Vec<u8> = pixels.rgb.iter().flatten().copied().collect();
            let path = testkit::reference::workspace().join("target/window.png");
            let _ = image::save_buffer(&path, &bytes, pixels.size[0], pixels.size[1], image::ExtendedColorType::Rgb8);
            panic!("{what}: not seen after {PATIENCE:?}; the window shows {}", path.display());
        }
        panic!("{what}: nothing seen after {PATIENCE:?}");
    }

    /// Waits for the program's end; its exit code.
    pub fn ended(mut self) -> Option<i32> {
        let begin = Instant::now();
        while begin.elapsed() < PATIENCE {
            if let Some(status) = self.program.try_wait().expect("a child can be asked") {
                return status.code();
            }
            std::thread::sleep(Duration::from_millis(20));
        }
        panic!("the program did not end in {PATIENCE:?}");
    }

    /// Standard error of a program that has ended.
    fn words(&mut self) -> String {
        let pipe = self.program.stderr.take();
        pipe.and_then(|pipe| std::io::read_to_string(pipe).ok()).unwrap_or_default()
    }
}

impl Drop for Seen<'_> {
    fn drop(&mut self) {
        // Ended already is as good.
        let _ = self.program.kill();
        let _ = self.program.wait();
    }
}
