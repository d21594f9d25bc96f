//! Progress on standard error: a bar with the time left for people, one JSON object a line for machines.

use crate::cli::Global;
use crate::console;
use crate::interrupt::Interrupt;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde_json::json;
use std::io::IsTerminal;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// How to show progress.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum ProgressMode {
    /// A bar where standard error is a terminal, else nothing
    Auto,
    /// One JSON object a line: stage, done, total, seconds
    Json,
    /// Nothing
    None,
}

/// Least time between two JSON lines of one stage.
const JSON_INTERVAL: Duration = Duration::from_millis(200);

/// Watches one command: shows its stages one after the other, and hands Ctrl-C on.
pub struct Progress {
    show: Show,
    interrupt: Interrupt,
    stage: Mutex<Stage>,
    done: AtomicU64,
}

enum Show {
    Bar(ProgressBar),
    Json,
    Nothing,
}

struct Stage {
    started: Instant,
    name: String,
    total: u64,
    last_line: Option<Instant>,
}

impl Progress {
    /// Shows what the command line asks for.
    pub fn new(global: &Global, interrupt: Interrupt) -> Self {
        let show = match global.progress {
            ProgressMode::Json => Show::Json,
            ProgressMode::Auto if std::io::stderr().is_terminal() && !global.quiet => Show::Bar(bar()),
            _ => Show::Nothing,
        };
        let stage = Stage { started: Instant::now(), name: String::new(), total: 0, last_line: None };
        Self { show, interrupt, stage: Mutex::new(stage), done: AtomicU64::new(0) }
    }

    /// Writes a line on standard error, beside the bar.
    pub fn line(&self, text: &str) {
        match &self.show {
            Show::Bar(bar) => bar.suspend(|| console::tell(text)),
            _ => console::tell(text),
        }
    }

    /// Takes the bar away.
    pub fn finish(&self) {
        if let Show::Bar(bar) = &self.show {
            bar.finish_and_clear();
        }
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, Stage> {
        self.stage.lock().expect("nothing panics while it holds this lock")
    }
}

impl bake_core::progress::Progress for Progress {
    fn stage(&self, name: &str, units: u64) {
        let mut stage = self.lock();
        self.done.store(0, Ordering::Relaxed);
        name.clone_into(&mut stage.name);
        stage.total = units;
        match &self.show {
            Show::Bar(bar) => {
                bar.reset();
                bar.set_message(stage.name.clone());
                bar.set_length(units);
            }
            Show::Json => stage.write_line(0),
            Show::Nothing => {}
        }
    }

    fn expect(&self, units: u64) {
        let mut stage = self.lock();
        stage.total = units;
        let done = self.done.load(Ordering::Relaxed);
        match &self.show {
            Show::Bar(bar) => bar.set_length(units),
            Show::Json if done >= units => stage.write_line(done),
            Show::Json | Show::Nothing => {}
        }
    }

    fn advance(&self, units: u64) {
        let done = self.done.fetch_add(units, Ordering::Relaxed) + units;
        match &self.show {
            Show::Bar(bar) => bar.set_position(done),
            Show::Json => {
                let mut stage = self.lock();
                let due = stage.last_line.is_none_or(|last| last.elapsed() >= JSON_INTERVAL);
                if due || done >= stage.total {
                    stage.write_line(done);
                }
            }
            Show::Nothing => {}
        }
    }

    fn is_cancelled(&self) -> bool {
        self.interrupt.pressed()
    }
}

impl Stage {
    fn write_line(&mut self, done: u64) {
        self.last_line = Some(Instant::now());
        let seconds = self.started.elapsed().as_secs_f64();
        let line = json!({ "stage": self.name, "done": done, "total": self.total, "seconds": seconds });
        console::tell(&line.to_string());
    }
}

/// The stage has a fixed width so that the bar does not jump.
fn bar() -> ProgressBar {
    let style = ProgressStyle::with_template("{msg:<14} {wide_bar} {percent:>3} %  {elapsed} so far, {eta} left");
    let bar = ProgressBar::with_draw_target(Some(0), ProgressDrawTarget::stderr_with_hz(8));
    bar.set_style(style.expect("the template is well formed"));
    bar
}
