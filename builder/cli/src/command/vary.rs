//! `builder vary`.

use reprise::pack::PackOptions;
use reprise::vary::{Variations, VariedSequence, VaryOptions};

use super::args::VaryArguments;
use super::failure::Failure;
use super::pack::{import_options, pack_into};
use super::terminal::Terminal;

/// Learns, draws, packs, and says what came out.
pub fn run(arguments: &VaryArguments, terminal: &Terminal) -> Result<(), Failure> {
    if !(arguments.amount > 0.0 && arguments.amount <= 1.0) {
        return Err(Failure::Usage("--amount must be above 0 and at most 1".into()));
    }
    let mut vary = VaryOptions::default();
    vary.amount = arguments.amount;
    vary.count = arguments.count.into();
    vary.seed = arguments.seed;
    let mut options = PackOptions::default();
    options.import = import_options(&arguments.import);
    options.parts = true;
    let (sequences, as_sequences) = (arguments.sequences.clone(), arguments.as_sequences);
    options.variations = Some(Variations { sequences, options: vary, as_sequences, usual: false });
    let report =
        pack_into(&arguments.output, (&arguments.inputs, &options), &arguments.work, arguments.json, terminal)?;
    let lines: Vec<String> = report.variations.iter().map(line).collect();
    terminal.log(&lines.join("\n"));
    Ok(())
}

fn line(varied: &VariedSequence) -> String {
    format!(
        "{}: {} variations, {:.1} mm from the recording and {:.1} mm from each other, acceleration {:.2} of the recorded, edges \
         {:.1} %, {} of {} stretches as recorded",
        varied.name,
        varied.variations,
        varied.distance * 1e3,
        varied.diversity * 1e3,
        varied.acceleration,
        varied.edges * 1e2,
        varied.rejected,
        varied.stretches
    )
}
