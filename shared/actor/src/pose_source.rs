//! Where synthesis reads recorded poses from: memory in the builder, a bundle that may still be arriving in the player.

use glam::Vec3;
use thiserror::Error;

/// Why a recorded pose could not be read.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum PoseError {
    /// The capture has no such frame.
    #[error("the capture has no frame {0}")]
    OutOfRange(u32),
    /// The part of the bundle that holds the frame has not arrived yet.
    #[error("frame {0} has not arrived yet")]
    NotLoaded(u32),
    /// The part of the bundle that holds the frame is damaged.
    #[error("frame {0} is damaged")]
    Damaged(u32),
}

/// Recorded poses by frame.
pub trait PoseSource {
    /// Writes the vertex positions of `frame`, in metres, into `pose`, which has one element per welded vertex.
    ///
    /// # Errors
    /// A frame that does not exist, has not arrived, or is damaged.
    fn read(&mut self, frame: u32, pose: &mut [Vec3]) -> Result<(), PoseError>;

    /// Hears that `frame` is shown next; a source that varies the recording chooses here how it goes on. Whether it gives other poses
    /// from now on.
    fn enters(&mut self, frame: u32) -> bool {
        let _ = frame;
        false
    }
}
