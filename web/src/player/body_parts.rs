//! The parts of the body, as the page shows them in its colours.

use bundle::BundleError;

use super::loading::{Loading, Recorded};

/// The parts of a body.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BodyParts {
    /// Their names; none is of two lines.
    pub names: Vec<String>,
    of_vertex: Vec<u8>,
}

impl BodyParts {
    /// What has arrived of the parts: painted or found; `None` where the bundle has fewer than two.
    ///
    /// # Errors
    /// They are damaged.
    pub fn of(loading: &Loading) -> Result<Option<Self>, BundleError> {
        let Recorded::Bundle(reader) = &loading.source.recorded else { return Ok(None) };
        let parts = match reader.body_parts()? {
            Some(numbers) => Some(Self::painted(numbers)),
            None => reader.found_parts()?.map(|found| Self { names: found.names, of_vertex: found.of_vertex }),
        };
        Ok(parts.filter(|parts| parts.names.len() > 1))
    }

    /// Parts of these numbers. No sorting: its code would be larger than all else here.
    fn painted(mut of_vertex: Vec<u8>) -> Self {
        let mut places = [None; 256];
        of_vertex.iter().for_each(|&number| places[usize::from(number)] = Some(0));
        let mut names = Vec::new();
        for (number, place) in places.iter_mut().enumerate().filter(|(_, place)| place.is_some()) {
            *place = Some(names.len() as u8);
            names.push(format!("part {number}"));
        }
        of_vertex.iter_mut().for_each(|own| *own = places[usize::from(*own)].unwrap_or_default());
        Self { names, of_vertex }
    }

    /// The colour of a vertex, of `colours` in sRGB; where there are more parts, they come again.
    #[must_use]
    pub fn colour(&self, vertex: u32, colours: &[[u8; 3]]) -> [u8; 3] {
        let part = self.of_vertex.get(vertex as usize).copied().unwrap_or_default();
        let colour = usize::from(part).checked_rem(colours.len()).and_then(|part| colours.get(part));
        colour.copied().unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_vertex_has_its_parts_colour() {
        let parts = BodyParts::painted(vec![9, 3, 255, 3]);
        assert_eq!(parts.names, ["part 3", "part 9", "part 255"]);
        let (red, green) = ([255, 0, 0], [0, 255, 0]);
        assert_eq!([0, 1, 2, 3].map(|vertex| parts.colour(vertex, &[red, green])), [green, red, red, red]);
        assert_eq!(parts.colour(99, &[red]), red, "a vertex that is none of the body's");
        assert_eq!(parts.colour(0, &[]), [0; 3]);
        assert_eq!(BodyParts::of(&Loading::default()), Ok(None));
    }
}
