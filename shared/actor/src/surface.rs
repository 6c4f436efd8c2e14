//! What is drawn: the topology with its seams split, texture coordinates and materials.

use serde::{Deserialize, Serialize};

/// A corner of the drawn mesh: a welded vertex with the attributes that seams tell apart.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Corner {
    /// The welded vertex of [`kernels::topology::Topology`] that it follows.
    pub vertex: u32,
    /// Texture coordinate with the origin at the image's top left corner, v downwards, as in glTF.
    pub uv: [f32; 2],
    /// Colour in sRGB with straight alpha, multiplied with the material's; white where the input has none.
    pub colour: [u8; 4],
}

/// Triangles of one material, consecutive in [`Surface::triangles`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Part {
    /// Index of its material.
    pub material: u32,
    /// Its first triangle.
    pub first_triangle: u32,
    /// Number of its triangles.
    pub triangle_count: u32,
}

/// How a part looks.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Material {
    /// Name, as the input gives it.
    pub name: String,
    /// Base colour factor in linear light with straight alpha.
    pub base_colour: [f32; 4],
    /// Index of its texture in [`Surface::images`].
    pub image: Option<u32>,
    /// Whether its back faces are drawn.
    pub double_sided: bool,
}

/// File format of an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum ImageFormat {
    /// Portable Network Graphics.
    Png,
    /// JPEG.
    Jpeg,
    /// WebP.
    WebP,
}

impl ImageFormat {
    /// The media type, for example `image/png`.
    #[must_use]
    pub fn media_type(self) -> &'static str {
        match self {
            Self::Png => "image/png",
            Self::Jpeg => "image/jpeg",
            Self::WebP => "image/webp",
        }
    }
}

/// A texture as an encoded image file; decoded by the browser or by the `image` crate.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Image {
    /// File format of `bytes`.
    pub format: ImageFormat,
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// The file's bytes.
    pub bytes: Vec<u8>,
}

/// The drawn mesh: the same triangles as the topology's, in the same order, over split corners.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Surface {
    /// Corners, each used by at least one triangle.
    pub corners: Vec<Corner>,
    /// Triangles over `corners`; triangle `m` is triangle `m` of the topology.
    pub triangles: Vec<[u32; 3]>,
    /// Parts that together cover all triangles, in order.
    pub parts: Vec<Part>,
    /// Materials of the parts; at least one.
    pub materials: Vec<Material>,
    /// Static textures of the materials.
    pub images: Vec<Image>,
}

impl Surface {
    /// The triangles of one of its parts; none of a part that is not its own and reaches beyond them.
    #[must_use]
    pub fn triangles_of(&self, part: &Part) -> &[[u32; 3]] {
        let (first, count) = (part.first_triangle as usize, part.triangle_count as usize);
        self.triangles.get(first..first.saturating_add(count)).unwrap_or_default()
    }
}
