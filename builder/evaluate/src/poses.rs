//! Section 1: pose distances against the skeleton's truth (TVCG table 1; thesis figures 2.5 to 2.7).

use glam::{EulerRot, Quat};
use rayon::prelude::*;

use super::EvaluateError;
use super::document::{Agreement, Cell, SectionReport, Table, Verdict};
use super::plot::{Plot, Series, SeriesStyle, histogram};
use super::statistics::{
    Classes, Correlogram, Mantel, distance_correlation, mantel, mantel_correlogram, pearson, upper_triangle,
};
use super::subject::Subject;
use super::truth::Truth;
use job::Job;
use pipeline::distance::{DistanceKind, DistanceMatrix, DistanceOptions, pose_distances};

/// Classes of the correlogram.
const CLASSES: u8 = 12;
/// Permutations behind the correlogram's bounds.
const CORRELOGRAM_PERMUTATIONS: usize = 500;
/// Pairs that are plotted.
const PLOTTED_PAIRS: usize = 2000;

/// Why the correlation may be lower than in the papers.
const FEW_JOINTS: &str = "The root of squared angles lets a few joints decide that swing far but move little of the \
    surface, such as those of raised arms; the column with the sum of angles shows how much of it that is.";

/// A pose distance of all pairs, n x n.
struct Distance {
    name: &'static str,
    values: Vec<f32>,
}

/// Makes the section.
pub(super) fn section(subject: &Subject, job: &Job) -> Result<SectionReport, EvaluateError> {
    let Some(truth) = &subject.truth else {
        return Ok(super::missing("The capture comes without the truth of a skeleton."));
    };
    let n = subject.frame_count();
    let euler = skeleton_distances(truth, n, euler_distance);
    let geodesic = skeleton_distances(truth, n, geodesic_distance);
    let measure = |kind| {
        let options = DistanceOptions { kind, ..DistanceOptions::default() };
        pose_distances(&subject.capture.topology, &subject.capture.poses, &options, job)
    };
    let whole = |matrix: &DistanceMatrix| (0..n).flat_map(|i| matrix.row(i)).copied().collect::<Vec<f32>>();
    let euclidean = whole(&measure(DistanceKind::Euclidean)?);
    let distances = [
        Distance { name: "ours, logarithm", values: whole(&subject.measured.distances) },
        Distance { name: "ours, Frobenius", values: whole(&measure(DistanceKind::DeformationFrobenius)?) },
        Distance { name: "Euclidean, its root", values: euclidean.iter().map(|value| value.max(0.0).sqrt()).collect() },
        Distance { name: "Euclidean", values: euclidean },
    ];
    job.begin("Mantel test")?;
    let values: Vec<&[f32]> = distances.iter().map(|distance| distance.values.as_slice()).collect();
    let test = mantel(n, &euler, &values, subject.options.permutations, subject.options.seed);
    let upper = |matrix: &[f32]| upper_triangle(n, |i, j| matrix[i * n + j]);
    let (euler_upper, geodesic_upper) = (upper(&euler), upper(&geodesic));
    let uppers: Vec<Vec<f32>> = values.iter().map(|matrix| upper(matrix)).collect();
    let by_distance: Vec<[f64; 3]> = uppers
        .par_iter()
        .map(|own| {
            let by_distance = distance_correlation(own, &euler_upper);
            [by_distance, pearson(own, &geodesic_upper), distance_correlation(own, &geodesic_upper)]
        })
        .collect();
    job.begin("correlogram")?;
    let classes = Classes::new(&euler_upper, CLASSES);
    let correlogram = |index: usize| {
        let (distance, seed) = (&distances[index].values, subject.options.seed);
        mantel_correlogram(n, &euler_upper, &classes, distance, CORRELOGRAM_PERMUTATIONS, seed)
    };
    let correlograms = [correlogram(0), correlogram(3)];

    let mut section = SectionReport::default();
    section.text.push(format!(
        "All {} pairs of {n} frames. The truth is the distance between joint angles (thesis equation 2.15): Euler angles \
         about X, Y and Z of {} joints against their parents, the root without its heading, loose hair left out. Beside \
         it, because Euler angles depend on a convention, the sum of the joints\u{2019} angles of rotation (thesis \
         equation 2.1). No pair is left out.",
        euler_upper.len(),
        truth.pose_joints().len()
    ));
    section.tables =
        vec![correlation_table(&distances, &test, &by_distance), correlogram_table(&classes, &correlograms)];
    section.agreements = agreements(&test, &by_distance);
    section.plots = plots(&test, &classes, &correlograms, &euler_upper, [&uppers[0], &uppers[3]]);
    Ok(section)
}

