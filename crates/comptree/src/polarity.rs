//! Which way the level moves: min-trees and max-trees (Salembier et al. 1998), MSER+ and MSER- (Matas et al.
//! 2002).

mser3d_shape::choice! {
    /// Which way the level moves.
    ///
    /// Both are the same tree with the order of weights reversed, like MSER+ and MSER- in images.
    pub enum Polarity("polarity") {
        /// The level rises: components of low weight
        ///
        /// Nodes are components of `{ w <= level }`; leaves are minima, roots have the highest altitude.
        #[default]
        Sublevel = "sublevel",
        /// The level falls: components of high weight
        ///
        /// Nodes are components of `{ w >= level }`; leaves are maxima, roots have the lowest altitude.
        Superlevel = "superlevel",
    }
}

impl Polarity {
    /// The weight as a level that rises; its own inverse. Both zeros are one.
    #[inline]
    pub(crate) fn orient(self, weight: f64) -> f64 {
        match self {
            Self::Sublevel => weight + 0.0,
            Self::Superlevel => 0.0 - weight,
        }
    }
}
