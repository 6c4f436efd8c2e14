//! What is asked on the command line.

use std::path::PathBuf;
use std::str::FromStr;
use std::time::Duration;

use anyhow::{Context, Result, bail};

/// What the program says of itself.
pub const HELP: &str = "\
usage: gpu_times <BUNDLE> [options]

Draws what the player shows of an actor into a texture and prints how long each pass took: the median and the 95th
percentile of many frames, by the GPU's own clock where it has timestamp queries.

  --frames N       most frames of a round [300]
  --seconds S      a round ends after so many seconds, if it has ten frames [20]
  --size WxH       size of the picture in pixels [1280x720]
  --adapter TEXT   take the adapter whose name has this text in it
  --json           print JSON instead of a table

Exit codes: 0 done, 1 something given cannot be used, 2 there is no graphics adapter.
";

/// What to do.
#[derive(Debug, PartialEq)]
pub enum Asked {
    /// Print [`HELP`].
    Help,
    /// Take times.
    Times(Options),
}

/// How to take times.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// The actor.
    pub bundle: PathBuf,
    /// Most frames of a round.
    pub frames: usize,
    /// When a round ends early.
    pub time: Duration,
    /// The picture, pixels.
    pub size: [u32; 2],
    /// Text in the adapter's name.
    pub adapter: Option<String>,
    /// JSON instead of a table.
    pub json: bool,
}

impl Options {
    /// Reads the words after the program's name.
    ///
    /// # Errors
    /// A word that is not known, or a value out of range.
    pub fn parse(words: impl IntoIterator<Item = String>) -> Result<Asked> {
        let mut options = Self {
            bundle: PathBuf::new(),
            frames: 300,
            time: Duration::from_secs(20),
            size: [1280, 720],
            adapter: None,
            json: false,
        };
        let mut words = words.into_iter();
        while let Some(word) = words.next() {
            let mut value = || words.next().with_context(|| format!("{word} needs a value"));
            match word.as_str() {
                "--help" | "-h" => return Ok(Asked::Help),
                "--json" => options.json = true,
                "--adapter" => options.adapter = Some(value()?),
                "--frames" => options.frames = number(&word, &value()?, 1, 1_000_000)?,
                "--seconds" => options.time = Duration::from_secs(number(&word, &value()?, 1, 86_400)?),
                "--size" => options.size = size(&value()?)?,
                _ if word.starts_with('-') => bail!("there is no option {word}; --help lists them"),
                _ if !options.bundle.as_os_str().is_empty() => bail!("one bundle at a time; {word:?} is a second one"),
                _ => options.bundle = word.into(),
            }
        }
        if options.bundle.as_os_str().is_empty() {
            bail!("name a bundle: gpu_times actor.reprise (`builder pack` makes one)");
        }
        Ok(Asked::Times(options))
    }
}

fn number<T: FromStr + PartialOrd + std::fmt::Display>(word: &str, value: &str, least: T, most: T) -> Result<T> {
    let number = value.parse().ok().filter(|number| (&least..=&most).contains(&number));
    number.with_context(|| format!("{word} wants a whole number from {least} to {most}, not {value:?}"))
}

fn size(value: &str) -> Result<[u32; 2]> {
    let (width, height) = value.split_once('x').with_context(|| format!("--size wants WxH, not {value:?}"))?;
    Ok([number("--size", width, 1, 8192)?, number("--size", height, 1, 8192)?])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(words: &str) -> Result<Asked> {
        Options::parse(words.split_whitespace().map(String::from))
    }

    #[test]
    fn words_become_options() {
        let Ok(Asked::Times(options)) = parse("--size 640x400 actor.reprise --frames 7 --seconds 3 --json") else {
            panic!("these are options");
        };
        assert_eq!((options.size, options.frames, options.json), ([640, 400], 7, true));
        assert_eq!((options.bundle, options.time), ("actor.reprise".into(), Duration::from_secs(3)));
        assert_eq!(parse("actor.reprise --help").ok(), Some(Asked::Help));
    }

    #[test]
    fn what_is_wrong_is_said() {
        for (words, said) in [
            ("", "name a bundle"),
            ("a b", "second one"),
            ("a --frames", "needs a value"),
            ("a --frames 0", "from 1 to 1000000"),
            ("a --size 640", "wants WxH"),
            ("a --size 640x9000", "from 1 to 8192"),
            ("a --fast", "no option --fast"),
        ] {
            let error = parse(words).map_or_else(|error| error.to_string(), |asked| format!("{asked:?}"));
            assert!(error.contains(said), "{words:?}: {error}");
        }
    }
}
