//! Section 11: transfer between performers who do the same, of which one is the truth (thesis section 5.7, figures 5.8 to 5.10).
//!
//! Says nothing about the capture under evaluation: the woman and the man are made for it.

mod measure;
mod performed;

use actor::timeline::Sequence;
use job::Job;
use kernels::random::mix;
use performer::Kind;
use transfer::{Kernel, Pair, TransferOptions};

use self::measure::{Both, Way, Which, by_time, dense, keys, kind, time_error, way};
use self::performed::{FPS, Performed, takes};
use super::EvaluateError;
use super::document::{Agreement, Cell, SectionReport, Table, Verdict};

/// Vertices of both.
const VERTICES: [usize; 2] = [2500, 2000];
/// How far the time of the man's takes is warped where frames are to be matched, in seconds.
const WARP: f64 = 0.22;
/// Pairs of the learning curves.
const CURVE: [usize; 3] = [20, 60, 200];
/// Keys of a sequence.
const KEYS: [usize; 3] = [3, 5, 9];

const KERNELS: [(&str, Kernel); 4] = [
    ("neural network", Kernel::NeuralNetwork),
    ("squared exponential", Kernel::SquaredExponential),
    ("linear", Kernel::Linear),
    ("affine", Kernel::Affine),
];

/// Makes the section.
pub fn section(seed: u64, job: &Job) -> Result<SectionReport, EvaluateError> {
    job.begin("performers who do the same")?;
    let mut all = takes(true, 1, 0.0);
    all.extend(takes(true, 2, 0.0));
    all.extend(takes(false, 1, 0.0));
    let woman = Performed::new(Kind::Woman, VERTICES[0], &all);
    let man = Performed::new(Kind::Man, VERTICES[1], &all);
    let warped = Performed::new(Kind::Man, VERTICES[1], &takes(true, 1, WARP));
    // Nothing of what a target never did tells where its bones and parts are.
    let seen = takes(true, 1, 0.0);
    let learners = [Performed::new(Kind::Man, VERTICES[1], &seen), Performed::new(Kind::Woman, VERTICES[0], &seen)];
    let [sources, targets] = [[woman.subject(), man.subject()], learners.each_ref().map(Performed::subject)];
    let other = warped.subject();
    let there = Both { target: &man, subjects: [&sources[0], &targets[0]] };
    let back = Both { target: &woman, subjects: [&sources[1], &targets[1]] };
    let directions = [("woman to man", &there), ("man to woman", &back)];
    let text = vec![
        "The woman and the man do the same at the same times: the man is the woman with other bones, clothes, mesh and habits of arms and \
         trunk. Walk, run, jump, kick and duck are learned from (takes 1); other takes of these, and idle, turns, wave and dance, are not. \
         Errors are roots of mean squares over vertices and frames, in millimetres, once a pose is turned about the vertical and moved \
         along the ground onto the truth."
            .into(),
    ];
    let mut section = SectionReport { text, ..SectionReport::default() };
    let kernels = kernels(&directions, job)?;
    section.agreements = agreements(&kernels);
    section.tables = vec![
        curves(&directions, seed, job)?,
        kernels,
        matching(&woman, &warped, [&sources[0], &other], &there, job)?,
        ways(&directions, job)?,
    ];
    Ok(section)
}

/// Figures 5.8 and 5.10: errors by the number of pairs, on the pairs and on what was held back of them.
fn curves(directions: &[(&str, &Both); 2], seed: u64, job: &Job) -> Result<Table, EvaluateError> {
    let columns = ["direction", "map", "parts", "pairs", "training mm", "held back mm"];
    let mut table = Table::new(
        "transfer_curves",
        "Errors by the number of pairs, drawn at random from 70 % of all; held back is the rest (figures 5.8 and 5.10)",
        &columns,
    );
    for (direction, both) in directions {
        let mut pairs = both.pairs();
        pairs.sort_by_key(|pair| mix(seed, u64::from(pair.target)));
        let (shown, held_back) = pairs.split_at(pairs.len() * 7 / 10);
        let frames: Vec<u32> = held_back.iter().step_by(2).map(|pair| pair.target).collect();
        let variants = KERNELS.map(|(name, kernel)| (name, kernel, false)).into_iter();
        for (name, kernel, whole) in variants.chain([(KERNELS[0].0, KERNELS[0].1, true)]) {
            for count in CURVE {
                job.tell("learning curves", 0, 1)?;
                let mut own = shown[..count.min(shown.len())].to_vec();
                own.sort_by_key(|pair| pair.target);
                let model = both.learn(&own, &options(kernel, whole), job)?;
                let seen: Vec<u32> = own.iter().step_by(own.len().div_ceil(40)).map(|pair| pair.target).collect();
                table.rows.push(vec![
                    (*direction).into(),
                    name.into(),
                    Cell::Count(model.parts() as u64),
                    Cell::Count(own.len() as u64),
                    Cell::Number(both.error(&model, &seen)?, 1),
                    Cell::Number(both.error(&model, &frames)?, 1),
                ]);
            }
        }
    }
    Ok(table)
}

