//! Families as a manifest asks for them: cycles of which what lies between is made, too.

use serde::{Deserialize, Serialize};

/// Samples of a family where nothing is said.
pub const DEFAULT_SAMPLES: u32 = 7;
/// Samples of a family at most.
const MOST_SAMPLES: usize = 64;

/// The number by which a family is asked for motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum FamilyParameter {
    /// Metres a second.
    Speed,
    /// How far a jump rises, in metres.
    Height,
    /// How far a jump leads, in metres.
    Length,
    /// Turn in radians per metre of the way.
    Turn,
}

/// Which samples of a family are made.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(untagged)]
pub enum FamilySamples {
    /// So many, at even distances of the parameter from the least to the greatest.
    Count(u32),
    /// Those at these values of the parameter.
    At(Vec<f32>),
}

/// A family, as one `[[family]]` of a manifest has it.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct ManifestFamily {
    /// Its name, of which those of its samples are made; also their label.
    pub name: String,
    /// By which number it is asked.
    pub parameter: FamilyParameter,
    /// Names of the sequences that have its cycles.
    pub sequences: Vec<String>,
    /// Its samples; [`DEFAULT_SAMPLES`] where nothing is said.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub samples: Option<FamilySamples>,
    /// For each sequence the first and the last frame within which its cycle is looked for, or nothing where all of it is.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub frames: Option<Vec<Vec<u32>>>,
    /// For each sequence its parameter, where all members are there already: then nothing is made.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub values: Option<Vec<f32>>,
}

impl ManifestFamily {
    /// Whether it makes sense by itself; `Err` says what does not.
    pub(super) fn check(&self) -> Result<(), String> {
        if self.name.trim().is_empty() {
            return Err("it needs a name".into());
        }
        if self.sequences.len() < 2 {
            return Err(format!("it needs two sequences at least, and names {}", self.sequences.len()));
        }
        match &self.samples {
            Some(FamilySamples::Count(count)) if !(1..=MOST_SAMPLES as u32).contains(count) => {
                return Err(format!("samples must be 1 to {MOST_SAMPLES}, not {count}"));
            }
            Some(FamilySamples::At(values)) if values.is_empty() || values.len() > MOST_SAMPLES => {
                return Err(format!("samples must be 1 to {MOST_SAMPLES} values, not {}", values.len()));
            }
            Some(FamilySamples::At(values)) if values.iter().any(|value| !value.is_finite()) => {
                return Err("samples must be finite numbers".into());
            }
            _ => {}
        }
        if let Some(values) = &self.values {
            let (has, names) = (values.len(), self.sequences.len());
            if has != names || values.iter().any(|value| !value.is_finite()) {
                return Err(format!("values must be a number for each of its {names} sequences"));
            }
            if self.samples.is_some() {
                return Err("it has samples to be made, and values of what is there: it can have one of both".into());
            }
        }
        let Some(frames) = &self.frames else {
            let mut names = self.sequences.clone();
            names.sort();
            return match names.windows(2).find(|pair| pair[0] == pair[1]) {
                Some(twice) => Err(format!(
                    "it names sequence \"{}\" twice: say with frames which part is meant each time",
                    twice[0]
                )),
                None => Ok(()),
            };
        };
        if frames.len() != self.sequences.len() {
            let (has, names) = (frames.len(), self.sequences.len());
            return Err(format!("frames has {has} entries for {names} sequences; [] stands for a whole one"));
        }
        let fits = |range: &Vec<u32>| range.is_empty() || range.len() == 2 && range[0] < range[1];
        match frames.iter().find(|range| !fits(range)) {
            Some(range) => Err(format!("frames are pairs of a first and a later last one, not {range:?}")),
            None => Ok(()),
        }
    }

    /// The frames within which the cycle of its sequence number `index` is looked for, where that is said.
    #[must_use]
    pub fn frames_of(&self, index: usize) -> Option<(u32, u32)> {
        match self.frames.as_ref()?.get(index)?[..] {
            [from, to] => Some((from, to)),
            _ => None,
        }
    }
}

