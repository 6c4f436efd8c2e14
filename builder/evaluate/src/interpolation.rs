//! Section 5: in-betweens, linear, by Poisson interpolation and as rigid as possible.
//!
//! Volume, edges and areas are compared with what lies between those of both ends (thesis section 2.4, figure 2.8).

use glam::Vec3;
use kernels::align::Placement;
use kernels::cholesky::elimination_order;
use kernels::topology::Topology;
use rayon::prelude::*;

use super::EvaluateError;
use super::arap::Arap;
use super::document::{Agreement, Cell, SectionReport, Table, Verdict};
use super::performance::{Performance, Recordings};
use super::plot::{Plot, Series, SeriesStyle};
use super::statistics::Moments;
use super::subject::{Subject, progress_of};
use job::Job;
use kernels::random::mix;

/// Pairs of frames, drawn at random.
const PAIRS: usize = 48;
/// Where between them.
const LAMBDA: f32 = 0.5;
const METHODS: [&str; 3] = ["linear", "Poisson", "as rigid as possible"];

/// How far an in-between is from what lies between both ends, as shares.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Error {
    /// Of the volume, signed.
    pub(super) volume: f64,
    /// Of edge lengths, mean of absolute values.
    pub(super) edges: f64,
    /// Of triangle areas, mean of absolute values weighted by area.
    pub(super) areas: f64,
}

/// Makes the section.
pub(super) fn section(subject: &Subject, job: &Job) -> Result<SectionReport, EvaluateError> {
    let topology = &subject.capture.topology;
    let order = elimination_order(topology);
    let recordings = Recordings::of(&subject.capture, &subject.measured.headings, &subject.centres, &subject.contacts);
    let (n, seed) = (subject.frame_count() as u64, subject.options.seed);
    let draw = |index: u64| ((mix(seed, 2 * index) % n) as u32, (mix(seed, 2 * index + 1) % n) as u32);
    let pairs: Vec<(u32, u32)> = (0..PAIRS as u64).map(draw).filter(|(i, j)| i != j).collect();
    let arap = Arap::new(topology, &order)?;
    let (progress, done) = (progress_of(job, "in-betweens"), std::sync::atomic::AtomicUsize::new(0));
    let edges = edges(topology);
    let found: Vec<(f64, [Error; 3], usize)> = pairs
        .par_iter()
        .map(|&(i, j)| {
            let (source, destination) = aligned(subject, &recordings, i, j);
            let mut stage = Performance::new(recordings, &order)?;
            let linear: Vec<Vec3> = source.iter().zip(&destination).map(|(a, b)| a.lerp(*b, LAMBDA)).collect();
            let poisson = stage.between((i, &source), (j, &destination), LAMBDA)?;
            let rigid = arap.in_between(&source, &destination, LAMBDA)?;
            let measure = |pose: &[Vec3]| error(topology, &edges, &source, &destination, pose);
            let errors = [measure(&linear), measure(&poisson), measure(&rigid.pose)];
            progress((1 + done.fetch_add(1, std::sync::atomic::Ordering::Relaxed)) as f64 / PAIRS as f64)?;
            let distance = f64::from(subject.measured.distances.get(i as usize, j as usize));
            Ok((distance, errors, rigid.iterations))
        })
        .collect::<Result<_, EvaluateError>>()?;
    Ok(write(&found))
}

/// Both poses with their centres of mass above the origin, the second turned onto the first.
fn aligned(subject: &Subject, recordings: &Recordings, i: u32, j: u32) -> (Vec<Vec3>, Vec<Vec3>) {
    let place = |frame: u32, heading| {
        let centre = subject.centres[frame as usize];
        recordings.placed(frame, Placement::turning(heading, centre, glam::Vec2::ZERO))
    };
    (place(i, 0.0), place(j, subject.measured.headings.get(i as usize, j as usize)))
}

/// Edges, each once.
pub(super) fn edges(topology: &Topology) -> Vec<[u32; 2]> {
    let mut edges: Vec<[u32; 2]> = topology
        .triangles()
        .iter()
        .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
        .map(|[a, b]| [a.min(b), a.max(b)])
        .collect();
    edges.sort_unstable();
    edges.dedup();
    edges
}

/// The volume that a surface encloses; of one with holes, that of the cones over its triangles.
fn volume(topology: &Topology, pose: &[Vec3]) -> f64 {
    let corner = |vertex: u32| pose[vertex as usize].as_dvec3();
    topology.triangles().iter().map(|&[a, b, c]| corner(a).dot(corner(b).cross(corner(c))) / 6.0).sum()
}

