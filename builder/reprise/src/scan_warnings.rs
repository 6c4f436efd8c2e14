//! What is said of frames: which are lost, doubtful, or alone.

use std::collections::BTreeMap;

use capture_io::export::WrittenSequence;
use capture_io::import::{Scans, Warning};
use registration::checks::Fit;
use registration::cut::Group;
use registration::register::{Lost, Registered, Survey};
use registration::scan::Mended;

use super::scan_report::LostReport;
use super::scan_source::{RegisterError, first_of, place};

/// Of the frames at most this share may be lost.
const MOST_LOST: f64 = 0.5;
/// Beyond these a frame is doubtful: edges over those of the frame that it was tracked from, the share of the template that lies off
/// the scan, and how much edges are longer or shorter than the template's own.
const MOST_STRETCH: f64 = 1.3;
const MOST_BEYOND: f64 = 0.06;
const MOST_STRAIN: f64 = 0.12;

/// The frames that were lost, as they are told.
pub(crate) fn lost_reports(scans: &Scans, lost: &[(usize, Lost)]) -> Vec<LostReport> {
    let report =
        |&(frame, why): &(usize, Lost)| LostReport { frame, place: place(scans, frame), reason: with_remedy(why) };
    lost.iter().map(report).collect()
}

/// Why a frame was lost, and what can be done.
fn with_remedy(why: Lost) -> String {
    let remedy = match why {
        Lost::Empty => "export it again, or leave it out",
        Lost::Size(_) => "export it in the unit of the others, or leave it out",
        Lost::Untracked(..) => {
            "if it shows something else, or more than one body, leave it out; else name another template with --template-frame"
        }
    };
    format!("{why}; {remedy}")
}

/// Refuses a scan of which most is lost, with so many frames that stand `alone` between others that are.
pub(crate) fn check_lost(scans: &Scans, all: &[(usize, Lost)], alone: usize, root: usize) -> Result<(), RegisterError> {
    let (lost, frames) = (all.len() + alone, scans.frame_count());
    match all.first() {
        Some(&(first, why)) if lost as f64 > MOST_LOST * frames as f64 => {
            Err(RegisterError::MostLost { lost, frames, root, place: place(scans, first), why })
        }
        _ => Ok(()),
    }
}

/// The sequences without the frames that were lost: each is cut there. Frames that stand alone between two lost ones go, too.
pub(crate) fn parts(scans: &Scans, registered: &Registered) -> (Vec<WrittenSequence>, Vec<usize>) {
    let mut runs: BTreeMap<usize, Vec<(usize, usize)>> = BTreeMap::new();
    for tracked in &registered.tracked {
        let Some((sequence, number)) = scans.place_of(tracked.frame) else { continue };
        let runs = runs.entry(sequence).or_default();
        match runs.last_mut() {
            Some((_, last)) if *last + 1 == number => *last = number,
            _ => runs.push((number, number)),
        }
    }
    let (mut parts, mut alone) = (Vec::new(), Vec::new());
    for (number, runs) in runs {
        let sequence = &scans.sequences[number];
        let whole = runs.first() == Some(&(0, sequence.files.len() - 1));
        let mut count = 0;
        for frames in runs {
            if frames.0 == frames.1 && sequence.files.len() > 1 {
                alone.push(first_of(scans, number) + frames.0);
                continue;
            }
            count += 1;
            let name = if count == 1 { sequence.name.clone() } else { format!("{} part {count}", sequence.name) };
            let (labels, cyclic) = (sequence.labels.clone(), if whole { sequence.cyclic } else { Some(false) });
            parts.push(WrittenSequence { name, labels, cyclic, number, frames });
        }
    }
    (parts, alone)
}

/// One sentence for all of `frames`, of which the first is named; none where there is none.
pub(crate) fn told(
    scans: &Scans,
    code: &'static str,
    frames: &[usize],
    what: impl Fn(usize) -> String,
) -> Option<Warning> {
    let &first = frames.first()?;
    let more = match frames.len() {
        1 => String::new(),
        more => format!("; so it is with {} more frames", more - 1),
    };
    Some(Warning::new(code, format!("{}: {}{more}", place(scans, first), what(first))))
}

/// What the user should know of the frames of `survey`, of which `lost` are lost, and of the template, which is frame `root`.
pub(crate) fn told_of_frames(scans: &Scans, survey: &Survey, root: usize, lost: &[(usize, Lost)]) -> Vec<Warning> {
    let turned = told(scans, "W_SCAN_INSIDE_OUT", &survey.turned, |_| {
        "its triangles face inwards: they were turned, nothing else need be done".into()
    });
    let littered = told(scans, "W_SCAN_DEBRIS", &survey.littered, |_| {
        "parts of less than a hundredth of its surface float about: they are left out; what belongs to the body must touch it".into()
    });
    let frames: Vec<usize> = survey.mended.iter().map(|mended| mended.0).collect();
    let mended = told(scans, "W_SCAN_MENDED", &frames, |frame| {
        let found = survey.mended.iter().find(|mended| mended.0 == frame).map(|mended| mended.1).unwrap_or_default();
        format!("{}: left out, nothing else need be done", left_out(found))
    });
    let parts = survey.frames.iter().position(|&frame| frame == root).map_or(1, |k| survey.candidates[k].parts);
    let apart = (parts > 1).then(|| {
        let message = format!(
            "{}, the template, has {parts} parts that do not touch: if they are two people, or a person and a thing, they become \
             one actor; take the other out of the frames, or name another template with --template-frame",
            place(scans, root)
        );
        Warning::new("W_SCAN_PARTS", message)
    });
    let frames: Vec<usize> = lost.iter().map(|lost| lost.0).collect();
    let lost = told(scans, "W_SCAN_LOST", &frames, |frame| {
        let found = lost.iter().find(|(lost, _)| *lost == frame);
        let why = found.map(|&(_, why)| with_remedy(why)).unwrap_or_default();
        format!("it is left out, and its sequence cut there: {why}")
    });
    turned.into_iter().chain(littered).chain(mended).chain(apart).chain(lost).collect()
}

