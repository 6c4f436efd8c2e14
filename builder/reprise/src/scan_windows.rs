//! Candidate windows of a scan (Prada 2016, section 4), and one template for each, tracked through both of its windows (section 5):
//! how many there are, how many of them succeed, and what that takes.

use std::time::Instant;

use capture_io::import::scans;
use job::Job;
use registration::candidates::{CandidateOptions, candidates};
use registration::dissimilarity::Dissimilarity;
use registration::register::{Source, Survey, survey, windowed};
use registration::windows::{TrackedWindows, track_windows};
use serde::Serialize;

use super::scans::{Frames, RegisterError, ScanOptions};

/// What became of the candidates of a scan.
#[derive(Clone, Debug, Serialize)]
pub struct WindowTrials {
    /// Thresholds, in dissimilarities of consecutive frames (3 in the paper), and how many candidates each leaves.
    pub thresholds: Vec<(f32, usize)>,
    /// The threshold whose candidates were tracked.
    pub threshold: f32,
    /// Candidates that were tracked, the least unlike first.
    pub trials: Vec<WindowTrial>,
}

/// A candidate that was tracked.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WindowTrial {
    /// The middle frames of both windows, counted over all sequences.
    pub pair: [usize; 2],
    /// How unlike they are, in dissimilarities of consecutive frames.
    pub unlike: f32,
    /// The frame that is the template.
    pub template: usize,
    /// Frames that it was brought onto.
    pub tracked: usize,
    /// Frames that it does not fit, and those beyond them.
    pub lost: usize,
    /// The most of a frame that it leaves uncovered, as a share.
    pub uncovered: f64,
    /// How far off it a frame is at most: the root of the mean square, metres.
    pub rms_backward: f64,
    /// Whether the template of the other end was tried, too.
    pub again: bool,
    /// Seconds of wall time, on as many threads as there are.
    pub seconds: f64,
    /// Seconds of processor time; none where the system does not tell.
    pub work: Option<f64>,
}

impl WindowTrial {
    /// Whether the template lies on all frames of both windows.
    #[must_use]
    pub fn is_whole(&self) -> bool {
        self.lost == 0
    }
}

/// Finds candidates of the scan that `inputs` name with each of `thresholds` instead of that of `wanted`, and tracks `most` at most of
/// the first threshold that leaves some.
///
/// # Errors
/// Scans that cannot be read, or being told to stop.
pub fn scan_windows(
    inputs: &[String],
    options: &ScanOptions,
    (wanted, thresholds, most): (&CandidateOptions, &[f32], usize),
    job: &Job,
) -> Result<WindowTrials, RegisterError> {
    let scans = scans(inputs, &options.import)?;
    let source = Frames(&scans);
    let survey = survey(&source, &options.register, job)?;
    let windowed = windowed(&source, &survey, wanted.reach, &options.register, job)?;
    let sequences: Vec<usize> = survey.frames.iter().map(|&frame| source.sequence(frame)).collect();
    let of = |threshold: f32| {
        let wanted = CandidateOptions { most: threshold, ..*wanted };
        let found = candidates(&windowed, &sequences, &wanted, |_, _| true);
        found.into_iter().map(|(pair, _)| pair).collect::<Vec<_>>()
    };
    let found: Vec<(f32, Vec<(usize, usize)>)> =
        thresholds.iter().map(|&threshold| (threshold, of(threshold))).collect();
    let counts = found.iter().map(|(threshold, pairs)| (*threshold, pairs.len())).collect();
    let (threshold, pairs) = found.into_iter().find(|(_, pairs)| !pairs.is_empty()).unwrap_or_default();
    let step = consecutive(&windowed, &sequences);
    let mut trials = Vec::new();
    for (s, t) in pairs.into_iter().take(most) {
        let unlike = windowed.get(s, t) / step;
        trials.push(trial((&source, &survey), ([s, t], unlike), wanted.reach, options, job)?);
    }
    Ok(WindowTrials { thresholds: counts, threshold, trials })
}

/// How unlike consecutive frames are, on average.
fn consecutive(windowed: &Dissimilarity, sequences: &[usize]) -> f32 {
    let pairs = (1..sequences.len()).filter(|&k| sequences[k - 1] == sequences[k]);
    let values: Vec<f32> = pairs.map(|k| windowed.get(k - 1, k)).collect();
    (values.iter().sum::<f32>() / values.len().max(1) as f32).max(1e-12)
}

/// The better of both ends is the template: that which loses fewer frames, the source's where both are as good.
fn trial(
    scan: (&Frames, &Survey),
    ([s, t], unlike): ([usize; 2], f32),
    reach: usize,
    options: &ScanOptions,
    job: &Job,
) -> Result<WindowTrial, RegisterError> {
    let (start, before) = (Instant::now(), worked());
    let track = |ends: [usize; 2]| -> Result<TrackedWindows, RegisterError> {
        let nothing = TrackedWindows { untried: 4 * reach + 2, ..TrackedWindows::default() };
        Ok(track_windows(scan, ends, reach, &options.register, job)?.unwrap_or(nothing))
    };
    let mut found = track([s, t])?;
    let again = !found.is_whole();
    if again {
        let other = track([t, s])?;
        if other.tracked.len() > found.tracked.len() {
            found = other;
        }
    }
    let most =
        |of: fn(&registration::checks::Fit) -> f64| found.tracked.iter().map(|(_, fit)| of(fit)).fold(0.0, f64::max);
    Ok(WindowTrial {
        pair: [s, t].map(|k| scan.1.frames[k]),
        unlike,
        template: found.template,
        tracked: found.tracked.len(),
        lost: found.failed.len() + found.untried,
        uncovered: most(|fit| fit.uncovered),
        rms_backward: most(|fit| fit.rms_backward),
        again,
        seconds: start.elapsed().as_secs_f64(),
        work: worked().zip(before).map(|(after, before)| after - before),
    })
}

/// Seconds that all threads of this process have worked so far.
fn worked() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/self/stat").ok()?;
    let fields: Vec<&str> = text.rsplit(')').next()?.split_whitespace().collect();
    let ticks = |k: usize| fields.get(k)?.parse::<f64>().ok();
    Some((ticks(11)? + ticks(12)?) / 100.0)
}
