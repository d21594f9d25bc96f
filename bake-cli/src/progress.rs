//! Progress on standard error: a bar with the time left for people, one JSON object a line for machines.

use crate::cli::Global;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde_json::json;
use std::io::IsTerminal;
use std::sync::Mutex;
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

/// Shows the stages of one command, one after the other.
pub struct Progress(Show);

enum Show {
    Bar(ProgressBar),
    Json(Mutex<JsonLines>),
    Nothing,
}

struct JsonLines {
    started: Instant,
    stage: String,
    last: Option<Instant>,
}

impl Progress {
    /// As the command line asks.
    pub fn new(global: &Global) -> Self {
        Self(match global.progress {
            ProgressMode::Json => {
                Show::Json(Mutex::new(JsonLines { started: Instant::now(), stage: String::new(), last: None }))
            }
            ProgressMode::Auto if std::io::stderr().is_terminal() && !global.quiet => Show::Bar(bar()),
            _ => Show::Nothing,
        })
    }

    /// States how far a stage has come. `total` = 0 means that nobody knows.
    pub fn report(&self, stage: &str, done: u64, total: u64) {
        match &self.0 {
            Show::Bar(bar) => {
                if bar.message() != stage {
                    bar.reset();
                    bar.set_message(stage.to_owned());
                }
                bar.set_length(total);
                bar.set_position(done);
            }
            Show::Json(lines) => lines.lock().expect("no thread panics here").report(stage, done, total),
            Show::Nothing => {}
        }
    }

    /// Takes the bar away.
    pub fn finish(&self) {
        if let Show::Bar(bar) = &self.0 {
            bar.finish_and_clear();
        }
    }
}

/// The stage has a fixed width so that the bar does not jump.
fn bar() -> ProgressBar {
    let style = ProgressStyle::with_template("{msg:<10} {wide_bar} {percent:>3} %  {elapsed} elapsed, {eta} left");
    let bar = ProgressBar::with_draw_target(Some(0), ProgressDrawTarget::stderr_with_hz(8));
    bar.set_style(style.expect("the template is well formed"));
    bar
}

impl JsonLines {
    fn report(&mut self, stage: &str, done: u64, total: u64) {
        let same_stage = self.stage == stage;
        if same_stage && done != total && self.last.is_some_and(|last| last.elapsed() < JSON_INTERVAL) {
            return;
        }
        if !same_stage {
            stage.clone_into(&mut self.stage);
        }
        self.last = Some(Instant::now());
        let seconds = self.started.elapsed().as_secs_f64();
        eprintln!("{}", json!({ "stage": stage, "done": done, "total": total, "seconds": seconds }));
    }
}
