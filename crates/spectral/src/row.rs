//! Rows of a block of eight columns, in double and single precision.

/// Columns of a block.
pub(crate) const LANES: usize = 8;

/// A row of a block, aligned so that a vector register reads it at once.
#[repr(align(64))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Lanes(pub [f64; LANES]);

impl Lanes {
    pub const ZERO: Self = Self([0.0; LANES]);
}

/// A row of a block in single precision.
#[repr(align(32))]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Short(pub [f32; LANES]);

/// A row of a block, in double or single precision. Arithmetic is in double precision either way; what is stored is rounded.
pub(crate) trait Row: Copy + Send + Sync + 'static {
    /// A number of a row.
    type Number: Copy + Send + Sync;
    /// How much of the bound of the spectrum rounding may put into what is measured of `A x`.
    const ROUNDING: f64;
    /// The same of the rough part of `A x`, where that is measured apart.
    const ROUGH_ROUNDING: Option<f64>;
    const ZERO: Self;
    const ZERO_NUMBER: Self::Number;

    fn wide(self) -> Lanes;

    fn narrow(wide: Lanes) -> Self;

    fn number(x: f64) -> Self::Number;

    /// Some rows in double precision: themselves, or copies of them in the room.
    fn widened<'a>(rows: &'a [Self], room: &'a mut Vec<Lanes>) -> &'a [Lanes];

    /// Does something with rows of several blocks in double precision.
    fn change(blocks: &mut [&mut [Self]], work: impl FnOnce(&mut [&mut [Lanes]]));
}

impl Row for Lanes {
    type Number = f64;
    /// A few units in the last place.
    const ROUNDING: f64 = 16.0 * f64::EPSILON;
    const ROUGH_ROUNDING: Option<f64> = None;
    const ZERO: Self = Self::ZERO;
    const ZERO_NUMBER: f64 = 0.0;

    #[inline(always)]
    fn wide(self) -> Lanes {
        self
    }

    #[inline(always)]
    fn narrow(wide: Lanes) -> Self {
        wide
    }

    fn number(x: f64) -> f64 {
        x
    }

    fn widened<'a>(rows: &'a [Self], _: &'a mut Vec<Lanes>) -> &'a [Lanes] {
        rows
    }

    fn change(blocks: &mut [&mut [Self]], work: impl FnOnce(&mut [&mut [Lanes]])) {
        work(blocks);
    }
}

impl Row for Short {
    type Number = f32;
    /// Of smooth parts, which are measured apart.
    const ROUNDING: f64 = 4e-4 * f32::EPSILON as f64;
    /// A third more than where each entry is off by anything up to half a unit in its last place.
    const ROUGH_ROUNDING: Option<f64> = Some(0.25 * f32::EPSILON as f64);
    const ZERO: Self = Self([0.0; LANES]);
    const ZERO_NUMBER: f32 = 0.0;

    #[inline(always)]
    fn wide(self) -> Lanes {
        Lanes(self.0.map(f64::from))
    }

    #[inline(always)]
    fn narrow(wide: Lanes) -> Self {
        Self(wide.0.map(|x| x as f32))
    }

    fn number(x: f64) -> f32 {
        x as f32
    }

    fn widened<'a>(rows: &'a [Self], room: &'a mut Vec<Lanes>) -> &'a [Lanes] {
        room.resize(rows.len(), Lanes::ZERO);
        pulp::Arch::new().dispatch(
            #[inline(always)]
            || room.iter_mut().zip(rows).for_each(|(wide, row)| *wide = row.wide()),
        );
        room
    }

    fn change(blocks: &mut [&mut [Self]], work: impl FnOnce(&mut [&mut [Lanes]])) {
        let mut wide = vec![Vec::new(); blocks.len()];
        for (rows, wide) in blocks.iter().zip(&mut wide) {
            Self::widened(rows, wide);
        }
        work(&mut wide.iter_mut().map(Vec::as_mut_slice).collect::<Vec<_>>());
        pulp::Arch::new().dispatch(
            #[inline(always)]
            || {
                for (rows, wide) in blocks.iter_mut().zip(&wide) {
                    rows.iter_mut().zip(wide).for_each(|(row, &wide)| *row = Self::narrow(wide));
                }
            },
        );
    }
}

/// A block of columns.
pub(crate) type Block<R = Lanes> = Vec<R>;
