//! Which triangles a mirroring transform turns inside out (glTF specification, section 3.7.4), so that they can be
//! turned back: one list of triangles serves all frames.

use glam::Vec3;

use super::animation::Clip;
use super::channel::Property;
use super::drawn::Drawn;
use super::nodes::Nodes;
use super::shape::Joints;

/// Times of a clip at which its transforms are looked at, as parts of its length.
const TIMES: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];

/// Turns triangles of `drawn` so that their outside is where it is when they are drawn.
///
/// A node or joint counts as mirroring where it does so most of the time. Returns the first node or joint that mirrors
/// only sometimes, if there is one.
pub(super) fn settle(nodes: &Nodes, skins: &[Joints], clips: &[Clip], drawn: &mut [Drawn]) -> Option<usize> {
    let looks = looks(nodes, clips);
    let mut sometimes = None;
    for drawn in drawn {
        let skin = drawn.skin.and_then(|skin| skins.get(skin));
        let own = looks.iter().filter(|look| look.get(drawn.node).copied().unwrap_or(false)).count();
        let mut joints = vec![0; skin.map_or(0, |skin| skin.nodes().len())];
        for look in &looks {
            let mirrored = skin.into_iter().flat_map(|skin| skin.mirrored(look));
            joints.iter_mut().zip(mirrored).for_each(|(votes, mirrored)| *votes += usize::from(mirrored));
        }
        let of_node = skin.is_none().then_some((drawn.node, own)).into_iter();
        let of_joints = skin.map_or(&[][..], Joints::nodes).iter().copied().zip(joints.iter().copied());
        let mut changing = of_node.chain(of_joints).filter(|&(_, votes)| votes > 0 && votes < looks.len());
        sometimes = sometimes.or_else(|| changing.next().map(|(node, _)| node));
        let most = |votes: usize| 2 * votes > looks.len();
        let signs: Vec<f32> = joints.iter().map(|&votes| if most(votes) { -1.0 } else { 1.0 }).collect();
        for piece in &mut drawn.pieces {
            let vertices = piece.shape.mirrored_vertices(&signs);
            for triangle in 0..piece.triangles.len() {
                let mirrored = match &vertices {
                    Some(vertices) => piece.triangles[triangle].iter().filter(|&&v| vertices[v as usize]).count() >= 2,
                    None => most(own),
                };
                if mirrored {
                    piece.turn(triangle);
                }
            }
        }
    }
    sometimes
}

/// For several times of all clips which nodes' world matrices mirror; at rest where there is no clip.
fn looks(nodes: &Nodes, clips: &[Clip]) -> Vec<Vec<bool>> {
    if clips.is_empty() {
        return vec![nodes.mirrored(&nodes.rest)];
    }
    let times = clips.iter().flat_map(|clip| TIMES.map(|part| (clip, clip.start + part * (clip.end - clip.start))));
    let look = |(clip, time): (&Clip, f64)| {
        let mut transforms = clip.apply(time, 0.0, &nodes.rest).transforms;
        // A scale of 0 has no sign: that of the keyframe where the node is largest counts.
        for channel in clip.channels.iter().filter(|channel| channel.property == Property::Scale) {
            let scale = &mut transforms[channel.node].scale;
            if scale.min_element() == 0.0 || scale.max_element() == 0.0 {
                let keys = (0..channel.times.len()).map(|key| Vec3::from_slice(channel.value(key)));
                *scale = keys.max_by(|a, b| a.length_squared().total_cmp(&b.length_squared())).unwrap_or(*scale);
            }
        }
        nodes.mirrored(&transforms)
    };
    times.map(look).collect()
}
