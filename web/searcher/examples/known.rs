//! What searches need to know of an actor, as the page hands it over: `known ACTOR.reprise WORDS`. `tests/browser/slices.mjs`
//! searches with it, outside of a page, and tells how long each slice takes.

use std::fs;
use std::process::ExitCode;

use bundle::BundleReader;
use searcher::scene::words;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [actor, out] = arguments.as_slice() else {
        eprintln!("known ACTOR.reprise WORDS");
        return ExitCode::FAILURE;
    };
    match known(actor).and_then(|bytes| fs::write(out, bytes).map_err(|error| error.to_string())) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{actor}: {error}");
            ExitCode::FAILURE
        }
    }
}

fn known(actor: &str) -> Result<Vec<u8>, String> {
    let bytes = fs::read(actor).map_err(|error| error.to_string())?;
    let reader = BundleReader::from_bytes(&bytes).map_err(|error| error.to_string())?;
    let parts = reader.timeline().zip(reader.graph()).zip(reader.motion()).zip(reader.topology());
    let (((timeline, graph), motion), topology) = parts.ok_or("it has no graph, or no motion: pack it again")?;
    let words = words(timeline, graph, motion, topology.vertex_count() as u32);
    Ok(words.iter().flat_map(|word| word.to_le_bytes()).collect())
}