pub(super) fn error(topology: &Topology, edges: &[[u32; 2]], a: &[Vec3], b: &[Vec3], pose: &[Vec3]) -> Error {
    let between = |x: f64, y: f64| x + (y - x) * f64::from(LAMBDA);
    let wanted = between(volume(topology, a), volume(topology, b));
    let mut error = Error { volume: volume(topology, pose) / wanted - 1.0, ..Error::default() };
    let lengths = edges.iter().map(|&[k, l]| {
        let length = |pose: &[Vec3]| f64::from(pose[k as usize].distance(pose[l as usize]));
        let wanted = between(length(a), length(b));
        if wanted > 0.0 { (length(pose) / wanted - 1.0).abs() } else { 0.0 }
    });
    error.edges = Moments::of(lengths).mean;
    let (mut apart, mut total) = (0.0, 0.0);
    for corners in topology.triangles() {
        let area = |pose: &[Vec3]| {
            let [p, q, r] = corners.map(|vertex| pose[vertex as usize]);
            f64::from((q - p).cross(r - p).length()) / 2.0
        };
        let wanted = between(area(a), area(b));
        apart += (area(pose) - wanted).abs();
        total += wanted;
    }
    error.areas = if total > 0.0 { apart / total } else { 0.0 };
    error
}

fn write(found: &[(f64, [Error; 3], usize)]) -> SectionReport {
    let mut table = Table::new(
        "interpolation",
        format!(
            "In-betweens at the middle of {} pairs of frames drawn at random: shares by which volume, edge lengths and \
             triangle areas miss what lies between both ends.",
            found.len()
        ),
        &["in-between", "volume, mean", "volume, mean size", "volume, worst", "edges, mean", "areas, mean"],
    );
    let mut means = Vec::new();
    for (method, name) in METHODS.into_iter().enumerate() {
        let of = |value: fn(&Error) -> f64| Moments::of(found.iter().map(|(_, errors, _)| value(&errors[method]))).mean;
        let worst = found
            .iter()
            .map(|(_, errors, _)| errors[method].volume)
            .fold(0.0, |worst: f64, volume| if volume.abs() > worst.abs() { volume } else { worst });
        let mean = [of(|e| e.volume), of(|e| e.volume.abs()), of(|e| e.edges), of(|e| e.areas)];
        table.rows.push(vec![
            name.into(),
            Cell::Number(mean[0], 4),
            Cell::Number(mean[1], 4),
            Cell::Number(worst, 4),
            Cell::Number(mean[2], 4),
            Cell::Number(mean[3], 4),
        ]);
        means.push(mean);
    }
    let [linear, poisson, rigid] = [means[0], means[1], means[2]];
    let beats = |a: [f64; 4], b: [f64; 4]| (1..4).filter(|&k| a[k] < b[k]).count();
    let percent =
        |mean: [f64; 4]| format!("{:.1} / {:.1} / {:.1} %", 100.0 * mean[1], 100.0 * mean[2], 100.0 * mean[3]);
    let agreement = Agreement {
        papers: "Poisson interpolation keeps the surface better than linear blending or as rigid as possible".into(),
        found: format!(
            "errors of volume / edges / areas: linear {}, Poisson {}, as rigid as possible {}",
            percent(linear),
            percent(poisson),
            percent(rigid)
        ),
        verdict: Verdict::of(beats(poisson, linear) == 3, beats(poisson, linear) == 3 && beats(poisson, rigid) >= 2),
        why: if beats(poisson, rigid) >= 2 {
            String::new()
        } else {
            "As-rigid-as-possible minimises nearly what is measured here, and takes tens of iterations for it.".into()
        },
    };
    let iterations = Moments::of(found.iter().map(|(_, _, iterations)| *iterations as f64)).mean;
    let plot = |caption: &str, y: &str, value: fn(&Error) -> f64| Plot {
        caption: caption.into(),
        x: "pose distance of both ends, radians".into(),
        y: y.into(),
        series: METHODS
            .into_iter()
            .zip([1, 0, 2])
            .enumerate()
            .map(|(method, (name, colour))| {
                let points = found.iter().map(|(distance, errors, _)| (*distance, 100.0 * value(&errors[method])));
                Series::new(name, SeriesStyle::Dots, colour, points.collect())
            })
            .collect(),
        from_zero: true,
        ..Plot::default()
    };
    SectionReport {
        text: vec![format!(
            "As rigid as possible: the least sum of the energies against both ends, weighted by how near they are, from \
             the linear blend on, until no vertex moves by more than 0.1 mm ({iterations:.0} iterations on average, \
             each a pass over all vertices and a solve). Poisson interpolation is not iterated."
        )],
        tables: vec![table],
        agreements: vec![agreement],
        plots: vec![
            plot("Volume, by how far both ends are apart.", "error of volume, %", |error| error.volume),
            plot("Edge lengths.", "mean error of edges, %", |error| error.edges),
        ],
        ..SectionReport::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_of_a_scaled_tetrahedron() {
        let pose = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
        let triangles = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
        let topology = Topology::new(4, triangles, vec![1.0; 4]).unwrap();
        assert!((volume(&topology, &pose) - 1.0 / 6.0).abs() < 1e-9);
        let scaled: Vec<Vec3> = pose.iter().map(|p| *p * 0.9).collect();
        let found = error(&topology, &edges(&topology), &pose, &pose, &scaled);
        assert!((found.volume - (0.9_f64.powi(3) - 1.0)).abs() < 1e-6);
        assert!((found.edges - 0.1).abs() < 1e-6 && (found.areas - 0.19).abs() < 1e-6);
        assert_eq!(edges(&topology).len(), 6);
        assert_eq!(error(&topology, &edges(&topology), &pose, &pose, &pose), Error::default());
    }
}