/// Distances of all pairs, n x n, in radians.
fn skeleton_distances(truth: &Truth, n: usize, distance: fn(&[Quat], &[Quat]) -> f32) -> Vec<f32> {
    let joints = truth.pose_joints();
    let poses: Vec<Vec<Quat>> =
        (0..n).map(|frame| joints.iter().map(|&joint| truth.rotation(frame, joint)).collect()).collect();
    let row = |i: usize| poses.iter().map(|other| distance(&poses[i], other)).collect::<Vec<f32>>();
    (0..n).into_par_iter().flat_map_iter(row).collect()
}

/// Thesis equations 2.15 and 2.16, over all joints.
fn euler_distance(a: &[Quat], b: &[Quat]) -> f32 {
    let angle = |x: f32, y: f32| {
        let apart = (x - y).abs();
        apart.min(std::f32::consts::TAU - apart)
    };
    let squares = a.iter().zip(b).map(|(a, b)| {
        let (a, b) = (a.to_euler(EulerRot::XYZ), b.to_euler(EulerRot::XYZ));
        [angle(a.0, b.0), angle(a.1, b.1), angle(a.2, b.2)].iter().map(|angle| angle * angle).sum::<f32>()
    });
    squares.sum::<f32>().sqrt()
}

/// The sum of the joints' angles of rotation (thesis equation 2.1).
fn geodesic_distance(a: &[Quat], b: &[Quat]) -> f32 {
    let angles = a.iter().zip(b).map(|(a, b)| {
        let turn = a.conjugate() * *b;
        2.0 * turn.xyz().length().atan2(turn.w.abs())
    });
    angles.sum()
}

fn correlation_table(distances: &[Distance], test: &Mantel, by_distance: &[[f64; 3]]) -> Table {
    let mut table = Table::new(
        "pose_distances",
        format!(
            "Correlation with the skeleton\u{2019}s truth (TVCG table 1). Mantel test with {} permutations of the frames.",
            test.permuted.len()
        ),
        &[
            "distance",
            "Pearson",
            "distance correlation",
            "Mantel p",
            "greatest permuted",
            "Pearson, sum of angles",
            "distance correlation, sum of angles",
        ],
    );
    for (index, distance) in distances.iter().enumerate() {
        let greatest = test.permuted.iter().map(|permuted| permuted[index]).fold(f64::NEG_INFINITY, f64::max);
        let [own, geodesic, geodesic_own] = by_distance[index];
        table.rows.push(vec![
            distance.name.into(),
            Cell::Number(test.correlation[index], 4),
            Cell::Number(own, 4),
            Cell::Number(test.p_value(index), 4),
            Cell::Number(greatest, 4),
            Cell::Number(geodesic, 4),
            Cell::Number(geodesic_own, 4),
        ]);
    }
    table
}

fn correlogram_table(classes: &Classes, correlograms: &[Correlogram; 2]) -> Table {
    let mut table = Table::new(
        "correlogram",
        format!(
            "Mantel correlogram over {CLASSES} classes of the truth\u{2019}s distance: the correlation of being in a class \
             with being close, bounds of 95 % of it under {CORRELOGRAM_PERMUTATIONS} permutations, and Pearson\u{2019}s \
             correlation within the class alone."
        ),
        &[
            "truth from, rad",
            "to",
            "pairs",
            "ours",
            "null from",
            "null to",
            "Euclidean",
            "null from ",
            "null to ",
            "ours within",
            "Euclidean within",
        ],
    );
    let [ours, euclidean] = correlograms;
    for class in 0..ours.pairs.len() {
        table.rows.push(vec![
            Cell::Number(classes.bounds[class], 3),
            Cell::Number(classes.bounds[class + 1], 3),
            Cell::Count(ours.pairs[class]),
            Cell::Number(ours.membership[class], 4),
            Cell::Number(ours.null[class][0], 4),
            Cell::Number(ours.null[class][1], 4),
            Cell::Number(euclidean.membership[class], 4),
            Cell::Number(euclidean.null[class][0], 4),
            Cell::Number(euclidean.null[class][1], 4),
            Cell::Number(ours.within[class], 4),
            Cell::Number(euclidean.within[class], 4),
        ]);
    }
    table
}

