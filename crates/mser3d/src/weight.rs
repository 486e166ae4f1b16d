use mser3d_comptree::{AltitudeScale, Polarity};

mser3d_shape::choice! {
    /// What the component tree is built on, section 4.3.
    pub enum Weight("weight") {
        /// The heat kernel H_t(v,v) of voxels or vertices: heat that stays
        ///
        /// It is high on protrusions, so its superlevel sets are searched.
        #[default]
        Heat = "heat",
        /// The commute time (eq. 6) of voxels or vertices, which has no time scale
        ///
        /// It is high on protrusions too: superlevel sets.
        Commute = "commute",
        /// 1/H_t(u,v) of neighbours, on the links or edges: where heat passes badly
        ///
        /// It is low where heat passes easily: sublevel sets.
        Edge = "edge",
        /// The diffusion distance of neighbours over their distance: where heat spreads differently
        ///
        /// `|H_t(u,.) - H_t(v,.)| / |u - v|` (Coifman & Lafon 2006), in length^-5/2 in a volume, length^-2 on a surface. Without
        /// the division a long edge would be a high wall. It is low inside of parts: sublevel sets.
        Diffusion = "diffusion",
        /// The mean curvature of a mesh's surface, in a volume carried inside
        ///
        /// Signed, in length^-1: positive on what bulges, 1/r on a ball, negative where it is hollow (Digne et al. 2010). Superlevel
        /// sets: ridges and limbs; sublevel sets are valleys. In a volume see
        /// [`DiscreteShape::carry`](crate::DiscreteShape::carry). A mask has no such surface.
        Curvature = "curvature",
        /// The values of a file in place of this name, FIELD.npy: a value or a vector for each vertex or voxel
        ///
        /// See [`Field`](crate::Field) and [`Detector::with_weight`](crate::Detector::with_weight). Superlevel sets of values,
        /// sublevel sets of the distances between vectors.
        Field = "field",
    }
}

impl Weight {
    /// The polarity that finds protrusions and limbs; of a field, that for values.
    pub fn polarity(self) -> Polarity {
        match self {
            Self::Heat | Self::Commute | Self::Curvature | Self::Field => Polarity::Superlevel,
            Self::Edge | Self::Diffusion => Polarity::Sublevel,
        }
    }

    /// Whether it depends on a time scale.
    pub fn has_time_scale(self) -> bool {
        matches!(self, Self::Heat | Self::Edge | Self::Diffusion)
    }

    /// The scale of altitudes that suits it: the logarithm, unless it may be zero or negative.
    pub fn altitude(self) -> AltitudeScale {
        match self {
            Self::Heat | Self::Commute | Self::Edge | Self::Diffusion => AltitudeScale::Log,
            Self::Curvature | Self::Field => AltitudeScale::Linear,
        }
    }

    /// Whether it is one of elements, which heat can smooth, and not of the links between them.
    pub fn is_of_elements(self) -> bool {
        !matches!(self, Self::Edge | Self::Diffusion)
    }

    /// Whether it can be one of links: a field too, where its values are vectors.
    pub(crate) fn may_be_of_links(self) -> bool {
        matches!(self, Self::Edge | Self::Diffusion | Self::Field)
    }
}
