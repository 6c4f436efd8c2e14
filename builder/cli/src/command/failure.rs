//! What an exit code means.

use std::path::PathBuf;
use std::process::ExitCode;

/// A command that did not do what was asked, by whose fault.
pub enum Failure {
    /// Something that was given cannot be used: exit code 1.
    Input(anyhow::Error),
    /// Something was typed wrong: exit code 2.
    Usage(String),
    /// It was asked to stop: exit code 130.
    Stopped {
        /// Where what was done is kept, if anywhere.
        work: Option<PathBuf>,
    },
    /// The same of a command that keeps nothing: exit code 130.
    StoppedReading,
    /// We are wrong: exit code 3.
    Internal(anyhow::Error),
}

impl Failure {
    /// Prints what happened on stderr and returns the exit code.
    pub fn report(&self) -> ExitCode {
        match self {
            Self::Input(error) => {
                eprintln!("error: {error:#}");
                ExitCode::from(1)
            }
            Self::Usage(message) => {
                eprintln!("error: {message}\n\nFor more, try 'builder --help'.");
                ExitCode::from(2)
            }
            Self::Stopped { work } => {
                match work {
                    Some(folder) => eprintln!(
                        "stopped; nothing was written. What was done so far is kept in {}: the same command goes on from there",
                        folder.display()
                    ),
                    None => eprintln!(
                        "stopped; nothing was written. With --work DIR, the same command could go on from here"
                    ),
                }
                ExitCode::from(130)
            }
            Self::StoppedReading => {
                eprintln!("stopped");
                ExitCode::from(130)
            }
            Self::Internal(error) => {
                eprintln!("error: {error:#}\nThis is a fault of builder itself; please report it.");
                ExitCode::from(3)
            }
        }
    }
}
