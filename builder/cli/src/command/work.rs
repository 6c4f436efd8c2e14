//! `builder work`, and opening the folder for other commands.

use std::time::{Duration, SystemTime};

use anyhow::Context;
use job::work::{Entry, WorkFolder};

use super::args::{WorkAction, WorkArguments, WorkFolderArgument};
use super::failure::Failure;
use super::output::print_text;
use super::terminal::Terminal;

const DAY: u64 = 24 * 60 * 60;

/// Lists a work folder or cleans it.
pub fn run(arguments: &WorkArguments, terminal: &Terminal) -> Result<(), Failure> {
    let (WorkAction::List { folder } | WorkAction::Clean { folder, .. }) = &arguments.action;
    if let Some(path) = folder.work.as_ref().filter(|path| !path.is_dir()) {
        return Err(Failure::Input(anyhow::anyhow!("{} is no folder", path.display())));
    }
    let work =
        open(folder)?.ok_or_else(|| Failure::Usage("name the work folder: --work DIR, or REPRISE_WORK".into()))?;
    let listed = work.entries().with_context(|| format!("cannot list {}", work.root().display()));
    let entries = listed.map_err(Failure::Input)?;
    match &arguments.action {
        WorkAction::List { .. } => {
            let lines: String = entries.iter().map(line).collect();
            print_text(&format!("{lines}{}\n", sum(&entries)))
        }
        WorkAction::Clean { stage, unused, .. } => {
            let old =
                |entry: &Entry| unused.is_none_or(|days| age(entry) >= Duration::from_secs(u64::from(days) * DAY));
            let named = |entry: &Entry| stage.as_ref().is_none_or(|stage| *stage == entry.stage);
            let (removed, _): (Vec<Entry>, Vec<Entry>) =
                entries.into_iter().partition(|entry| old(entry) && named(entry));
            for entry in &removed {
                let gone = work.remove(entry).with_context(|| format!("cannot delete a result of {}", entry.stage));
                gone.map_err(Failure::Input)?;
            }
            terminal.log(&format!("deleted {}", sum(&removed)));
            Ok(())
        }
    }
}

/// The work folder that was named, if any.
pub fn open(argument: &WorkFolderArgument) -> Result<Option<WorkFolder>, Failure> {
    let Some(path) = &argument.work else { return Ok(None) };
    let opened = WorkFolder::open(path).with_context(|| format!("cannot use {} as a work folder", path.display()));
    opened.map(Some).map_err(Failure::Input)
}

fn age(entry: &Entry) -> Duration {
    SystemTime::now().duration_since(entry.used).unwrap_or_default()
}

fn line(entry: &Entry) -> String {
    let (megabytes, days) = (entry.bytes as f64 / 1e6, age(entry).as_secs() / DAY);
    format!("{:<14} {:.12}  {megabytes:>9.2} MB  used {days} days ago\n", entry.stage, entry.hash)
}

fn sum(entries: &[Entry]) -> String {
    let bytes: u64 = entries.iter().map(|entry| entry.bytes).sum();
    format!("{} results, {:.2} MB", entries.len(), bytes as f64 / 1e6)
}
