//! How pictures are drawn: sizes, colours, strengths.

use mser3d_shape::InvalidParameter;

use crate::camera::Up;
use crate::{Rgb, ViewerError};

mser3d_shape::choice! {
    /// What is behind a picture.
    pub enum Background("background") {
        /// White, for print
        #[default]
        White = "white",
        /// Nearly black, for slides and dark pages
        Dark = "dark",
    }
}

impl Background {
    /// Its colour.
    pub(crate) fn colour(self) -> Rgb {
        match self {
            Self::White => Rgb::WHITE,
            Self::Dark => Rgb::hex(0x16181c),
        }
    }

    /// The colour of letters on it.
    pub(crate) fn ink(self) -> Rgb {
        match self {
            Self::White => Rgb::hex(0x333333),
            Self::Dark => Rgb::hex(0xc8ccd2),
        }
    }
}

/// How pictures are drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct RenderOptions {
    /// Height of a panel in pixels, 16 to 16384; its width follows from the shape.
    pub height: usize,
    /// Panels beside each other before a new row begins; 0: all in one row.
    pub columns: usize,
    /// Samples per pixel along each axis, 1 to 8: the smoothness of edges.
    pub supersampling: usize,
    /// The axis that points up.
    pub up: Up,
    /// What is behind the shapes; letters are dark on white and light on dark.
    pub background: Background,
    /// Empty border around each shape, as a fraction of the panel's height, 0 to 0.4.
    pub margin: f64,
    /// Strength of ambient occlusion, 0 to 1: dark folds and contacts.
    pub occlusion: f64,
    /// Strength of the lines around shapes and regions, 0 to 1.
    pub lines: f64,
    /// Height of capital letters in captions, in pixels, 6 to 512; `None` scales it with the panels.
    pub caption_size: Option<usize>,
    /// Whether a bar of round length is drawn below, at the right: 1, 2 or 5 times a power of ten, in the mesh's unit.
    pub scale_bar: bool,
    /// Whether each panel shows at the lower left where x, y and z point.
    pub axes: bool,
}

impl Default for RenderOptions {
    fn default() -> Self {
        Self {
            height: 800,
            columns: 0,
            supersampling: 3,
            up: Up::Y,
            background: Background::White,
            margin: 0.04,
            occlusion: 0.8,
            lines: 0.6,
            caption_size: None,
            scale_bar: false,
            axes: false,
        }
    }
}

impl RenderOptions {
    /// Checks that every option is in its range.
    ///
    /// # Errors
    /// [`ViewerError::InvalidParameter`] names the first that is not.
    pub fn validate(&self) -> Result<(), ViewerError> {
        let unless = |holds: bool, name, value: &dyn std::fmt::Display, expected: &str| {
            InvalidParameter::unless(holds, name, value, expected)
        };
        let Self { height, supersampling, margin, occlusion, lines, .. } = *self;
        let caption = self.caption_size.unwrap_or(12);
        let share = 0.0..=1.0;
        unless((16..=16384).contains(&height), "height", &height, "16 to 16384 pixels")?;
        unless((1..=8).contains(&supersampling), "supersampling", &supersampling, "1 to 8 samples")?;
        unless((0.0..=0.4).contains(&margin), "margin", &margin, "0 to 0.4")?;
        unless(share.contains(&occlusion), "occlusion", &occlusion, "0 to 1")?;
        unless(share.contains(&lines), "lines", &lines, "0 to 1")?;
        unless((6..=512).contains(&caption), "caption_size", &caption, "6 to 512 pixels")?;
        Ok(())
    }

    /// Height of capital letters in captions, in pixels.
    pub(crate) fn letters(&self) -> usize {
        self.caption_size.unwrap_or((self.height / 50).clamp(9, 512))
    }
}
