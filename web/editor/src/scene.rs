//! What edits need to know of the actor, handed from the player's memory to the editor's.

use actor::feet::{Feet, FootVertex};
use actor::timeline::{Sequence, Timeline};
use kernels::topology::Topology;
use searcher::words::{Reader, Writer};

/// Everything that edits know of an actor, but for its rig and its poses.
#[derive(Clone, Debug)]
pub struct Known {
    /// Its sequences.
    pub timeline: Timeline,
    /// Its welded mesh.
    pub topology: Topology,
    /// Which vertices follow each foot, and when it stands.
    pub feet: Feet,
    /// The elimination order of the vertices, where the bundle has one.
    pub order: Option<Vec<u32>>,
}

/// What is known of an actor as words, for [`Known::from_words`].
#[must_use]
pub fn words(timeline: &Timeline, topology: &Topology, feet: &Feet, order: Option<&[u32]>) -> Vec<u32> {
    let mut writer = Writer::default();
    writer.float(timeline.fps());
    writer.list(timeline.sequences(), |writer, sequence| {
        writer.name(&sequence.name);
        writer.0.extend([sequence.first_frame, sequence.frame_count, u32::from(sequence.cyclic)]);
    });
    writer.list(topology.weights(), |writer, &weight| writer.float(weight));
    writer.list(topology.triangles(), |writer, triangle| writer.0.extend(triangle));
    writer.list(order.unwrap_or_default(), |writer, &vertex| writer.number(vertex));
    let numbers: Vec<usize> = (0..feet.count()).collect();
    writer.list(&numbers, |writer, &foot| {
        writer.list(feet.vertices(foot), |writer, vertex| {
            writer.0.extend([vertex.vertex, u32::from(vertex.leg) << 8 | u32::from(vertex.sole)]);
        });
        (0..timeline.frame_count()).for_each(|frame| writer.number(feet.stands(frame, foot).into()));
    });
    writer.0
}

impl Known {
    /// What [`words`] was told; `None` where that does not fit together.
    #[must_use]
    pub fn from_words(words: &[u32]) -> Option<Self> {
        let reader = &mut Reader(words);
        let fps = reader.float()?;
        let sequences = reader.list(|reader| {
            let name = reader.name()?;
            let (first_frame, frame_count, cyclic) = (reader.number()?, reader.number()?, reader.number()? == 1);
            Some(Sequence { name, labels: Vec::new(), first_frame, frame_count, cyclic })
        })?;
        let timeline = Timeline::new(fps, sequences).ok()?;
        let weights = reader.list(Reader::float)?;
        let triangles = reader.list(|reader| Some([reader.number()?, reader.number()?, reader.number()?]))?;
        let topology = Topology::new(weights.len() as u32, triangles, weights).ok()?;
        let order = Some(reader.list(Reader::number)?).filter(|order| !order.is_empty());
        let frames = timeline.frame_count();
        let feet = reader.list(|reader| {
            let vertices = reader.list(|reader| {
                let (vertex, shares) = (reader.number()?, reader.number()?);
                Some(FootVertex { vertex, leg: (shares >> 8) as u8, sole: shares as u8 })
            })?;
            let stands = (0..frames).map(|_| Some(reader.number()? == 1)).collect::<Option<Vec<bool>>>()?;
            Some((vertices, stands))
        })?;
        let stands = (0..frames as usize).flat_map(|frame| feet.iter().map(move |(_, stands)| stands[frame])).collect();
        let vertices = feet.iter().map(|(vertices, _)| vertices.clone()).collect();
        let feet = Feet::new(vertices, stands, topology.vertex_count(), &timeline)?;
        reader.0.is_empty().then_some(Self { timeline, topology, feet, order })
    }
}
