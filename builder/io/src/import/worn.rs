//! Which texture a material wears, and how.

use std::path::PathBuf;

/// A texture that a mesh file or its library names.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum NamedTexture {
    /// The file is there.
    Found(PathBuf),
    /// It is not; the name as it is written.
    Missing(String),
}

impl NamedTexture {
    /// The file, where it is there.
    pub fn found(&self) -> Option<&PathBuf> {
        match self {
            Self::Found(path) => Some(path),
            Self::Missing(_) => None,
        }
    }
}

/// Scale and offset of texture coordinates, v upwards: `-s` and `-o` of a texture statement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct UvTransform {
    pub scale: [f32; 2],
    pub offset: [f32; 2],
}

impl Default for UvTransform {
    fn default() -> Self {
        Self { scale: [1.0; 2], offset: [0.0; 2] }
    }
}

impl UvTransform {
    /// `uv`, whose v points downwards, moved.
    pub fn apply(self, [u, v]: [f32; 2]) -> [f32; 2] {
        if self == Self::default() {
            return [u, v];
        }
        [u * self.scale[0] + self.offset[0], 1.0 - ((1.0 - v) * self.scale[1] + self.offset[1])]
    }
}
