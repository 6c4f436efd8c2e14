//! What is drawn: the topology with its seams split, texture coordinates and materials.

use kernels::topology::Topology;
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
    /// The surface of `topology` in one grey material, without seams or textures.
    #[must_use]
    pub fn plain(topology: &Topology) -> Self {
        let corner = |vertex| Corner { vertex, uv: [0.0; 2], colour: [255; 4] };
        let triangle_count = topology.triangles().len() as u32;
        let base_colour = [0.7, 0.7, 0.7, 1.0];
        Self {
            corners: (0..topology.vertex_count() as u32).map(corner).collect(),
            triangles: topology.triangles().to_vec(),
            parts: vec![Part { material: 0, first_triangle: 0, triangle_count }],
            materials: vec![Material { name: "grey".into(), base_colour, image: None, double_sided: false }],
            images: Vec::new(),
        }
    }

    /// What of it does not follow `topology`, if anything.
    pub(crate) fn check(&self, topology: &Topology) -> Result<(), &'static str> {
        if self.triangles.len() != topology.triangles().len() {
            return Err("it has another number of triangles");
        }
        for (drawn, welded) in self.triangles.iter().zip(topology.triangles()) {
            for (corner, vertex) in drawn.iter().zip(welded) {
                match self.corners.get(*corner as usize) {
                    None => return Err("a triangle names a corner that does not exist"),
                    Some(corner) if corner.vertex != *vertex => return Err("a corner follows another vertex"),
                    Some(_) => {}
                }
            }
        }
        let mut next = 0;
        for part in &self.parts {
            if part.first_triangle != next {
                return Err("its parts leave out triangles or share them");
            }
            next = next.saturating_add(part.triangle_count);
            if part.material as usize >= self.materials.len() {
                return Err("a part names a material that does not exist");
            }
        }
        if next as usize != self.triangles.len() {
            return Err("its parts do not cover all triangles");
        }
        if self.materials.iter().any(|material| material.image.is_some_and(|image| image as usize >= self.images.len()))
        {
            return Err("a material names an image that does not exist");
        }
        Ok(())
    }

    /// The triangles of one of its parts; none of a part that is not its own and reaches beyond them.
    #[must_use]
    pub fn triangles_of(&self, part: &Part) -> &[[u32; 3]] {
        let (first, count) = (part.first_triangle as usize, part.triangle_count as usize);
        self.triangles.get(first..first.saturating_add(count)).unwrap_or_default()
    }
}
