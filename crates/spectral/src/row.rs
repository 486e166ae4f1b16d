//! Rows of a block of eight columns, in double and single precision.

use pulp::Simd;
#[cfg(target_arch = "x86_64")]
use pulp::bytemuck;

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

    /// Does something with rows of several blocks in double precision; with room for copies of them.
    fn change(blocks: &mut [&mut [Self]], room: &mut [Vec<Lanes>], work: impl FnOnce(&mut [&mut [Lanes]]));
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

    fn change(blocks: &mut [&mut [Self]], _: &mut [Vec<Lanes>], work: impl FnOnce(&mut [&mut [Lanes]])) {
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
        widen(rows, room);
        room
    }

    fn change(blocks: &mut [&mut [Self]], room: &mut [Vec<Lanes>], work: impl FnOnce(&mut [&mut [Lanes]])) {
        for (rows, wide) in blocks.iter().zip(&mut *room) {
            Self::widened(rows, wide);
        }
        work(&mut room.iter_mut().map(Vec::as_mut_slice).collect::<Vec<_>>());
        for (rows, wide) in blocks.iter_mut().zip(&*room) {
            narrow(wide, rows);
        }
    }
}

/// A row as vectors: one with AVX-512, two with AVX2, eight numbers without SIMD; the others are not used.
pub(crate) type Vectors<S> = [<S as Simd>::f64s; LANES];

#[inline(always)]
pub(crate) fn vectors<S: Simd>(simd: S, row: &Lanes) -> Vectors<S> {
    let vectors = S::as_simd_f64s(&row.0).0;
    let unused = simd.splat_f64s(0.0);
    std::array::from_fn(|part| if part < LANES / S::F64_LANES { vectors[part] } else { unused })
}

#[inline(always)]
pub(crate) fn store<S: Simd>(row: &mut Lanes, vectors: Vectors<S>) {
    S::as_mut_simd_f64s(&mut row.0).0.iter_mut().zip(vectors).for_each(|(x, vector)| *x = vector);
}

/// A block of columns.
pub(crate) type Block<R = Lanes> = Vec<R>;

/// Rows in double precision. Left to itself the compiler converts eight rows at a time, which it gathers and scatters, and takes
/// six times as long.
fn widen(rows: &[Short], wide: &mut [Lanes]) {
    let pairs = wide.iter_mut().zip(rows);
    #[cfg(target_arch = "x86_64")]
    if let Some(simd) = pulp::x86::V3::try_new() {
        let widen = |row: &Short| {
            let halves: [_; 2] = bytemuck::cast(row.0);
            Lanes(bytemuck::cast(halves.map(|half| simd.avx._mm256_cvtps_pd(half))))
        };
        return simd.vectorize(
            #[inline(always)]
            || pairs.for_each(|(wide, row)| *wide = widen(row)),
        );
    }
    pairs.for_each(|(wide, row)| *wide = row.wide());
}

/// Rows in single precision, as [`widen`].
fn narrow(wide: &[Lanes], rows: &mut [Short]) {
    let pairs = rows.iter_mut().zip(wide);
    #[cfg(target_arch = "x86_64")]
    if let Some(simd) = pulp::x86::V3::try_new() {
        let narrow = |wide: &Lanes| {
            let halves: [_; 2] = bytemuck::cast(wide.0);
            Short(bytemuck::cast(halves.map(|half| simd.avx._mm256_cvtpd_ps(half))))
        };
        return simd.vectorize(
            #[inline(always)]
            || pairs.for_each(|(row, wide)| *row = narrow(wide)),
        );
    }
    pairs.for_each(|(row, wide)| *row = Short::narrow(*wide));
}