/// What the user should know of the templates of `groups`: of which of them triangles are no part of the mesh that is written.
pub(crate) fn told_of_templates<'a>(scans: &Scans, groups: impl Iterator<Item = &'a Group>) -> Option<Warning> {
    let left_out: BTreeMap<usize, usize> =
        groups.map(|group| (group.root, group.template.left_out)).filter(|&(_, count)| count > 0).collect();
    let frames: Vec<usize> = left_out.keys().copied().collect();
    told(scans, "W_SCAN_MANIFOLD", &frames, |frame| {
        let count = left_out.get(&frame).copied().unwrap_or_default();
        format!(
            "it is the template, and {count} of its triangles meet others at edges that have a triangle on each side already: they \
             are no part of the mesh, which may have holes there; if these are seen, mend the frame, or name another template \
             with --template-frame"
        )
    })
}

/// How many triangles are no part of a frame's surface, and why.
fn left_out(mended: Mended) -> String {
    let counts = [
        (mended.doubled, "lie on others"),
        (mended.collapsed, "have no area"),
        (mended.crumbs, "are loose crumbs of fewer than 60"),
    ];
    let some = counts.iter().filter(|(count, _)| *count > 0);
    let words: Vec<String> = some.map(|(count, what)| format!("{count} {what}")).collect();
    format!("of its triangles {}", words.join(", "))
}

pub(crate) fn colourless() -> Warning {
    let message = "the frames have neither textures nor colours: the template may slide along the body, and nothing here can \
                   tell; give their textures (--texture), if there are any";
    Warning::new("W_SCAN_COLOURLESS", message.into())
}

/// What the user should know of frames that are registered, or are left out because they stand alone.
pub(crate) fn told_of_registered(scans: &Scans, registered: &Registered, alone: &[usize]) -> Vec<Warning> {
    let alone = told(scans, "W_SCAN_ALONE", alone, |_| {
        "it stands alone between lost frames, and is left out: mend those, and it stays".into()
    });
    let doubtful = |fit: &Fit| fit.stretch > MOST_STRETCH || fit.beyond > MOST_BEYOND || fit.strain > MOST_STRAIN;
    let stretched = registered.tracked.iter().filter(|tracked| doubtful(&tracked.fit));
    let stretched: Vec<usize> = stretched.map(|tracked| tracked.frame).collect();
    let heirs = heirs(registered, &stretched);
    let inherited = match heirs {
        0 => String::new(),
        _ => format!("; {heirs} more were tracked from these, and are where these are wrong, too"),
    };
    let doubtful = told(scans, "W_SCAN_DOUBTFUL", &stretched, |frame| {
        let found = registered.tracked.iter().find(|tracked| tracked.frame == frame).map(|tracked| tracked.fit);
        let fit = found.unwrap_or_default();
        format!(
            "{:.1} % of the template lies off the scan, and edges are up to {:.2} times as long as before, {:.1} % off their \
             length on average: look at it (--report shows the worst), and leave it out if it is wrong{inherited}",
            100.0 * fit.beyond,
            fit.stretch,
            100.0 * fit.strain
        )
    });
    let recoloured = told(scans, "W_SCAN_COLOURS", &registered.recoloured, |_| {
        "its colours have nothing to do with the template's, as of other clothes or another light: it was found by its shape alone, and the \
         rest of its sequence by the colours that it shows; look whether hands and feet are where they should be, for what slid along \
         the body there is off in the whole sequence"
            .into()
    });
    alone.into_iter().chain(recoloured).chain(doubtful).collect()
}

/// How many frames were tracked from those of `doubtful`, which are in order, from their children and so on.
fn heirs(registered: &Registered, doubtful: &[usize]) -> usize {
    let from: BTreeMap<usize, usize> =
        registered.tracked.iter().filter_map(|tracked| Some((tracked.frame, tracked.parent?))).collect();
    let is_doubtful = |frame: &usize| doubtful.binary_search(frame).is_ok();
    let is_heir = |frame: &&usize| {
        let ancestors = std::iter::successors(Some(**frame), |frame| from.get(frame).copied());
        !is_doubtful(frame) && ancestors.take(from.len() + 1).any(|ancestor| is_doubtful(&ancestor))
    };
    from.keys().filter(is_heir).count()
}
