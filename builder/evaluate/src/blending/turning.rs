//! Sequences that turn apart, blended with recurring alignment and without (TVCG figures 11 and 12).

use actor::timeline::Sequence;

use crate::document::{Agreement, Cell, SectionReport, Table, Verdict};
use crate::plot::{Plot, Series, SeriesStyle};
use crate::subject::Subject;
use crate::trajectories::{Pairing, Trajectory, aligned, length, linear, sides};

/// Blends two sequences that turn apart.
pub(super) fn trajectories(subject: &Subject, section: &mut SectionReport) {
    let Some((names, pairing)) = turning_apart(subject) else {
        section.text.push("No two sequences are long enough to be blended as in TVCG figure 11.".into());
        return;
    };
    let (headings, centres) = (&subject.measured.headings, subject.centres.as_slice());
    let recorded = sides(pairing, headings, centres);
    let whole = (length(&recorded[0]) + length(&recorded[1])) / 2.0;
    let mut table = Table::new(
        "trajectories",
        format!(
            "Length of the centre of mass\u{2019}s trajectory when {} and {} are blended, against the mean of both, over \
             {} frames.",
            names[0], names[1], pairing.length
        ),
        &[
            "weight",
            "without alignment, m",
            "with recurring alignment, m",
            "mean of both, m",
            "kept without",
            "kept with",
        ],
    );
    let half = |_: f32| 0.5;
    let rising = |t: f32| t;
    let weights: [(&str, &dyn Fn(f32) -> f32); 2] = [("0.5 throughout", &half), ("from 0 to 1", &rising)];
    let mut kept = Vec::new();
    for (name, weight) in weights {
        let without = linear(pairing, headings, centres, weight);
        let with = aligned(pairing, headings, centres, weight);
        let (a, b) = (length(&without), length(&with));
        kept.push((a / whole, b / whole));
        table.rows.push(vec![
            name.into(),
            Cell::Number(a, 3),
            Cell::Number(b, 3),
            Cell::Number(whole, 3),
            Cell::Text(format!("{:.0} %", 100.0 * a / whole)),
            Cell::Text(format!("{:.0} %", 100.0 * b / whole)),
        ]);
        let line = |name: &str, kind, colour, trajectory: &Trajectory| {
            Series::new(name, kind, colour, trajectory.iter().map(|p| (f64::from(p.x), f64::from(p.y))).collect())
        };
        section.plots.push(Plot {
            caption: format!("Centre of mass, weight {name} (TVCG figures 11 and 12)."),
            x: "x, m".into(),
            y: "z, m".into(),
            series: vec![
                line(&names[0], SeriesStyle::Dashes, 5, &recorded[0]),
                line(&names[1], SeriesStyle::Dashes, 4, &recorded[1]),
                line("without alignment", SeriesStyle::Line, 1, &without),
                line("recurring alignment", SeriesStyle::Line, 0, &with),
            ],
            equal: true,
            ..Plot::default()
        });
    }
    section.tables.push(table);
    let (without, with) = kept[0];
    section.agreements.push(Agreement {
        papers: "Recurring alignment keeps the trajectory from collapsing".into(),
        found: format!("{:.0} % of the way is kept with it, {:.0} % without", 100.0 * with, 100.0 * without),
        verdict: Verdict::of(with > without, with > 0.9 && with < 1.15),
        why: String::new(),
    });
}

/// The two sequences whose bodies turn furthest apart, by their names and labels where those say left and right.
fn turning_apart(subject: &Subject) -> Option<([String; 2], Pairing)> {
    let sequences = subject.timeline().sequences();
    let says = |sequence: &Sequence, side: &str| {
        sequence.name.contains(side) || sequence.labels.iter().any(|label| label.contains(side))
    };
    let pairing = |a: &Sequence, b: &Sequence| Pairing {
        first: [a.first_frame, b.first_frame],
        length: a.frame_count.min(b.frame_count),
    };
    let named = |a: &Sequence, b: &Sequence| ([a.name.clone(), b.name.clone()], pairing(a, b));
    let left = sequences.iter().find(|sequence| says(sequence, "left"));
    let right = sequences.iter().find(|sequence| says(sequence, "right"));
    if let (Some(left), Some(right)) = (left, right) {
        return Some(named(left, right));
    }
    let headings = &subject.measured.headings;
    let apart = |a: &Sequence, b: &Sequence| {
        let length = a.frame_count.min(b.frame_count) - 1;
        let turn = |s: &Sequence| headings.get(s.first_frame as usize, (s.first_frame + length) as usize);
        (turn(a) - turn(b)).abs()
    };
    let pairs = sequences.iter().enumerate().flat_map(|(i, a)| sequences[i + 1..].iter().map(move |b| (a, b)));
    let long = pairs.filter(|(a, b)| a.frame_count.min(b.frame_count) >= 12);
    long.max_by(|x, y| apart(x.0, x.1).total_cmp(&apart(y.0, y.1))).map(|(a, b)| named(a, b))
}