/// Errors of takes and motions that were not learned from.
fn kernels(directions: &[(&str, &Both); 2], job: &Job) -> Result<Table, EvaluateError> {
    let columns =
        ["direction", "map", "parts", "pairs", "other takes mm", "unseen motions mm", "shape mm", "unseen mm"];
    let caption = "Errors of what was not learned from, by all true pairs; at the right of shapes, however they lean";
    let mut table = Table::new("transfer_kernels", caption, &columns);
    for (direction, both) in directions {
        for (name, kernel) in KERNELS {
            for whole in [false, true] {
                job.tell("kernels", 0, 1)?;
                let model = both.learn(&both.pairs(), &options(kernel, whole), job)?;
                table.rows.push(vec![
                    (*direction).into(),
                    name.into(),
                    Cell::Count(model.parts() as u64),
                    Cell::Count(model.learned as u64),
                    Cell::Number(both.error_of(&model, Which::Take)?, 1),
                    Cell::Number(both.error_of(&model, Which::Unseen)?, 1),
                    Cell::Number(both.shape_error(&model, Which::Take)?, 1),
                    Cell::Number(both.shape_error(&model, Which::Unseen)?, 1),
                ]);
            }
        }
    }
    Ok(table)
}

/// From keys to pairs (section 5.5.1; what figure 5.9 begins with).
fn matching(
    woman: &Performed,
    warped: &Performed,
    subjects: [&transfer::Subject; 2],
    both: &Both,
    job: &Job,
) -> Result<Table, EvaluateError> {
    let columns =
        ["keys a sequence", "off by up to", "by time: frames", "matched: frames", "other takes mm", "unseen mm"];
    let caption = format!(
        "Frames of a man whose time is warped, matched from keys: how far off in time, in frames at {FPS} a second, and errors of what is \
         learned from them"
    );
    let mut table = Table::new("transfer_matching", caption, &columns);
    for count in KEYS {
        for wrong in [0.0, 2.0] {
            let keys = keys(woman, warped, count, wrong);
            let pairs = dense(subjects, &keys, job)?;
            let model = transfer::Model::learn(subjects[0], subjects[1], &pairs, &TransferOptions::default(), job)?;
            table.rows.push(vec![
                Cell::Count(count as u64),
                Cell::Number(wrong, 0),
                Cell::Number(time_error(woman, warped, &by_time(warped, &keys)), 2),
                Cell::Number(time_error(woman, warped, &pairs), 2),
                Cell::Number(both.error_of(&model, Which::Take)?, 1),
                Cell::Number(both.error_of(&model, Which::Unseen)?, 1),
            ]);
        }
    }
    Ok(table)
}

/// Where whole sequences end, and how feet stand.
fn ways(directions: &[(&str, &Both); 2], job: &Job) -> Result<Table, EvaluateError> {
    let columns = ["direction", "sequence", "way m", "drift %", "drift cm", "turn deg", "slide before mm", "slide mm"];
    let mut table = Table::new(
        "transfer_ways",
        "Where sequences that were not learned from end, and how far soles slide a frame while the source's stand",
        &columns,
    );
    for (direction, both) in directions {
        let pairs: Vec<Pair> = both.pairs();
        let held = both.learn(&pairs, &TransferOptions::default(), job)?;
        let mut free = TransferOptions::default();
        free.hold = false;
        let free = both.learn(&pairs, &free, job)?;
        let not_learned = |sequence: &&Sequence| kind(sequence) != Which::Seen;
        for sequence in both.target.timeline.sequences().iter().filter(not_learned) {
            let Way { name, length, drift, turn, slide } = way(both, [&free, &held], sequence, job)?;
            table.rows.push(vec![
                (*direction).into(),
                name.into(),
                Cell::Number(length, 2),
                Cell::Number(100.0 * drift / length.max(1e-6), 1),
                Cell::Number(100.0 * drift, 1),
                Cell::Number(turn, 1),
                Cell::Number(slide[0], 2),
                Cell::Number(slide[1], 2),
            ]);
        }
    }
    Ok(table)
}

fn options(kernel: Kernel, whole: bool) -> TransferOptions {
    let mut options = TransferOptions::default();
    (options.kernel, options.whole) = (kernel, whole);
    options
}

/// What the thesis says of kernels and parts, beside what was found.
fn agreements(kernels: &Table) -> Vec<Agreement> {
    let number = |row: &Vec<Cell>, column: usize| match row[column] {
        Cell::Number(number, _) => number,
        _ => f64::NAN,
    };
    // The mean over both directions of a map, by parts or as a whole.
    let mean = |name: &str, whole: bool, column: usize| {
        let own: Vec<f64> = kernels
            .rows
            .iter()
            .filter(|row| row[1] == name.into() && (row[2] == Cell::Count(1)) == whole)
            .map(|row| number(row, column))
            .collect();
        own.iter().sum::<f64>() / own.len().max(1) as f64
    };
    let of = KERNELS.map(|(name, _)| mean(name, false, 5));
    let parts = [4, 5].map(|column| [mean(KERNELS[0].0, false, column), mean(KERNELS[0].0, true, column)]);
    vec![
        Agreement {
            papers: "The kernel of a neural network generalises better than the squared exponential, the linear and the affine map \
                     (figure 5.8)"
                .into(),
            found: format!(
                "unseen motions, mean of both directions: {:.1}, {:.1}, {:.1} and {:.1} mm",
                of[0], of[1], of[2], of[3]
            ),
            verdict: Verdict::of(of[0] < of[2] && of[0] < of[3], of[0] < of[1]),
            why: "Noise is not learned below 3 mm here, for all kernels".into(),
        },
        Agreement {
            papers: "Body parts compare favourably to the whole body (figure 5.10)".into(),
            found: format!(
                "other takes {:.1} mm by parts and {:.1} as a whole, unseen motions {:.1} and {:.1}",
                parts[0][0], parts[0][1], parts[1][0], parts[1][1]
            ),
            verdict: Verdict::of(
                parts[1][0] < parts[1][1] || parts[0][0] < parts[0][1],
                parts[1][0] < parts[1][1] && parts[0][0] < parts[0][1],
            ),
            why: "Limbs of the built-in performer move together as its motions say; those of people do so less".into(),
        },
    ]
}