fn agreements(test: &Mantel, by_distance: &[[f64; 3]]) -> Vec<Agreement> {
    let (ours, euclidean) = (test.correlation[0], test.correlation[3]);
    let (ours_by_distance, euclidean_by_distance) = (by_distance[0][0], by_distance[3][0]);
    let variants = (test.correlation[0] - test.correlation[1]).abs();
    vec![
        Agreement {
            papers:
                "The pose distance correlates with the skeleton\u{2019}s at 0.91 to 0.92 and more than the Euclidean \
                     one (0.81 to 0.88)"
                    .into(),
            found: format!(
                "Pearson {ours:.3} against {euclidean:.3}, distance correlation {ours_by_distance:.3} against \
                 {euclidean_by_distance:.3}"
            ),
            verdict: Verdict::of(
                ours > euclidean && ours_by_distance > euclidean_by_distance,
                ours >= 0.9 && ours_by_distance >= 0.89,
            ),
            why: if ours >= 0.9 { String::new() } else { FEW_JOINTS.into() },
        },
        Agreement {
            papers: "No permutation correlates better (p = 0)".into(),
            found: format!("p = {}", test.p_value(0)),
            verdict: Verdict::of(test.p_value(0) < 0.05, test.p_value(0) == 0.0),
            why: String::new(),
        },
        Agreement {
            papers: "The logarithm and the Frobenius norm of the stretch behave alike".into(),
            found: format!("correlations differ by {variants:.5}"),
            verdict: Verdict::of(variants < 0.02, variants < 0.005),
            why: String::new(),
        },
    ]
}

fn plots(
    test: &Mantel,
    classes: &Classes,
    correlograms: &[Correlogram; 2],
    truth: &[f32],
    distances: [&Vec<f32>; 2],
) -> Vec<Plot> {
    let permuted: Vec<f64> = test.permuted.iter().map(|permuted| permuted[0]).collect();
    let middle = |class: usize| (classes.bounds[class] + classes.bounds[class + 1]) / 2.0;
    let line = |name: &str, kind, colour, values: &mut dyn Iterator<Item = f64>| {
        Series::new(name, kind, colour, values.enumerate().map(|(class, value)| (middle(class), value)).collect())
    };
    let [ours, euclidean] = correlograms;
    let mut plots = vec![
        Plot {
            caption: "Mantel test: correlations with the frames permuted, and as they are (thesis figure 2.5).".into(),
            x: "Pearson\u{2019}s correlation with the truth".into(),
            y: "share of permutations".into(),
            series: vec![Series::new("", SeriesStyle::Bars, 5, histogram(&permuted, 30))],
            marks: vec![
                (test.correlation[0], format!("ours {:.3}", test.correlation[0]), 0),
                (test.correlation[3], format!("Euclidean {:.3}", test.correlation[3]), 1),
            ],
            ..Plot::default()
        },
        Plot {
            caption: "Mantel correlogram (thesis figure 2.6); broken lines bound 95 % of permutations.".into(),
            x: "truth\u{2019}s distance, radians".into(),
            y: "correlation".into(),
            series: vec![
                line("ours", SeriesStyle::DottedLine, 0, &mut ours.membership.iter().copied()),
                line("Euclidean", SeriesStyle::DottedLine, 1, &mut euclidean.membership.iter().copied()),
                line("", SeriesStyle::Dashes, 0, &mut ours.null.iter().map(|null| null[0])),
                line("", SeriesStyle::Dashes, 0, &mut ours.null.iter().map(|null| null[1])),
            ],
            ..Plot::default()
        },
    ];
    let step = (truth.len() / PLOTTED_PAIRS).max(1);
    for (name, unit, colour, values) in
        [("ours", "radians", 0, distances[0]), ("Euclidean", "square metres", 1, distances[1])]
    {
        let points = truth.iter().zip(values).step_by(step).map(|(x, y)| (f64::from(*x), f64::from(*y))).collect();
        plots.push(Plot {
            caption: format!("Every {step}th pair of frames: truth against {name}."),
            x: "truth\u{2019}s distance, radians".into(),
            y: format!("{name}, {unit}"),
            series: vec![Series::new("", SeriesStyle::Dots, colour, points)],
            from_zero: true,
            ..Plot::default()
        });
    }
    plots
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn skeleton_distances_of_known_turns() {
        let turn = |angle: f32| [Quat::from_rotation_x(angle), Quat::IDENTITY, Quat::from_rotation_z(-angle)];
        assert!((euler_distance(&turn(0.3), &turn(0.1)) - 0.2 * 2.0_f32.sqrt()).abs() < 1e-5);
        assert!((geodesic_distance(&turn(0.3), &turn(0.1)) - 0.4).abs() < 1e-5);
        assert!(euler_distance(&turn(0.3), &turn(0.3)).max(geodesic_distance(&turn(0.3), &turn(0.3))) < 1e-3);
        // Across the cut at pi (thesis equation 2.16).
        let (a, b) = ([Quat::from_rotation_x(3.1)], [Quat::from_rotation_x(-3.1)]);
        assert!((euler_distance(&a, &b) - (std::f32::consts::TAU - 6.2)).abs() < 1e-4);
    }
}
