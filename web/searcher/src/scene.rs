//! What a search needs of the actor, handed from the player's memory to the searcher's.

use actor::contacts::{Contact, Contacts, Held};
use actor::families::Family;
use actor::graph::{EssentialGraph, EssentialGraphBuilder, Transition};
use actor::json::Json;
use actor::motion::Motion;
use actor::temporal_warp::{Move, TemporalWarp};
use actor::timeline::{Sequence, Timeline};
use glam::Vec2;

use crate::words::{Reader, Writer};

/// Everything that searches know of an actor.
#[derive(Clone, Debug, PartialEq)]
pub struct Known {
    /// Its sequences.
    pub timeline: Timeline,
    /// Its essential graph, with its contacts.
    pub graph: EssentialGraph,
    /// Where it is and which way it faces in every frame.
    pub motion: Motion,
    /// Number of welded vertices: those that may be followed.
    pub vertex_count: u32,
}

/// Moves of a temporal warp in a word.
const MOVES_A_WORD: usize = 16;
/// Words of a transition but for its moves.
const TRANSITION_WORDS: usize = 8;

/// What is known of an actor as words, for [`Known::from_words`].
#[must_use]
pub fn words(timeline: &Timeline, graph: &EssentialGraph, motion: &Motion, vertex_count: u32) -> Vec<u32> {
    let mut telling = Telling::new(timeline, graph, vertex_count);
    while !telling.advance(graph, usize::MAX) {}
    telling.finish(timeline, graph, motion)
}

/// Writes [`words`] some transitions at a time. All its functions want the same actor.
#[derive(Clone, Debug)]
pub struct Telling {
    writer: Writer,
    /// The first transition that is still to be written.
    next: usize,
}

impl Telling {
    /// Writes what comes before the transitions.
    #[must_use]
    pub fn new(timeline: &Timeline, graph: &EssentialGraph, vertex_count: u32) -> Self {
        let mut writer = Writer::default();
        writer.number(vertex_count);
        writer.float(timeline.fps());
        writer.list(timeline.sequences(), |writer, sequence| {
            writer.name(&sequence.name);
            writer.list(&sequence.labels, |writer, label| writer.name(label));
            writer.0.extend([sequence.first_frame, sequence.frame_count, u32::from(sequence.cyclic)]);
        });
        writer.double(graph.alpha());
        writer.number(graph.transitions().len() as u32);
        // A list that is moved when it grows stops the page.
        let of = |transition: &Transition| TRANSITION_WORDS + transition.warp.moves().len().div_ceil(MOVES_A_WORD);
        writer.0.reserve_exact(graph.transitions().iter().map(of).sum());
        Self { writer, next: 0 }
    }

    /// Writes up to `transitions` more; whether those were all.
    pub fn advance(&mut self, graph: &EssentialGraph, transitions: usize) -> bool {
        let left = graph.transitions().get(self.next..).unwrap_or_default();
        let now = &left[..left.len().min(transitions)];
        now.iter().for_each(|transition| write_transition(&mut self.writer, transition));
        self.next += now.len();
        self.next >= graph.transitions().len()
    }

    /// All of it, once [`Self::advance`] has written all transitions.
    #[must_use]
    pub fn finish(self, timeline: &Timeline, graph: &EssentialGraph, motion: &Motion) -> Vec<u32> {
        let mut writer = self.writer;
        let contacts = graph.contacts();
        writer.0.extend([contacts.parts() as u32, u32::from(contacts.steers())]);
        let frames: Vec<u32> = (0..timeline.frame_count()).collect();
        writer.list(&frames, |writer, &frame| {
            for contact in contacts.of(frame) {
                writer.floats([contact.point.x, contact.point.y, contact.weight]);
            }
        });
        writer.list(&motion.centres, |writer, &centre| writer.point(centre));
        writer.list(&motion.facings, |writer, &facing| writer.float(facing));
        writer.list(&motion.wraps, |writer, wrap| writer.placement(wrap));
        writer.0
    }
}

fn write_transition(writer: &mut Writer, transition: &Transition) {
    writer.number(transition.from);
    writer.number(transition.to);
    writer.float(transition.deformation);
    writer.placement(&transition.placement);
    writer.float(transition.turn);
    let moves = transition.warp.moves();
    writer.number(moves.len() as u32);
    for chunk in moves.chunks(MOVES_A_WORD) {
        writer.number(chunk.iter().rev().fold(0, |word, &step| word << 2 | step as u32));
    }
}

