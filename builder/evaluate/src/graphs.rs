//! Section 3: the essential graph against a motion graph (TVCG figure 9; thesis figures 3.2 and 3.8 to 3.10).

use std::time::Instant;

use super::EvaluateError;
use super::document::{Agreement, Cell, SectionReport, Table, Verdict};
use super::plot::{Plot, Series, SeriesStyle};
use super::statistics::{Moments, fit_line, percentile};
use super::subject::Subject;
use job::Job;
use kernels::random::mix;
use kernels::simd::Level;
use pipeline::essential::hidden_paths::hidden_paths;
use pipeline::essential::{Costs, PathLengths, essential_edges, motion_graph};
use pipeline::transitions::{LengthChoice, TransitionMatrix};

/// Weights of a frame's duration, as in the papers.
const ALPHAS: [f64; 6] = [0.01, 0.02, 0.03, 0.05, 0.1, 0.2];
/// Pairs that are plotted.
const PLOTTED_PAIRS: u64 = 120;
/// Runs of each algorithm whose times are compared, and for which alphas.
const RUNS: usize = 3;
const COMPARED_ALPHAS: [f64; 2] = [0.01, 0.03];

/// Why the essential graph may be further ahead, and denser, than in the papers.
const SPARSE_MOTION_GRAPH: &str = "Two choices that the papers leave open decide how far the essential graph is ahead, and \
    both are tried below: segment lengths by the least sum or the least mean, and what a local minimum is. The distances \
    themselves are exact (see the certificate).";

/// Both graphs for one alpha.
struct Row {
    alpha: f64,
    motion: Moments,
    essential: Moments,
    /// Densities, recorded steps included.
    density: [f64; 2],
    unreachable: [u64; 2],
    certificate: Certificate,
    /// Pairs that cost more in the motion graph, and the largest share that one costs more.
    dearer: (u64, f64),
    /// Costs of some pairs in both, sorted by the motion graph's.
    plotted: Vec<(f64, f64)>,
}

/// The comparison of all pairs' distances in the essential graph with those in the complete digraph.
struct Certificate {
    pairs: u64,
    different: u64,
    largest: f64,
}

/// Makes the section.
pub(super) fn section(subject: &Subject, job: &Job) -> Result<SectionReport, EvaluateError> {
    let transitions = subject.transitions(LengthChoice::Total, job)?;
    let mut rows = Vec::new();
    for (done, alpha) in ALPHAS.into_iter().enumerate() {
        job.tell("graphs", done as u64, ALPHAS.len() as u64)?;
        rows.push(compare(subject, transitions, alpha)?);
    }
    let by_mean = subject.transitions(LengthChoice::Mean, job)?;
    let mean_row = compare(subject, by_mean, subject.options.alpha)?;
    let total_row = compare(subject, transitions, subject.options.alpha)?;
    let dear = ALPHAS[ALPHAS.len() - 1];
    let mean_dear = compare(subject, by_mean, dear)?;
    let mut section = SectionReport::default();
    section.text.push(
        "Shortest paths between all pairs of frames, their costs E = D + alpha L. The motion graph has the transitions \
         whose cost is strictly less than at their eight neighbours within the matrix of their pair of sequences, \
         without a threshold; both graphs have the recorded steps. Means are over the pairs that both graphs join."
            .into(),
    );
    let lengths = [("sum", &total_row, rows.last()), ("mean", &mean_row, Some(&mean_dear))];
    section.tables = vec![costs_table(&rows), certificate_table(&rows), lengths_table(lengths)];
    section.tables.push(definitions(subject, transitions, dear)?);
    section.tables.push(algorithms(subject, transitions, job)?);
    section.tables.push(one_for_all(subject, transitions, job)?);
    section.agreements = agreements(&rows);
    section.plots = plots(&rows);
    Ok(section)
}

fn compare(subject: &Subject, transitions: &TransitionMatrix, alpha: f64) -> Result<Row, EvaluateError> {
    compare_with(subject, transitions, alpha, &motion_graph(transitions, subject.timeline(), alpha))
}

