//! `gpu_times` on whatever graphics adapter there is, and the passes that it times against their twins on the processor.
//!
//! What needs an adapter is reported as ignored where there is none, with what to install. `harness = false`: that is
//! known only when the tests run.
#![allow(clippy::unwrap_used, reason = "a test that panics has failed")]

mod actor;
#[path = "../../examples/gpu_times/open.rs"]
mod open;
mod program;
mod twins;

use libtest_mimic::{Arguments, Trial};

fn main() {
    let trials = vec![
        Trial::ignorable_test("the_program_takes_the_times_of_every_pass", program::takes_times_of_every_pass),
        Trial::test("without_an_adapter_it_says_what_to_install", program::says_what_to_install),
        Trial::test("what_cannot_be_used_is_told", program::tells_what_cannot_be_used),
        Trial::ignorable_test("textures_are_rebuilt_as_on_the_processor", twins::textures_are_rebuilt),
    ];
    libtest_mimic::run(&Arguments::from_args(), trials).exit();
}