fn read_transition(reader: &mut Reader) -> Option<Transition> {
    let (from, to, deformation, placement) = (reader.number()?, reader.number()?, reader.float()?, reader.placement()?);
    let turn = reader.float()?;
    let count = reader.number()? as usize;
    let mut moves = Vec::new();
    while moves.len() < count {
        let word = reader.number()?;
        for place in 0..MOVES_A_WORD.min(count - moves.len()) {
            let mut steps = [Move::Both, Move::Source, Move::Destination].into_iter();
            moves.push(steps.find(|&step| step as u32 == word >> (2 * place) & 3)?);
        }
    }
    Some(Transition { from, to, deformation, warp: TemporalWarp::new(moves), placement, turn })
}

impl Known {
    /// The same with the families that a document holds; `None` where it holds none of these sequences.
    #[must_use]
    pub fn with_families(self, document: &Json) -> Option<Self> {
        let timeline = self.timeline.with_families(Family::of_json(document).ok()?).ok()?;
        Some(Self { timeline, ..self })
    }

    /// What [`words`] was told; `None` where that does not fit together.
    #[must_use]
    pub fn from_words(words: Vec<u32>) -> Option<Self> {
        let mut reading = Reading::new(words)?;
        while !reading.advance(usize::MAX)? {}
        reading.finish()
    }
}

/// Reads [`words`] some transitions at a time: captures have hundreds of thousands of them, and a page has frames to show.
#[derive(Clone, Debug)]
pub struct Reading {
    words: Vec<u32>,
    /// The first word that is still to be read.
    next: usize,
    vertex_count: u32,
    timeline: Timeline,
    graph: EssentialGraphBuilder,
    /// Transitions that are still to be read.
    left: u32,
}

impl Reading {
    /// Reads what comes before the transitions; `None` where that does not fit together.
    #[must_use]
    pub fn new(words: Vec<u32>) -> Option<Self> {
        let mut reader = Reader(&words);
        let vertex_count = reader.number()?;
        let fps = reader.float()?;
        let sequences = reader.list(|reader| {
            let (name, labels) = (reader.name()?, reader.list(Reader::name)?);
            let (first_frame, frame_count, cyclic) = (reader.number()?, reader.number()?, reader.number()? == 1);
            Some(Sequence { name, labels, first_frame, frame_count, cyclic })
        })?;
        let timeline = Timeline::new(fps, sequences).ok()?;
        let mut graph = EssentialGraphBuilder::new(reader.double()?, &timeline).ok()?;
        let left = reader.number()?;
        // Each takes several words: more than there are words would be a lie.
        graph.reserve(reader.0.len().min(left as usize));
        let next = words.len() - reader.0.len();
        Some(Self { words, next, vertex_count, timeline, graph, left })
    }

    /// Reads up to `transitions` more; whether those were all. `None` where they do not fit together.
    pub fn advance(&mut self, transitions: usize) -> Option<bool> {
        let mut reader = Reader(&self.words[self.next..]);
        let now = self.left.min(u32::try_from(transitions).unwrap_or(u32::MAX));
        for _ in 0..now {
            self.graph.push(read_transition(&mut reader)?, &self.timeline).ok()?;
        }
        self.next = self.words.len() - reader.0.len();
        self.left -= now;
        Some(self.left == 0)
    }

    /// What was told, once [`Self::advance`] has read all transitions; `None` where it does not fit together.
    #[must_use]
    pub fn finish(self) -> Option<Known> {
        let Self { words, next, vertex_count, timeline, graph, left } = self;
        let mut reader = Reader(words.get(next..).filter(|_| left == 0)?);
        let parts = reader.number()? as usize;
        let held = if reader.number()? == 1 { Held::WhatCannotStep } else { Held::Alike };
        let contacts = reader.list(|reader| {
            let of_part = |_| {
                let point = Vec2::new(reader.float()?, reader.float()?);
                Some(Contact { point, weight: reader.float()? })
            };
            (0..parts).map(of_part).collect::<Option<Vec<_>>>()
        })?;
        let contacts = Contacts::new(parts, contacts.concat(), &timeline)?.held(held);
        let graph = graph.finish().with_contacts(contacts);
        let (centres, facings) = (reader.list(Reader::point)?, reader.list(Reader::float)?);
        let motion = Motion { centres, facings, wraps: reader.list(Reader::placement)? };
        (motion.fits(&timeline) && reader.0.is_empty()).then_some(Known { timeline, graph, motion, vertex_count })
    }
}