/// What names of families and sequences contradict each other, if anything.
pub(super) fn contradiction(families: &[ManifestFamily], sequences: &[&String]) -> Option<String> {
    for (index, family) in families.iter().enumerate() {
        if families[..index].iter().any(|other| other.name == family.name) {
            return Some(format!("two families are named \"{}\"", family.name));
        }
        if let Some(name) = family.sequences.iter().find(|name| !sequences.contains(name)) {
            let known: Vec<&str> = sequences.iter().map(|name| name.as_str()).collect();
            return Some(format!(
                "family \"{}\": there is no sequence \"{name}\"; there are: {}",
                family.name,
                known.join(", ")
            ));
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<ManifestFamily, String> {
        let family: ManifestFamily = toml::from_str(text).map_err(|error| error.to_string())?;
        family.check().map(|()| family)
    }

    #[test]
    fn a_family_says_what_it_is_made_of() {
        let family = read(
            "name = 'gait'\nparameter = 'speed'\nsequences = ['walk', 'run']\nsamples = [1.5, 2]\nframes = [[], [3, 40]]",
        );
        let family = family.unwrap();
        assert_eq!(family.parameter, FamilyParameter::Speed);
        assert_eq!(family.samples, Some(FamilySamples::At(vec![1.5, 2.0])));
        assert_eq!([family.frames_of(0), family.frames_of(1), family.frames_of(2)], [None, Some((3, 40)), None]);
        let counted = "name = 'gait'\nparameter = 'turn'\nsequences = ['a', 'b']\nsamples = 5";
        assert_eq!(read(counted).unwrap().samples, Some(FamilySamples::Count(5)));
    }

    #[test]
    fn nonsense_is_a_sentence() {
        let gait = "name = 'gait'\nparameter = 'speed'\n";
        let told = |rest: &str| read(&format!("{gait}{rest}")).unwrap_err();
        let two = "sequences = ['walk', 'run']\n";
        assert!(told("sequences = ['walk']").contains("two sequences at least, and names 1"));
        assert!(told("sequences = ['walk', 'walk']").contains("names sequence \"walk\" twice"));
        assert!(told(&format!("{two}samples = 0")).contains("1 to 64, not 0"));
        assert!(told(&format!("{two}samples = []")).contains("1 to 64 values"));
        assert!(told(&format!("{two}samples = [nan]")).contains("finite"));
        assert!(told(&format!("{two}samples = 'many'")).contains("samples"));
        assert!(told(&format!("{two}frames = [[1, 2]]")).contains("1 entries for 2 sequences"));
        assert!(told(&format!("{two}frames = [[5, 2], []]")).contains("pairs"));
        assert!(told(&format!("{two}values = [1.5]")).contains("each of its 2 sequences"));
        assert!(told(&format!("{two}values = [1.5, inf]")).contains("each of its 2 sequences"));
        assert!(told(&format!("{two}samples = 3\nvalues = [1.5, 2]")).contains("one of both"));
        assert!(told(&format!("{two}step = 0.1")).contains("unknown field"));
        assert!(read("name = 'x'\nparameter = 'colour'\nsequences = ['a', 'b']").unwrap_err().contains("speed"));
        assert!(read("name = ' '\nparameter = 'speed'\nsequences = ['a', 'b']").unwrap_err().contains("name"));
    }

    #[test]
    fn names_that_contradict_each_other_are_told() {
        let family =
            |name: &str| read(&format!("name = '{name}'\nparameter = 'speed'\nsequences = ['walk', 'run']")).unwrap();
        let (walk, run, jog) = ("walk".to_owned(), "run".to_owned(), "jog".to_owned());
        assert_eq!(contradiction(&[family("a"), family("b")], &[&walk, &run]), None);
        let twice = contradiction(&[family("a"), family("a")], &[&walk, &run]).unwrap();
        assert!(twice.contains("two families are named \"a\""));
        let missing = contradiction(&[family("a")], &[&walk, &jog]).unwrap();
        assert!(missing.contains("no sequence \"run\"; there are: walk, jog"));
    }
}
