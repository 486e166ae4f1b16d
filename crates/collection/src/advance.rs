//! How far a batch is, from how far its shapes are.

/// What is known of a shape.
#[derive(Clone, Copy)]
enum Shape {
    Waiting,
    /// Expected seconds, and the share of them that is done.
    UnderWay(f64, f64),
    /// It took no time.
    Kept,
    /// It failed before it was known what it would take.
    Failed,
}

/// The shapes of a batch, and the share of the work that was told last.
pub(crate) struct Advance {
    shapes: Vec<Shape>,
    through: usize,
    told: f64,
}

impl Advance {
    pub fn new(shapes: usize) -> Self {
        Self { shapes: vec![Shape::Waiting; shapes], through: 0, told: 0.0 }
    }

    /// A shape that is expected to take so long is done to this share.
    pub fn is_at(&mut self, shape: usize, seconds: f64, done: f64) {
        self.shapes[shape] = Shape::UnderWay(seconds, done);
    }

    /// The batch is through with a shape.
    pub fn ends(&mut self, shape: usize, kept: bool) {
        self.through += 1;
        self.shapes[shape] = match self.shapes[shape] {
            Shape::UnderWay(seconds, _) => Shape::UnderWay(seconds, 1.0),
            _ if kept => Shape::Kept,
            _ => Shape::Failed,
        };
    }

    /// Shapes that the batch is through with.
    pub fn through(&self) -> usize {
        self.through
    }

    /// The share of the work that is done. Shapes that wait are expected to take as long as the others on average.
    pub fn share(&mut self) -> f64 {
        let (mut begun, mut seconds, mut done, mut waiting) = (0.0, 0.0, 0.0, 0.0);
        for shape in &self.shapes {
            match *shape {
                Shape::UnderWay(all, share) => {
                    begun += 1.0;
                    seconds += all;
                    done += all * share;
                }
                Shape::Waiting => waiting += 1.0,
                Shape::Kept | Shape::Failed => {}
            }
        }
        let share = match (begun > 0.0, self.through == self.shapes.len()) {
            (_, true) => 1.0,
            (true, _) => done / (seconds + waiting * seconds / begun),
            (false, _) => 0.0,
        };
        self.told = share.max(self.told);
        self.told
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shapes_count_as_long_as_they_take_and_kept_ones_nothing() {
        let mut advance = Advance::new(5);
        assert_eq!(advance.share(), 0.0);
        advance.ends(0, true);
        assert_eq!(advance.share(), 0.0);
        // Three more may take as long.
        advance.is_at(1, 2.0, 0.5);
        assert_eq!(advance.share(), 1.0 / 8.0);
        // One of 6 seconds, so 4 on average: 16 in all.
        advance.is_at(2, 6.0, 0.5);
        assert_eq!(advance.share(), 4.0 / 16.0);
        advance.ends(1, false);
        assert_eq!(advance.share(), 5.0 / 16.0);
        // One that is longer than others does not make it go back.
        advance.is_at(3, 16.0, 0.0);
        assert_eq!(advance.share(), 5.0 / 16.0);
        advance.ends(3, false);
        advance.ends(2, false);
        assert_eq!((advance.share(), advance.through()), (24.0 / 32.0, 4));
        // It can't be read.
        advance.ends(4, false);
        assert_eq!((advance.share(), advance.through()), (1.0, 5));
    }
}
