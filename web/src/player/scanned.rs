//! Frames as they were scanned: which of them is shown in place of the registered mesh, and which will be wanted soon.
//!
//! The player knows no scanned mesh: a page fetches groups of them, and the stage draws what has come in time.

use bundle::{BundleError, ScannedHead, ScannedIndex};
use kernels::align::Placement;
use synthesis::{FrameKind, Step};

use super::Player;

/// Steps ahead that are looked at for what will be wanted.
const AHEAD: usize = 48;
/// Bytes of the graphics device's memory that scanned frames may take, more or less.
const ROOM: u64 = 192 << 20;
/// Groups that are held at least and at most, whatever their size.
const HELD: (u64, u64) = (3, 16);

/// A scanned frame where it stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScanShown {
    /// Its group, and which of its frames it is.
    pub place: (u32, u32),
    /// The recorded frame.
    pub frame: u32,
    /// Equal numbers are equal poses.
    pub number: u64,
    /// The world from the scan.
    pub placement: Placement,
}

impl Player {
    /// Which scanned frames the actor has; `None` where it has none, or they have not been told yet.
    #[must_use]
    pub fn scans(&self) -> Option<&ScannedIndex> {
        self.loading.reader()?.scanned()
    }

    /// The scanned frame that stands for what is shown: that of the nearer frame, where that is a recorded one that was neither edited
    /// nor varied, nor driven.
    #[must_use]
    pub fn scan(&self) -> Option<ScanShown> {
        let nearer = self.nearer()?;
        let FrameKind::Recorded { frame } = nearer.kind else { return None };
        let place = self.scans()?.place_of(frame).filter(|_| nearer.as_recorded)?;
        Some(ScanShown { place, frame, number: nearer.number, placement: nearer.placement })
    }

    /// The groups that are shown and will be on the route, the most urgent first: at most as many as are held.
    #[must_use]
    pub fn scans_ahead(&self) -> Vec<u32> {
        let Some(index) = self.scans() else { return Vec::new() };
        let most = held(&index.groups) as usize;
        let mut groups: Vec<u32> = Vec::new();
        let mut want = |frame: u32| {
            let group = index.place_of(frame).map(|(group, _)| group);
            groups.extend(group.filter(|group| !groups.contains(group)));
            groups.len() < most
        };
        for frame in self.coming_frames() {
            if !want(frame) {
                break;
            }
        }
        groups
    }

    /// Recorded frames that are shown or come next: those of the route, and behind its end those of the recording.
    fn coming_frames(&self) -> Vec<u32> {
        let Some(actor) = &self.loading.actor else { return Vec::new() };
        let shown = self.nearer().into_iter().chain(self.next.as_ref());
        let mut frames: Vec<u32> = shown.map(|shown| shown.kind.frame()).collect();
        let (Some(walker), Some(graph)) = (self.producer.walker(), self.graph(actor)) else { return frames };
        let (mut walker, mut taken) = (walker.clone(), 0);
        while let (Some(step), true) = (walker.next(&actor.timeline), taken < AHEAD) {
            if let Step::Forward(frame) | Step::Back(frame) = step {
                frames.push(frame);
            }
            walker.take(&graph, &actor.timeline);
            taken += 1;
        }
        // Where a transition ends something recorded begins.
        let end = walker.departure(&graph);
        let on = std::iter::successors(Some(end), |&frame| actor.timeline.next(frame));
        frames.extend(on.take(AHEAD - taken));
        frames
    }

    /// The first byte and the bytes of group `ordinal` in the bundle; those of the first one say where all of them begin.
    #[must_use]
    pub fn scan_section(&self, ordinal: u32) -> Option<(u64, u64)> {
        self.loading.reader()?.header()?.scanned_group(ordinal)
    }

    /// What the index tells of group `ordinal`, once `bytes` are found to be its section: what the module needs that reads it.
    ///
    /// # Errors
    /// They are not, or are damaged.
    pub fn scan_head(&self, ordinal: u32, bytes: &[u8]) -> Result<Vec<u32>, BundleError> {
        let (Some(reader), Some(index)) = (self.loading.reader(), self.scans()) else { return Ok(Vec::new()) };
        reader.check_scanned_group(ordinal, bytes)?;
        Ok(index.groups.get(ordinal as usize).map_or(Vec::new(), |head| head.words().collect()))
    }
}

/// How many groups are held: as many as there is room for.
fn held(groups: &[ScannedHead]) -> u64 {
    let largest = groups.iter().map(bytes_of).max().unwrap_or(1).max(1);
    (ROOM / largest).clamp(HELD.0, HELD.1)
}

/// Bytes of a group while it is held: its mesh, its poses, its images with their smaller levels.
fn bytes_of(head: &ScannedHead) -> u64 {
    let texels: u64 = head.images.iter().map(|&(_, width, height)| u64::from(width) * u64::from(height)).sum();
    let poses = u64::from(head.vertices) * u64::from(head.frames);
    texels * 16 / 3 + u64::from(head.corners) * 16 + u64::from(head.triangles) * 24 + poses * 12
}
