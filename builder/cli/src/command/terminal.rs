//! Progress and log on stderr.

use std::ops::ControlFlow;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use job::Progress;

/// A stage shows a bar once it has run for this long.
const PATIENCE: Duration = Duration::from_secs(1);

/// Shows how far the stages are; one bar at a time.
pub struct Terminal {
    quiet: bool,
    stage: Mutex<Option<RunningStage>>,
}

struct RunningStage {
    what: &'static str,
    start: Instant,
    bar: Option<ProgressBar>,
}

/// The user wants the work to stop.
static STOPPED: AtomicBool = AtomicBool::new(false);

/// Lets the first interrupt ask the work to stop, and the second one end the program.
pub fn stop_when_interrupted() {
    let interrupted = || {
        if STOPPED.swap(true, Ordering::Relaxed) {
            std::process::exit(130);
        }
        eprintln!("stopping; once more to stop at once");
    };
    // Without it an interrupt ends the program, as it does anyway where nothing else is said.
    let _ = ctrlc::set_handler(interrupted);
}

impl Terminal {
    /// A terminal that shows bars and log lines, or only errors where `quiet`.
    pub fn new(quiet: bool) -> Self {
        Self { quiet, stage: Mutex::new(None) }
    }

    /// Shows the progress of a stage; a new name ends the bar of the stage before.
    /// Asks to stop once the user did.
    pub fn progress(&self, progress: Progress) -> ControlFlow<()> {
        self.show(progress);
        if STOPPED.load(Ordering::Relaxed) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    fn show(&self, progress: Progress) {
        if self.quiet {
            return;
        }
        let Ok(mut current) = self.stage.lock() else { return };
        if current.as_ref().is_none_or(|stage| stage.what != progress.what) {
            finish(current.take());
            *current = Some(RunningStage { what: progress.what, start: Instant::now(), bar: None });
        }
        let Some(stage) = current.as_mut() else { return };
        if stage.start.elapsed() >= PATIENCE {
            let bar = stage.bar.get_or_insert_with(|| new_bar(progress.what));
            bar.set_length(progress.total.max(progress.done));
            bar.set_position(progress.done);
        }
    }

    /// Prints a line, above the bar where one is shown.
    pub fn log(&self, line: &str) {
        if self.quiet {
            return;
        }
        if let Ok(mut current) = self.stage.lock() {
            finish(current.take());
        }
        eprintln!("{line}");
    }
}

impl Drop for Terminal {
    fn drop(&mut self) {
        if let Ok(mut current) = self.stage.lock() {
            finish(current.take());
        }
    }
}

fn finish(stage: Option<RunningStage>) {
    if let Some(bar) = stage.and_then(|stage| stage.bar) {
        bar.finish_and_clear();
    }
}

fn new_bar(what: &'static str) -> ProgressBar {
    let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr());
    if let Ok(style) = ProgressStyle::with_template("{msg:20} {wide_bar} {percent:>3} %  {eta:>4} left") {
        bar.set_style(style);
    }
    bar.with_message(what)
}
