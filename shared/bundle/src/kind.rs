//! The version of the format, and the kinds of its sections.

/// The first bytes of a bundle. A transfer as text would change the byte above 127 or the line end.
pub const MAGIC: [u8; 8] = *b"\x89REPR\r\n\x1a";
/// Readers refuse a file with a larger major version.
pub const VERSION_MAJOR: u16 = 1;
/// A larger minor version only adds sections that may be skipped. A file has the smallest that knows all its sections.
pub const VERSION_MINOR: u16 = 15;

/// What a section holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum SectionKind {
    /// Names, counts, sequences, where frames lie.
    Meta,
    /// Triangles, corners, texture coordinates, materials, alignment weights.
    Surface,
    /// How positions are predicted, and how often residuals occur.
    Model,
    /// Positions of consecutive frames.
    Geometry,
    /// An encoded image file.
    Image,
    /// Alpha and the transitions.
    Graph,
    /// A fill-reducing order of the vertices.
    Order,
    /// The welded vertex of each vertex of the input files.
    FileVertices,
    /// As `Appearance`, with all blocks in the same steps. Since 1.1; written until 1.2.
    EarlierAppearance,
    /// As `AppearanceMode`, coded without a look at other modes. Since 1.1; written until 1.2.
    EarlierMode,
    /// As `EarlierAppearance`, of textures that were not aligned. Since 1.2; not written since.
    EarlierNaive,
    /// As `EarlierMode`, of [`SectionKind::EarlierNaive`]. Since 1.2; not written since.
    EarlierNaiveMode,
    /// What all frames' textures share, and each frame's coefficients. Since 1.3.
    Appearance,
    /// The mean of the textures or of the warps, or one of their modes. Since 1.3.
    AppearanceMode,
    /// As `Appearance`, of textures that were not aligned, to compare with. Since 1.3.
    Naive,
    /// As `AppearanceMode`, of [`SectionKind::Naive`]. Since 1.3.
    NaiveMode,
    /// Which frames there are as they were scanned, and which group holds them. Since 1.15.
    Scanned,
    /// Consecutive frames as they were scanned, with a mesh of their own. Since 1.15.
    ScannedGroup,
    /// Where the actor is and which way it faces in every frame. Since 1.1.
    Motion,
    /// As `Contacts`, of an actor whose transitions hold all that stands alike. Since 1.2.
    EarlierContacts,
    /// What stands on the ground in every frame. Since 1.9.
    Contacts,
    /// Which vertices follow each foot, and when it stands. Since 1.5.
    Feet,
    /// Which components of the mesh stay on which. Since 1.6.
    Ties,
    /// Bones, joints and weights, by which edits move the body. Since 1.7.
    Rig,
    /// As `Alternatives`, coded more plainly. Since 1.8; written until 1.13.
    EarlierAlternatives,
    /// Motion that differs from recorded stretches. Since 1.14.
    Alternatives,
    /// Which part of the body each vertex belongs to, as it was painted. Since 1.10.
    BodyParts,
    /// Families of sequences that do the same, and the numbers by which their members are asked for. Since 1.11.
    Families,
    /// How far the body turns in each transition besides. Since 1.12.
    Turns,
    /// The parts of the body that were found, and their names. Since 1.14.
    FoundParts,
    /// The ways in which the actor was seen to move. Since 1.13.
    LearnedSpace,
    /// The faces of the input files. Since 1.4.
    FileFaces,
    /// The place, the unit and the axes of the input files. Since 1.4.
    FilePlace,
}

impl SectionKind {
    /// All kinds of this version.
    pub const ALL: [Self; 33] = [
        Self::Meta,
        Self::Surface,
        Self::Model,
        Self::Geometry,
        Self::Image,
        Self::Graph,
        Self::Order,
        Self::FileVertices,
        Self::EarlierAppearance,
        Self::EarlierMode,
        Self::EarlierNaive,
        Self::EarlierNaiveMode,
        Self::Appearance,
        Self::AppearanceMode,
        Self::Naive,
        Self::NaiveMode,
        Self::Scanned,
        Self::ScannedGroup,
        Self::Motion,
        Self::EarlierContacts,
        Self::Contacts,
        Self::Feet,
        Self::Ties,
        Self::Rig,
        Self::EarlierAlternatives,
        Self::Alternatives,
        Self::BodyParts,
        Self::Families,
        Self::Turns,
        Self::FoundParts,
        Self::LearnedSpace,
        Self::FileFaces,
        Self::FilePlace,
    ];

