//! Section 14: edits of recorded frames, the rig that moves them, and what is driven by it (Tejera, Casas and Hilton 2013, sections III
//! and V, figures 4 to 10).

mod basis;
mod driven;
mod figures;
mod held_out;
mod joined;
mod joints;
mod propagated;
mod shape;
mod skinned;
mod steps;
mod strip;
mod surface;
mod times;

use job::Job;
use rig::{RigOptions, estimate};

use self::driven::{Clips, driven};
use self::figures::figures;
use self::held_out::{HeldOut, PRODUCT, RIGID, held_out};
use self::joints::against_truth;
use self::propagated::{Propagated, propagated};
use self::times::times;
use super::EvaluateError;
use super::document::{Agreement, SectionReport, Verdict};
use super::subject::Subject;

/// The marks: learned over as rigid as possible; volume and limbs in percent, slide in millimetres.
const LEARNED: f64 = 1.1;
const PROPAGATED: [f64; 3] = [1.0, 2.0, 0.1];

/// Makes the section.
pub fn section(subject: &Subject, job: &Job) -> Result<SectionReport, EvaluateError> {
    let capture = &subject.capture;
    let mut section = SectionReport {
        text: vec![
            "Six patches (belly, head, hands and feet of a human\u{2019}s rig; else the ends of the surface) of one frame are put where a frame \
             of another sequence has them, both standing on one another; that sequence is held out of the learned space and of the rig. \
             The learned methods are equation 7 in displacements and edges, its rotations found in turn. The product has Laplacian, \
             as rigid as possible, one learned method, whose space is made of recorded frames as a bundle stores it, and the rig, by \
             which only the patches\u{2019} middles are dragged; the other learned ones are here alone."
                .into(),
        ],
        ..SectionReport::default()
    };
    if capture.timeline.sequences().len() < 2 {
        section.text.push("Held-out reconstruction is missing: there is one sequence alone.".into());
    } else {
        let HeldOut { tables, off, tasks, picture } = held_out(capture, job)?;
        section.tables.extend(tables);
        section.pictures.extend(picture);
        let ratio = off[PRODUCT] / off[RIGID];
        section.agreements.push(agreement(
            "Mark: learned is never above 1.1 times as rigid as possible",
            format!("{ratio:.2} times over {tasks} frames"),
            ratio <= LEARNED,
        ));
    }
    job.begin("rig")?;
    match estimate(&capture.topology, &capture.poses, &RigOptions::default()) {
        Ok(found) => with_rig(subject, &found.rig, &mut section, job)?,
        Err(error) => section.text.push(format!("Propagation, joints and driven sequences are missing: {error}.")),
    }
    section.text.push(
        "The paper\u{2019}s horse, platform and cones are not there: Figs. 3, 12, 13, 15 and 16 are made with this actor. The table of families \
         and their pictures (Figs. 7 and 8) are section 12."
            .into(),
    );
    Ok(section)
}

/// What needs a rig.
fn with_rig(
    subject: &Subject,
    rig: &editing::Rig,
    section: &mut SectionReport,
    job: &Job,
) -> Result<(), EvaluateError> {
    let capture = &subject.capture;
    let Propagated { table, notes, nonlinear, picture } = propagated(capture, rig, job)?;
    section.tables.push(table);
    section.tables.push(times(capture, rig, job)?);
    section.pictures.push(picture);
    section.pictures.extend(figures(capture, rig, job)?);
    section.text.extend(notes);
    if let Some([volume, limbs, slide]) = nonlinear {
        let holds = volume <= PROPAGATED[0] && (limbs.is_nan() || limbs <= PROPAGATED[1]) && slide <= PROPAGATED[2];
        section.agreements.push(agreement(
            "Mark: non-linear propagation keeps volume to 1 %, limbs to 2 %, and feet slide at most 0.1 mm a frame more",
            format!("{volume:.2} %, {limbs:.2} %, {slide:.3} mm"),
            holds,
        ));
    }
    match subject.truth.as_ref().map(|truth| against_truth(capture, rig, truth)) {
        Some(Some((table, all))) => {
            section.tables.push(table);
            let papers = "Mark: knees and ankles within 10 mm, shoulders, elbows and hips within 30 mm";
            section.agreements.push(agreement(papers, if all { "all" } else { "not all" }.into(), all));
        }
        Some(None) => section.text.push("Joints against the truth are missing: the rig is no human\u{2019}s.".into()),
        None => section.text.push("Joints against the truth are missing: this capture has no skeleton.".into()),
    }
    if subject.options.clips.is_empty() {
        section.text.push("Driven sequences are missing: no clip was given (--clips).".into());
        return Ok(());
    }
    let Clips { tables, pictures, hips, notes } = driven(capture, rig, &subject.options.clips, job)?;
    section.tables.extend(tables);
    section.pictures.extend(pictures);
    if !hips.is_empty() {
        let told: Vec<String> = hips.iter().map(|[ours, linear]| format!("{ours:.3} beside {linear:.3}")).collect();
        section.agreements.push(agreement(
            "Mark: what is driven keeps at the hips at least the volume of linear blend skinning (the least of any frame)",
            told.join(", "),
            hips.iter().all(|[ours, linear]| ours >= linear),
        ));
    }
    section.text.extend(notes);
    Ok(())
}

fn agreement(papers: &str, found: String, holds: bool) -> Agreement {
    Agreement { papers: papers.into(), found, verdict: Verdict::of(holds, holds), why: String::new() }
}
