//! Ctrl-C: the first asks the command to stop cleanly, the second ends the process at once.

use crate::exit::INTERRUPTED;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Whether Ctrl-C was pressed. Commands that take long listen, and look between pieces of work.
#[derive(Debug, Clone, Default)]
pub struct Interrupt(Arc<AtomicBool>);

impl Interrupt {
    /// Starts to listen. May be called once in a process; where the system allows no handler, Ctrl-C kills as usual.
    pub fn listen() -> Self {
        let interrupt = Self::default();
        let pressed = interrupt.0.clone();
        let handler = move || {
            if pressed.swap(true, Ordering::Relaxed) {
                std::process::exit(i32::from(INTERRUPTED));
            }
        };
        if ctrlc::set_handler(handler).is_err() {
            crate::console::tell("warning: Ctrl-C cannot be caught on this system and will end the program at once");
        }
        interrupt
    }

    /// Whether to stop.
    pub fn pressed(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}