/// The essential graph against the recorded steps with the transitions `motion`, sorted.
fn compare_with(
    subject: &Subject,
    transitions: &TransitionMatrix,
    alpha: f64,
    motion: &[(u32, u32)],
) -> Result<Row, EvaluateError> {
    let timeline = subject.timeline();
    let n = subject.frame_count();
    let essential = essential_edges(transitions, timeline, alpha)?;
    let costs = Costs { transitions, timeline, alpha: essential.alpha };
    let off_diagonal = |i: usize, j: usize, cost: f64| if i == j { f64::INFINITY } else { cost };
    let level = Level::best();
    let full = PathLengths::new(level, n, |i, j| off_diagonal(i, j, costs.edge(i as u32, j as u32)));
    let within = |edges: &[(u32, u32)]| {
        PathLengths::new(level, n, |i, j| {
            let pair = (i as u32, j as u32);
            let kept = edges.binary_search(&pair).is_ok();
            let synthetic = if kept { costs.synthetic(pair.0, pair.1) } else { f64::INFINITY };
            let step = if timeline.next(pair.0) == Some(pair.1) { costs.alpha } else { f64::INFINITY };
            off_diagonal(i, j, synthetic.min(step))
        })
    };
    let (by_essential, by_motion) = (within(&essential.edges), within(motion));
    let mut row = Row {
        alpha,
        motion: Moments::default(),
        essential: Moments::default(),
        density: [density(timeline, motion.len()), density(timeline, essential.edges.len())],
        unreachable: [0, essential.unreachable_pairs],
        certificate: Certificate { pairs: 0, different: 0, largest: 0.0 },
        dearer: (0, 0.0),
        plotted: Vec::new(),
    };
    for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))).filter(|(i, j)| i != j) {
        let (e, f, m) = (by_essential.from(i)[j], full.from(i)[j], by_motion.from(i)[j]);
        row.certificate.pairs += 1;
        if e != f {
            row.certificate.different += 1;
            row.certificate.largest = row.certificate.largest.max((e - f).abs());
        }
        row.unreachable[0] += u64::from(m == f64::INFINITY);
        if m < f64::INFINITY && e < f64::INFINITY {
            row.motion.add(m);
            row.essential.add(e);
            row.dearer.0 += u64::from(m > e);
            row.dearer.1 = row.dearer.1.max(m / e - 1.0);
        }
    }
    let seed = subject.options.seed;
    let draw = |index: u64| {
        let (i, j) = ((mix(seed, 2 * index) % n as u64) as usize, (mix(seed, 2 * index + 1) % n as u64) as usize);
        (by_motion.from(i)[j], by_essential.from(i)[j])
    };
    row.plotted = (0..PLOTTED_PAIRS).map(draw).filter(|pair| pair.0 < f64::INFINITY).collect();
    row.plotted.sort_by(|a, b| a.0.total_cmp(&b.0));
    Ok(row)
}

/// Edges over possible edges, recorded steps included (thesis equation 3.4).
fn density(timeline: &actor::timeline::Timeline, transitions: usize) -> f64 {
    let n = timeline.frame_count();
    let steps = (0..n).filter(|&frame| timeline.next(frame).is_some()).count();
    (transitions + steps) as f64 / (f64::from(n) * f64::from(n.max(2) - 1))
}

fn costs_table(rows: &[Row]) -> Table {
    let mut table = Table::new(
        "graphs",
        "Costs of shortest paths and densities, by the weight alpha of a frame.",
        &[
            "alpha",
            "motion graph",
            "deviation",
            "essential graph",
            "deviation ",
            "cheaper by",
            "motion density",
            "essential density",
            "pairs motion cannot join",
            "pairs essential cannot join",
        ],
    );
    for row in rows {
        table.rows.push(vec![
            Cell::Number(row.alpha, 2),
            Cell::Number(row.motion.mean, 4),
            Cell::Number(row.motion.deviation(), 4),
            Cell::Number(row.essential.mean, 4),
            Cell::Number(row.essential.deviation(), 4),
            Cell::Text(format!("{:.1} %", saving(row))),
            Cell::Number(row.density[0], 5),
            Cell::Number(row.density[1], 5),
            Cell::Count(row.unreachable[0]),
            Cell::Count(row.unreachable[1]),
        ]);
    }
    table
}

