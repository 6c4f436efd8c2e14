//! Tables of the section on scans.

use capture_io::import::Scans;
use reprise::scan_headings::HeadingTrial;
use reprise::scan_windows::{WindowTrial, WindowTrials};
use reprise::scans::{FrameReport, RegisterReport};

use super::Seen;
use crate::document::{Cell, Table};

fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (mut sum, mut count) = (0.0, 0);
    for value in values {
        (sum, count) = (sum + value, count + 1);
    }
    (count > 0).then(|| sum / f64::from(count))
}

fn most(values: impl Iterator<Item = f64>) -> Option<f64> {
    values.reduce(f64::max)
}

fn number(value: Option<f64>, decimals: usize) -> Cell {
    value.map_or(Cell::Empty, |value| Cell::Number(value, decimals))
}

/// Frames with a truth, without the template's own.
fn known(report: &RegisterReport) -> impl Iterator<Item = &FrameReport> + Clone {
    report.registered.iter().filter(|frame| frame.truth.is_some() && frame.frame != report.template)
}

/// All in one row a figure, beside what is asked for.
pub fn overall(report: &RegisterReport, seen: &[Seen], trials: &[HeadingTrial]) -> Table {
    let mut table =
        Table::new("scans", "The whole scan, and what is to be reached with colours", &["figure", "value", "asked"]);
    let known = known(report);
    let truth = |of: fn(&reprise::scans::TruthReport) -> f64| {
        known.clone().filter_map(move |frame| frame.truth.as_ref().map(of)).map(|metres| 1000.0 * metres)
    };
    let mut means: Vec<f64> = truth(|t| t.mean).collect();
    means.sort_by(f64::total_cmp);
    let frames = || report.registered.iter();
    let told = trials.iter().filter(|trial| trial.fault || trial.is_back()).count();
    let share = (!trials.is_empty()).then(|| 100.0 * told as f64 / trials.len() as f64);
    let rows: [(&str, Option<f64>, usize, &str); 14] = [
        ("frames lost", Some(report.lost.len() as f64), 0, "0"),
        ("error mm, mean over frames", mean(means.iter().copied()), 1, "5"),
        ("error mm, median frame", means.get(means.len() / 2).copied(), 1, ""),
        ("error mm, worst frame", means.last().copied(), 1, "12"),
        ("p95 mm, mean over frames", mean(truth(|t| t.p95)), 1, "20"),
        ("p95 mm, worst frame", most(truth(|t| t.p95)), 1, ""),
        ("farthest point mm", most(truth(|t| t.worst)), 0, ""),
        ("scan to template mm rms, worst frame", most(frames().map(|f| 1000.0 * f.rms_backward)), 2, "3.5"),
        ("uncovered %, worst frame", most(frames().map(|f| 100.0 * f.uncovered)), 2, "1.5"),
        ("wrong headings found back or told %", share, 0, "100"),
        ("PSNR dB, scan against its own texture", mean(seen.iter().map(|s| s.own.1)), 1, ""),
        ("SSIM, the same", mean(seen.iter().map(|s| s.own.0.similarity)), 3, ""),
        ("PSNR dB, against the template's texture", mean(seen.iter().map(|s| s.first.1)), 1, ""),
        ("SSIM, the same", mean(seen.iter().map(|s| s.first.0.similarity)), 3, ""),
    ];
    table.rows = rows
        .into_iter()
        .map(|(name, value, decimals, asked)| vec![name.into(), number(value, decimals), asked.into()])
        .collect();
    table
}

/// Sequence by sequence: a frame that was found wrong takes with it all that were tracked from it.
pub fn takes(report: &RegisterReport, scans: &Scans) -> Table {
    let columns = ["sequence", "frames", "lost", "error mm", "worst frame mm", "p95 mm", "uncovered %", "off mm"];
    let mut table = Table::new("scan_takes", "Sequence by sequence: means, and the worst frame's", &columns);
    for (number_of, sequence) in scans.sequences.iter().enumerate() {
        let of = |frame: usize| scans.place_of(frame).is_some_and(|(sequence, _)| sequence == number_of);
        let frames = || report.registered.iter().filter(|frame| of(frame.frame));
        let truth = || known(report).filter(|frame| of(frame.frame)).filter_map(|frame| frame.truth);
        table.rows.push(vec![
            sequence.name.clone().into(),
            Cell::Count(sequence.files.len() as u64),
            Cell::Count(report.lost.iter().filter(|lost| of(lost.frame)).count() as u64),
            number(mean(truth().map(|t| 1000.0 * t.mean)), 1),
            number(most(truth().map(|t| 1000.0 * t.mean)), 1),
            number(mean(truth().map(|t| 1000.0 * t.p95)), 1),
            number(most(frames().map(|f| 100.0 * f.uncovered)), 2),
            number(most(frames().map(|f| 1000.0 * f.rms_backward)), 2),
        ]);
    }
    table
}

/// All frames.
pub fn frames(report: &RegisterReport) -> Table {
    let columns = [
        "frame",
        "tracked from",
        "error mm",
        "p95 mm",
        "farthest mm",
        "off mm",
        "uncovered %",
        "beyond %",
        "strain %",
        "colour",
    ];
    let mut table = Table::new("scan_frames", "All frames that were registered", &columns);
    let row = |frame: &FrameReport| {
        let truth = |of: fn(&reprise::scans::TruthReport) -> f64| frame.truth.as_ref().map(|truth| 1000.0 * of(truth));
        vec![
            Cell::Count(frame.frame as u64),
            frame.parent.map_or(Cell::Empty, |parent| Cell::Count(parent as u64)),
            number(truth(|t| t.mean), 1),
            number(truth(|t| t.p95), 1),
            number(truth(|t| t.worst), 0),
            Cell::Number(1000.0 * frame.rms_backward, 2),
            Cell::Number(100.0 * frame.uncovered, 2),
            Cell::Number(100.0 * frame.beyond, 2),
            Cell::Number(100.0 * frame.strain, 1),
            Cell::Number(frame.colour, 3),
        ]
    };
    table.rows = report.registered.iter().map(row).collect();
    table
}