    /// Its number in the file. Numbers 32 to 63 are reserved for appearance, 64 to 95 for direction, 96 to 127 for
    /// the files.
    #[must_use]
    pub fn number(self) -> u16 {
        match self {
            Self::Meta => 1,
            Self::Surface => 2,
            Self::Model => 3,
            Self::Geometry => 4,
            Self::Image => 5,
            Self::Graph => 6,
            Self::Order => 7,
            Self::FileVertices => 8,
            Self::EarlierAppearance => 32,
            Self::EarlierMode => 33,
            Self::EarlierNaive => 34,
            Self::EarlierNaiveMode => 35,
            Self::Appearance => 36,
            Self::AppearanceMode => 37,
            Self::Naive => 38,
            Self::NaiveMode => 39,
            Self::Scanned => 40,
            Self::ScannedGroup => 41,
            Self::Motion => 64,
            Self::EarlierContacts => 65,
            Self::Feet => 66,
            Self::Ties => 67,
            Self::Rig => 68,
            Self::EarlierAlternatives => 69,
            Self::Contacts => 70,
            Self::BodyParts => 71,
            Self::Families => 72,
            Self::Turns => 73,
            Self::FoundParts => 90,
            Self::Alternatives => 91,
            Self::LearnedSpace => 80,
            Self::FileFaces => 96,
            Self::FilePlace => 97,
        }
    }

    /// The kind with this number, if this version knows it.
    #[must_use]
    pub fn from_number(number: u16) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.number() == number)
    }

    /// Name for people.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Meta => "meta",
            Self::Surface => "surface",
            Self::Model => "model",
            Self::Geometry => "geometry",
            Self::Image => "image",
            Self::Graph => "graph",
            Self::Order => "order",
            Self::FileVertices => "file-vertices",
            Self::EarlierAppearance => "earlier-appearance",
            Self::EarlierMode => "earlier-mode",
            Self::EarlierNaive => "earlier-naive",
            Self::EarlierNaiveMode => "earlier-naive-mode",
            Self::Appearance => "appearance",
            Self::AppearanceMode => "appearance-mode",
            Self::Naive => "naive",
            Self::NaiveMode => "naive-mode",
            Self::Scanned => "scanned",
            Self::ScannedGroup => "scanned-group",
            Self::Motion => "motion",
            Self::EarlierContacts => "earlier-contacts",
            Self::Contacts => "contacts",
            Self::Feet => "feet",
            Self::Ties => "ties",
            Self::Rig => "rig",
            Self::EarlierAlternatives => "earlier-alternatives",
            Self::Alternatives => "alternatives",
            Self::BodyParts => "body-parts",
            Self::Families => "families",
            Self::Turns => "turns",
            Self::FoundParts => "found-parts",
            Self::LearnedSpace => "learned-space",
            Self::FileFaces => "file-faces",
            Self::FilePlace => "file-place",
        }
    }

    /// Whether a bundle may hold several of it, told apart by their ordinals.
    #[must_use]
    pub fn is_repeated(self) -> bool {
        let modes = [Self::EarlierMode, Self::EarlierNaiveMode, Self::AppearanceMode, Self::NaiveMode];
        matches!(self, Self::Geometry | Self::Image | Self::ScannedGroup) || modes.contains(&self)
    }

    /// The minor version that brought it.
    #[must_use]
    pub fn since(self) -> u16 {
        match self {
            Self::Scanned | Self::ScannedGroup => 15,
            Self::FoundParts | Self::Alternatives => 14,
            Self::LearnedSpace => 13,
            Self::Turns => 12,
            Self::Families => 11,
            Self::BodyParts => 10,
            Self::Contacts => 9,
            Self::EarlierAlternatives => 8,
            Self::Rig => 7,
            Self::Ties => 6,
            Self::Feet => 5,
            Self::FileFaces | Self::FilePlace => 4,
            Self::Appearance | Self::AppearanceMode | Self::Naive | Self::NaiveMode => 3,
            Self::EarlierContacts | Self::EarlierNaive | Self::EarlierNaiveMode => 2,
            Self::EarlierAppearance | Self::EarlierMode | Self::Motion => 1,
            _ => 0,
        }
    }
}