fn saving(row: &Row) -> f64 {
    100.0 * (1.0 - row.essential.mean / row.motion.mean)
}

fn certificate_table(rows: &[Row]) -> Table {
    let mut table = Table::new(
        "certificate",
        "Distances of all pairs in the essential graph against those in the complete digraph of all transitions, \
         computed apart from each other: they are to be the same bit for bit, and infinite for the same pairs.",
        &["alpha", "pairs compared", "pairs that differ", "largest difference"],
    );
    for row in rows {
        let certificate = &row.certificate;
        table.rows.push(vec![
            Cell::Number(row.alpha, 2),
            Cell::Count(certificate.pairs),
            Cell::Count(certificate.different),
            Cell::Number(certificate.largest, 1),
        ]);
    }
    table
}

fn lengths_table(choices: [(&str, &Row, Option<&Row>); 2]) -> Table {
    let mut table = Table::new(
        "lengths",
        "The graph with segment lengths by the least sum against lengths by the least mean, at the capture\u{2019}s own \
         alpha.",
        &["lengths by", "essential density", "mean path cost", "deviation", "cheaper than motion at alpha 0.2 by"],
    );
    for (name, row, dear) in choices {
        table.rows.push(vec![
            name.into(),
            Cell::Number(row.density[1], 5),
            Cell::Number(row.essential.mean, 4),
            Cell::Number(row.essential.deviation(), 4),
            dear.map_or(Cell::Empty, |row| Cell::Text(format!("{:.1} %", saving(row)))),
        ]);
    }
    table
}

/// Alphas that are no rung of the ladder for which a graph is exact, as far from two of them as may be.
const BETWEEN: [f64; 5] = [0.0135, 0.0246, 0.0447, 0.0815, 0.1484];

/// The one graph that is packed for all alphas of the player's range, at those where it is not exact by construction.
fn one_for_all(subject: &Subject, transitions: &TransitionMatrix, job: &Job) -> Result<Table, EvaluateError> {
    let mut table = Table::new(
        "one_graph",
        "The graph that is packed, which holds all that is essential at some alphas of the player\u{2019}s range, at others          between them: shortest paths of all pairs of frames against the complete digraph\u{2019}s.",
        &["alpha", "essential there", "packed", "mean path cost", "packed ", "pairs that cost more", "at most more by"],
    );
    let graph = subject.graph(LengthChoice::Total, job)?;
    let packed: Vec<(u32, u32)> = graph.transitions().iter().map(|edge| (edge.from, edge.to)).collect();
    for (done, alpha) in BETWEEN.into_iter().enumerate() {
        job.tell("graphs between", done as u64, BETWEEN.len() as u64)?;
        let row = compare_with(subject, transitions, alpha, &packed)?;
        let essential = essential_edges(transitions, subject.timeline(), alpha)?.edges.len();
        table.rows.push(vec![
            Cell::Number(alpha, 4),
            Cell::Count(essential as u64),
            Cell::Count(packed.len() as u64),
            Cell::Number(row.essential.mean, 5),
            Cell::Number(row.motion.mean, 5),
            Cell::Count(row.dearer.0),
            Cell::Text(format!("{:.2} %", 100.0 * row.dearer.1)),
        ]);
    }
    Ok(table)
}

