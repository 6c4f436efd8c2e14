//! What of the scanned frames has arrived, for a reader.

use actor::timeline::Timeline;

use super::ScannedIndex;
use crate::header::Header;
use crate::kind::SectionKind;
use crate::layout;

/// The index, and the sections of groups as they are.
#[derive(Debug, Default)]
pub struct ArrivedScans {
    pub index: Option<ScannedIndex>,
    groups: Vec<Option<Vec<u8>>>,
}

impl ArrivedScans {
    /// Takes the section `kind` numbered `ordinal`; the reason where it makes no sense.
    pub fn take(
        &mut self,
        (kind, ordinal): (SectionKind, u32),
        raw: Vec<u8>,
        timeline: &Timeline,
        header: Option<&Header>,
    ) -> Result<(), &'static str> {
        if kind == SectionKind::Scanned {
            let index = ScannedIndex::decode(&raw, timeline)?;
            let count = header.map_or(0, |header| layout::count(header, SectionKind::ScannedGroup));
            if index.groups.len() != count {
                return Err("declares another number of groups than there are");
            }
            self.groups = vec![None; count];
            self.index = Some(index);
            return Ok(());
        }
        *self.groups.get_mut(ordinal as usize).ok_or("is not declared")? = Some(raw);
        Ok(())
    }

    /// The section of group `ordinal`, once it has arrived.
    pub fn group(&self, ordinal: u32) -> Option<&[u8]> {
        self.groups.get(ordinal as usize)?.as_deref()
    }
}
