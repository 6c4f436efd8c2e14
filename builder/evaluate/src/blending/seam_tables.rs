//! Seams of transitions against the capture's own change from frame to frame.

use crate::document::{Agreement, Cell, SectionReport, Table, Verdict};
use crate::plot::{Plot, Series, SeriesStyle, histogram};
use crate::seams::{Change, Ease, Own, SeamSummary, Seams};
use crate::subject::Subject;
use pipeline::transitions::LengthChoice;

/// The seams of some transitions of one graph.
pub(super) struct SeamReport {
    pub(super) choice: LengthChoice,
    /// Where the transitions were drawn from: the graph, or cheapest walks.
    pub(super) population: &'static str,
    pub(super) ease: Ease,
    pub(super) seams: Vec<Seams>,
}

/// The table of seams, what it says of the papers, and a plot.
pub(super) fn seam_tables(
    subject: &Subject,
    reports: &[SeamReport],
    own: &Own,
    limit: Change,
    section: &mut SectionReport,
) {
    let mut table = Table::new(
        "seams",
        format!(
            "Seams of up to {most} transitions of each graph drawn at random, and of the transitions on \
             cheapest walks between frames drawn at random, against the capture\u{2019}s own change from \
             frame to frame, whose 99th percentile is {:.2} mm (geometry) and {:.2} mm a frame (velocity); root mean \
             squares over the vertices.",
            limit.geometry * 1e3,
            limit.velocity * 1e3,
            most = subject.options.seam_transitions
        ),
        &[
            "lengths by",
            "drawn from",
            "weight",
            "seams",
            "geometry above",
            "velocity above",
            "geometry: median, mm",
            "99th",
            "most",
            "velocity: median, mm a frame",
            "99th ",
            "most ",
        ],
    );
    let share = |above: u64, count: u64| format!("{:.1} %", 100.0 * above as f64 / count.max(1) as f64);
    let mut summaries = Vec::new();
    for SeamReport { choice, population, ease, seams } in reports {
        let s = SeamSummary::of(seams, limit);
        summaries.push(s);
        table.rows.push(vec![
            choice.word().into(),
            (*population).into(),
            if *ease == Ease::Linear { "linear" } else { "smooth" }.into(),
            Cell::Count(s.count),
            Cell::Text(share(s.above[0], s.count)),
            Cell::Text(share(s.above[1], s.count)),
            Cell::Number(s.median.geometry * 1e3, 2),
            Cell::Number(s.high.geometry * 1e3, 2),
            Cell::Number(s.greatest.geometry * 1e3, 2),
            Cell::Number(s.median.velocity * 1e3, 2),
            Cell::Number(s.high.velocity * 1e3, 2),
            Cell::Number(s.greatest.velocity * 1e3, 2),
        ]);
    }
    section.tables.push(table);
    let walked = |ease: Ease| {
        let mut reports = reports.iter().zip(&summaries);
        reports.find(|(report, _)| report.population == "walks" && report.ease == ease).map(|(_, summary)| summary)
    };
    let (Some(first), papers) = (walked(Ease::Smooth), walked(Ease::Linear)) else { return };
    section.agreements.push(Agreement {
        papers: "Our own mark: no seam above the capture\u{2019}s 99th percentile in geometry and velocity".into(),
        found: format!(
            "{} of {} seams on walks above in geometry, {} in velocity, with our weight and lengths by the sum; the papers\u{2019}: {} and {}",
            first.above[0],
            first.count,
            first.above[1],
            papers.map_or(0, |papers| papers.above[0]),
            papers.map_or(0, |papers| papers.above[1])
        ),
        verdict: Verdict::of(first.above[0] == 0, first.above == [0, 0]),
        why: "Between shapes far apart a blend has to move faster than the capture does, whatever its weight.".into(),
    });
    section.text.push(
        "Our weight begins and ends at rest (3 t\u{b2} minus 2 t\u{b3}); the papers\u{2019} grows evenly, so that at the \
         first synthetic frame the surface takes on the velocity (destination minus source) over L at once. The rows \
         named linear show the papers\u{2019}, along our paths on the ground."
            .into(),
    );
    let velocities = |seams: &[Seams]| -> Vec<f64> {
        let changes = seams.iter().flat_map(|seams| [seams.start, seams.end]).flatten();
        changes.map(|change| change.velocity * 1e3).collect()
    };
    let bins = |values: &[f64]| histogram(values, 40);
    let outline = |name: &str, colour, values: &[f64]| Series::new(name, SeriesStyle::Line, colour, bins(values));
    let recorded: Vec<f64> = own.velocity.iter().map(|velocity| velocity * 1e3).collect();
    section.plots.push(Plot {
        caption: "Change of velocity at seams and at recorded frames; the line marks the recorded 99th percentile."
            .into(),
        x: "change of velocity, mm a frame (RMS)".into(),
        y: "share".into(),
        series: [
            vec![outline("recorded frames", 5, &recorded)],
            reports
                .iter()
                .filter(|report| report.choice == LengthChoice::Total && report.population == "walks")
                .map(|SeamReport { ease, seams, .. }| {
                    let (name, colour) =
                        if *ease == Ease::Linear { ("seams, linear", 1) } else { ("seams, smooth", 0) };
                    outline(name, colour, &velocities(seams))
                })
                .collect(),
        ]
        .concat(),
        marks: vec![(limit.velocity * 1e3, "99 %".into(), 2)],
        from_zero: true,
        ..Plot::default()
    });
}