/// What pictures say.
pub fn views(seen: &[Seen]) -> Table {
    let columns = ["frame", "PSNR dB", "SSIM", "outline %", "PSNR dB, template's texture", "SSIM, template's texture"];
    let caption = "Pictures of the registered frame against the scan's own frame, inside both outlines; pixels that one alone covers, \
                   of those that either does";
    let mut table = Table::new("scan_views", caption, &columns);
    let row = |s: &Seen| {
        vec![
            Cell::Count(s.frame as u64),
            Cell::Number(s.own.1, 1),
            Cell::Number(s.own.0.similarity, 3),
            Cell::Number(100.0 * s.own.0.outline, 2),
            Cell::Number(s.first.1, 1),
            Cell::Number(s.first.0.similarity, 3),
        ]
    };
    table.rows = seen.iter().map(row).collect();
    table
}

/// Wrong headings.
pub fn headings(trials: &[HeadingTrial]) -> Table {
    let columns = ["frame", "turned by rad", "ends off by mm", "uncovered %", "what became of it"];
    let caption = "Frames tracked from the one before, turned: found back, told as wrong, or wrong and not told";
    let mut table = Table::new("scan_headings", caption, &columns);
    let row = |trial: &HeadingTrial| {
        let became = match (trial.is_back(), trial.fault) {
            (_, true) => "told",
            (true, false) => "found back",
            (false, false) => "not told",
        };
        vec![
            Cell::Count(trial.frame as u64),
            Cell::Number(f64::from(trial.turn), 1),
            Cell::Number(1000.0 * trial.off, 1),
            Cell::Number(100.0 * trial.uncovered, 2),
            became.into(),
        ]
    };
    table.rows = trials.iter().map(row).collect();
    table
}

/// How many candidate windows there are (Prada 2016, table 1), and how many of those that were tracked succeed.
pub fn candidates(windows: &WindowTrials) -> Table {
    let caption = "Candidate windows up to so many times as unlike as consecutive frames (3 in the paper), and what became of those \
                   that were tracked; the paper had 53, of which 38 succeeded; asked is 90 %";
    let columns = ["threshold", "candidates", "tracked", "in full"];
    let mut table = Table::new("scan_candidates", caption, &columns);
    let good = windows.trials.iter().filter(|trial| trial.is_whole()).count();
    let row = |&(threshold, candidates): &(f32, usize)| {
        let own = candidates > 0 && threshold == windows.threshold;
        let count = |count: usize| if own { Cell::Count(count as u64) } else { Cell::Empty };
        let threshold = Cell::Number(f64::from(threshold), 1);
        vec![threshold, Cell::Count(candidates as u64), count(windows.trials.len()), count(good)]
    };
    table.rows = windows.thresholds.iter().map(row).collect();
    table
}

/// The candidate windows that were tracked.
pub fn windows(windows: &WindowTrials) -> Table {
    let caption = "Candidate windows, each with a template that was tracked through both of its windows";
    let columns =
        ["source", "target", "unlike", "template", "tracked", "lost", "uncovered %", "scan off mm", "both ends tried"];
    let mut table = Table::new("scan_windows", caption, &columns);
    let count = |number: usize| Cell::Count(number as u64);
    let row = |trial: &WindowTrial| {
        vec![
            count(trial.pair[0]),
            count(trial.pair[1]),
            Cell::Number(f64::from(trial.unlike), 1),
            count(trial.template),
            count(trial.tracked),
            count(trial.lost),
            Cell::Number(100.0 * trial.uncovered, 2),
            Cell::Number(1000.0 * trial.rms_backward, 1),
            if trial.again { "yes" } else { "no" }.into(),
        ]
    };
    table.rows = windows.trials.iter().map(row).collect();
    table
}

/// What tracking windows takes (Prada 2016, table 2).
pub fn window_times(windows: &WindowTrials) -> Table {
    let caption = "Seconds a candidate window, of one processor and of wall time; the paper took about 9 minutes, asked are 40 s of one \
                   processor";
    let columns = ["source", "target", "processor s", "wall s"];
    let mut table = Table::new("scan_window_times", caption, &columns);
    table.timed = true;
    let row = |trial: &WindowTrial| {
        let [source, target] = trial.pair.map(|frame| Cell::Count(frame as u64));
        vec![source, target, number(trial.work, 1), Cell::Number(trial.seconds, 1)]
    };
    table.rows = windows.trials.iter().map(row).collect();
    table
}

/// Frames that were lost, and why.
pub fn lost(report: &RegisterReport) -> Table {
    let mut table = Table::new("scan_lost", "Frames that are not part of the capture", &["frame", "why"]);
    table.rows = report.lost.iter().map(|lost| vec![lost.place.clone().into(), lost.reason.clone().into()]).collect();
    table
}

/// How long it took.
pub fn times(report: &RegisterReport) -> Table {
    let mut table = Table::new("scan_times", "Wall-clock seconds", &["stage", "seconds", "seconds a frame"]);
    table.timed = true;
    let frames = report.frames.max(1) as f64;
    let row =
        |stage: &str, seconds: f64| vec![stage.into(), Cell::Number(seconds, 1), Cell::Number(seconds / frames, 3)];
    table.rows = vec![
        row("looking at frames and comparing them", report.seconds[0]),
        row("tracking, detail and textures", report.seconds[1]),
    ];
    table
}