/// How much hangs on what a local minimum is: the papers do not say it.
fn definitions(subject: &Subject, transitions: &TransitionMatrix, alpha: f64) -> Result<Table, EvaluateError> {
    let timeline = subject.timeline();
    let essential = essential_edges(transitions, timeline, alpha)?;
    let costs = Costs { transitions, timeline, alpha: essential.alpha };
    let around: Steps = (-1..=1).flat_map(|di| (-1..=1).map(move |dj| (di, dj))).collect();
    let cross: Steps = around.iter().copied().filter(|(di, dj)| (di + dj).abs() == 1).collect();
    let along = |step: fn(&(i64, i64)) -> i64| around.iter().copied().filter(|pair| step(pair) == 0).collect::<Steps>();
    let (rows, columns) = (along(|pair| pair.0), along(|pair| pair.1));
    let mut table = Table::new(
        "local_minima",
        format!(
            "The motion graph at alpha {alpha} by what counts as a local minimum. Along a row: over the frames of the \
             destination alone; along a row or a column: over those of either."
        ),
        &["least among", "motion density", "mean cost", "essential cheaper by"],
    );
    let definitions: [(&str, Vec<&Steps>); 4] = [
        ("8 neighbours", vec![&around]),
        ("4 neighbours", vec![&cross]),
        ("2 along a row", vec![&rows]),
        ("2 along a row or a column", vec![&rows, &columns]),
    ];
    for (name, neighbourhoods) in definitions {
        let n = timeline.frame_count();
        let pairs = (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
        let edges: Vec<(u32, u32)> =
            pairs.filter(|&pair| neighbourhoods.iter().any(|steps| is_least(&costs, pair, steps))).collect();
        let row = compare_with(subject, transitions, alpha, &edges)?;
        table.rows.push(vec![
            name.into(),
            Cell::Number(row.density[0], 5),
            Cell::Number(row.motion.mean, 4),
            Cell::Text(format!("{:.1} %", saving(&row))),
        ]);
    }
    Ok(table)
}

/// Steps to neighbours, in frames of the source and of the destination.
type Steps = Vec<(i64, i64)>;

fn is_least(costs: &Costs, (i, j): (u32, u32), steps: &Steps) -> bool {
    let cost = costs.synthetic(i, j);
    let neighbours = steps.iter().filter(|step| **step != (0, 0));
    let exists = |&(di, dj): &(i64, i64)| Some((costs.timeline.offset(i, di)?, costs.timeline.offset(j, dj)?));
    cost < costs.recorded(i, j) && neighbours.filter_map(exists).all(|(k, l)| cost < costs.edge(k, l))
}

/// Blocked Floyd and Warshall against hidden paths: the same edges, and how long each takes.
fn algorithms(subject: &Subject, transitions: &TransitionMatrix, job: &Job) -> Result<Table, EvaluateError> {
    let timeline = subject.timeline();
    let mut table = Table::new(
        "algorithms",
        "The essential graph by blocked shortest paths (ours) and by the hidden-paths algorithm of Karger, Koller and \
         Phillips: medians of three runs, one after the other, of wall time; hidden paths run on one thread.",
        &["alpha", "edges kept", "same edges", "ours, s", "hidden paths, s"],
    );
    table.timed = true;
    for (done, alpha) in COMPARED_ALPHAS.into_iter().enumerate() {
        job.tell("hidden paths", done as u64, 2)?;
        let (mut ours, mut hidden, mut same, mut kept) = (Vec::new(), Vec::new(), true, 0);
        for _ in 0..RUNS {
            let start = Instant::now();
            let essential = essential_edges(transitions, timeline, alpha)?;
            ours.push(start.elapsed().as_secs_f64());
            let start = Instant::now();
            let edges = hidden_paths(transitions, timeline, alpha);
            hidden.push(start.elapsed().as_secs_f64());
            same &= edges == essential.edges;
            kept = edges.len() as u64;
        }
        table.rows.push(vec![
            Cell::Number(alpha, 2),
            Cell::Count(kept),
            if same { "yes" } else { "no" }.into(),
            Cell::Number(percentile(&ours, 0.5).unwrap_or(f64::NAN), 3),
            Cell::Number(percentile(&hidden, 0.5).unwrap_or(f64::NAN), 3),
        ]);
    }
    Ok(table)
}

fn agreements(rows: &[Row]) -> Vec<Agreement> {
    let last = rows.last().map_or(f64::NAN, saving);
    let cheaper = rows.iter().all(|row| row.essential.mean <= row.motion.mean);
    let line = fit_line(&rows.iter().map(|row| (row.alpha, row.density[1])).collect::<Vec<_>>());
    let explained = line.map_or(f64::NAN, |line| line.explained);
    let rising = rows.windows(2).all(|pair| pair[1].density[1] > pair[0].density[1]);
    let growing = rows.windows(2).all(|pair| saving(&pair[1]) >= saving(&pair[0]));
    let sparser = rows.first().is_some_and(|row| row.density[1] < row.density[0]);
    let differing: u64 = rows.iter().map(|row| row.certificate.different).sum();
    let compared: u64 = rows.iter().map(|row| row.certificate.pairs).sum();
    let savings: Vec<String> = rows.iter().map(|row| format!("{:.1}", saving(row))).collect();
    vec![
        Agreement {
            papers: "Distances in the essential graph are those of the complete digraph (by construction)".into(),
            found: format!("{differing} of {compared} pairs differ"),
            verdict: Verdict::of(differing == 0, differing == 0),
            why: String::new(),
        },
        Agreement {
            papers: "Shortest paths are 15 to 18 % cheaper than the motion graph\u{2019}s at alpha 0.2".into(),
            found: format!("{last:.1} % cheaper"),
            verdict: Verdict::of(cheaper, (11.0..=22.0).contains(&last)),
            why: if (11.0..=22.0).contains(&last) { String::new() } else { SPARSE_MOTION_GRAPH.into() },
        },
        Agreement {
            papers: "The lead grows with alpha, from 0.5 to 1.9 % at 0.01".into(),
            found: format!("{} %", savings.join(", ")),
            verdict: Verdict::of(cheaper, growing),
            why: String::new(),
        },
        Agreement {
            papers: "The density of the essential graph grows almost linearly with alpha".into(),
            found: format!("a straight line explains {:.1} % of its variance", 100.0 * explained),
            verdict: Verdict::of(rising, explained > 0.95),
            why: String::new(),
        },
        Agreement {
            papers: "At alpha 0.01 the essential graph is sparser than the motion graph".into(),
            found: rows
                .first()
                .map_or(String::new(), |row| format!("densities {:.4} and {:.4}", row.density[1], row.density[0])),
            verdict: Verdict::of(sparser, sparser),
            why: if sparser { String::new() } else { SPARSE_MOTION_GRAPH.into() },
        },
    ]
}

fn plots(rows: &[Row]) -> Vec<Plot> {
    let series = |name: &str, colour, value: &dyn Fn(&Row) -> f64| {
        Series::new(name, SeriesStyle::DottedLine, colour, rows.iter().map(|row| (row.alpha, value(row))).collect())
    };
    let by_alpha = |caption: &str, y: &str, series: Vec<Series>| Plot {
        caption: caption.into(),
        x: "alpha, cost of a frame".into(),
        y: y.into(),
        series,
        from_zero: true,
        ..Plot::default()
    };
    let mut plots = vec![
        by_alpha(
            "Mean cost of shortest paths between all pairs (TVCG figure 9a to 9c).",
            "cost",
            vec![
                series("motion graph", 1, &|row| row.motion.mean),
                series("essential graph", 0, &|row| row.essential.mean),
            ],
        ),
        by_alpha(
            "Density (TVCG figure 9d to 9f; thesis figure 3.2).",
            "edges over possible edges",
            vec![series("motion graph", 1, &|row| row.density[0]), series("essential graph", 0, &|row| row.density[1])],
        ),
    ];
    for row in rows.iter().filter(|row| [0.05, 0.2].contains(&row.alpha)) {
        let line = |name: &str, colour, value: fn(&(f64, f64)) -> f64| {
            let points = row.plotted.iter().enumerate().map(|(pair, costs)| (pair as f64, value(costs))).collect();
            Series::new(name, SeriesStyle::Line, colour, points)
        };
        plots.push(Plot {
            caption: format!("Costs of some pairs at alpha {} (thesis figures 3.8b, 3.8c).", row.alpha),
            x: "pairs of frames, by their cost in the motion graph".into(),
            y: "cost".into(),
            series: vec![line("motion graph", 1, |costs| costs.0), line("essential graph", 0, |costs| costs.1)],
            from_zero: true,
            ..Plot::default()
        });
    }
    plots
}
