//! The sentences of an answer, for where it does not do what was asked.

use super::answer::KeyRow;
use super::path::PathReport;
use super::place::PlaceReport;

/// Metres off a place and radians off a heading (10 degrees) that are worth a sentence.
const PLACE_OFF: f64 = 0.1;
const HEADING_OFF: f64 = 0.175;

/// Metres that a bent walk is off its path that are worth a sentence.
pub(super) const LEFT: f64 = 0.06;

pub(super) fn path_notes(report: &PathReport, is_bent: bool) -> Vec<String> {
    let mut notes = Vec::new();
    if report.travelled + 0.05 < report.length {
        let (travelled, length) = (report.travelled, report.length);
        notes.push(format!("The motion does not get to the path's end: it travels {travelled:.1} of {length:.1} m."));
    }
    if is_bent && report.max_aside > LEFT {
        let aside = 100.0 * report.max_aside;
        notes.push(format!(
            "The walk strays up to {aside:.0} cm from the path: no step is bent by more than 10 degrees and 10 cm."
        ));
    } else if report.max_aside > 0.5 {
        let aside = report.max_aside;
        notes.push(format!(
            "The walk strays up to {aside:.1} m from the path: no motion of this capture turns like it."
        ));
    }
    if let Some(kept) = report.demands_kept.filter(|&kept| kept < 0.95) {
        notes.push(format!("{:.0} % of the painted stretches show what they demand.", 100.0 * kept));
    }
    notes
}

pub(super) fn place_notes(report: &PlaceReport) -> Vec<String> {
    let mut notes = Vec::new();
    if report.distance > PLACE_OFF {
        notes.push(format!("The walk ends {:.2} m from the place: none was found that comes closer.", report.distance));
    }
    if let Some(turn) = report.turn.filter(|&turn| turn > HEADING_OFF) {
        let degrees = turn.to_degrees();
        notes.push(format!(
            "It faces {degrees:.0} degrees away from the heading asked for: no walk was found that turns closer."
        ));
    }
    notes
}

pub(super) fn keys_notes(fps: f64, rows: &[KeyRow]) -> Vec<String> {
    let mut notes = Vec::new();
    for (index, row) in rows.iter().enumerate() {
        if row.shown != row.frame && row.reached.is_some() {
            notes.push(substitute_note(row.frame, row.shown));
        }
        match row.reached {
            None => notes.push(format!("No walk leads to key pose {}; it is left out.", index + 1)),
            Some(reached) if f64::from(reached.abs_diff(row.wanted)) > 0.25 * fps => {
                let seconds = f64::from(reached.abs_diff(row.wanted)) / fps;
                let how = if reached > row.wanted { "late" } else { "early" };
                notes.push(format!("Key pose {} comes {seconds:.2} s {how}: it cannot be closer in time.", index + 1));
            }
            Some(_) => {}
        }
    }
    notes
}

pub(super) fn substitute_note(frame: u32, shown: u32) -> String {
    format!("Nothing leads to frame {frame}: frame {shown}, the nearest that the actor can get to, is shown instead.")
}
