//! Errors of transfer between figures of the built-in performer, motion by motion.
//!
//!     cargo run -p reprise-evaluate --example halves -- SEED SOURCE TARGET [usual]
//!
//! Seeds are odd. With `usual` by the usual options alone. Of these it says, of other takes, how much each part of the body has of the error.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "an example that prints, and may panic")]

#[path = "../src/transferred/measure.rs"]
#[allow(dead_code)]
mod measure;
#[path = "../src/transferred/performed.rs"]
#[allow(dead_code)]
mod performed;

use job::Job;
use measure::{Both, Which, kind};
use performed::{Performed, takes};
use performer::Kind;
use transfer::{Kernel, Model, TransferOptions};

fn figure(name: &str) -> (Kind, usize) {
    match name {
        "man" => (Kind::Man, 2000),
        "child" => (Kind::Child, 2000),
        _ => (Kind::Woman, 2500),
    }
}

/// The error of other takes by part of the body, and its share of all squares.
fn by_part(both: &Both, model: &Model) -> String {
    let parts = both.target.parts.of_vertices();
    let mut sums = vec![(0.0, 0); parts.iter().max().map_or(0, |most| most + 1)];
    for frame in both.frames(Which::Take).into_iter().step_by(6) {
        let pose = model.still(f64::from(frame)).unwrap();
        for (part, off) in parts.iter().zip(both.target.offs(frame, &pose)) {
            sums[*part] = (sums[*part].0 + off, sums[*part].1 + 1);
        }
    }
    let total: f64 = sums.iter().map(|own| own.0).sum();
    let part = |(part, (sum, count)): (usize, &(f64, i32))| {
        format!(", part {part} {:.1} ({:.0} %)", 1e3 * (sum / f64::from(*count)).sqrt(), 100.0 * sum / total)
    };
    sums.iter().enumerate().map(part).collect()
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let seed: u64 = arguments.first().map_or(1, |seed| seed.parse().unwrap());
    let usual = arguments.get(3).is_some_and(|word| word == "usual");
    let names = [1, 2].map(|k| arguments.get(k).map_or("woman", String::as_str));
    let mut all = takes(true, seed, 0.0);
    let seen = all.clone();
    all.extend(takes(true, seed + 1, 0.0));
    all.extend(takes(false, seed, 0.0));
    let [a, b] = names.map(|name| Performed::new(figure(name).0, figure(name).1, &all));
    let learners = names.map(|name| Performed::new(figure(name).0, figure(name).1, &seen));
    let directions = [(&a, &b, &learners[1], names), (&b, &a, &learners[0], [names[1], names[0]])];
    for (from, to, learner, names) in directions {
        let (source, target) = (from.subject(), learner.subject());
        let both = Both { target: to, subjects: [&source, &target] };
        for (bones, correct, kernel) in [
            (false, true, Kernel::NeuralNetwork),
            (true, true, Kernel::NeuralNetwork),
            (true, false, Kernel::NeuralNetwork),
            (true, false, Kernel::SquaredExponential),
        ] {
            if usual && !(bones && correct) {
                continue;
            }
            let mut options = TransferOptions::default();
            (options.bones, options.correct, options.kernel) = (bones, correct, kernel);
            let begin = std::time::Instant::now();
            let model = both.learn(&both.pairs(), &options, &Job::silent()).unwrap();
            let took = begin.elapsed().as_secs_f64();
            let mut line = format!("{seed} {names:?} bones {bones} correct {correct} {kernel:?} {took:.1} s:");
            let (mut sum, mut count) = (0.0, 0);
            for sequence in to.timeline.sequences().iter().filter(|own| kind(own) == Which::Unseen) {
                let frames: Vec<u32> = (sequence.first_frame..sequence.end_frame()).step_by(6).collect();
                let error = both.error(&model, &frames).unwrap();
                line += &format!(" {} {error:.1}", sequence.labels[0]);
                sum += error * error * frames.len() as f64;
                count += frames.len();
            }
            let take = both.error_of(&model, Which::Take).unwrap();
            let parts = if bones && correct && kernel == Kernel::NeuralNetwork {
                by_part(&both, &model)
            } else {
                String::new()
            };
            println!("{line} unseen {:.1} takes {take:.1}{parts}", (sum / count as f64).sqrt());
        }
    }
}
