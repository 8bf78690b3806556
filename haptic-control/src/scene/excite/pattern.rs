//! The currents of the excitation over time.

/// Equidistant levels of the large motor's current, each held for the same time.
#[derive(Clone, Copy)]
pub(super) struct Segment {
    /// First level, mA.
    from: i16,
    /// Level that would follow the last one, mA.
    to: i16,
    /// Small motor's current, mA.
    pub(super) small: i16,
    /// Number of levels.
    pub(super) steps: u8,
    /// Duration of each level, ms.
    pub(super) hold_ms: u16,
}

impl Segment {
    const fn hold(large: i16, small: i16, hold_ms: u16) -> Self {
        Self {
            from: large,
            to: large,
            small,
            steps: 1,
            hold_ms,
        }
    }

    const fn sweep(from: i16, to: i16, steps: u8, hold_ms: u16) -> Self {
        Self {
            from,
            to,
            small: 0,
            steps,
            hold_ms,
        }
    }

    /// Level of the large motor's current, mA.
    pub(super) fn large(&self, step: u8) -> f32 {
        let (from, to) = (f32::from(self.from), f32::from(self.to));
        from + (to - from) * f32::from(step) / f32::from(self.steps)
    }
}

/// Largest magnitudes in the pattern, large and small motor, mA.
pub(super) const LARGEST: [i16; 2] = largest(&SECTIONS);
/// Largest magnitudes in the strokes, large and small motor, mA.
pub(super) const LARGEST_OF_STROKES: [i16; 2] = largest(&[&STROKES]);

const fn largest(sections: &[&[Segment]]) -> [i16; 2] {
    let mut largest = [0; 2];
    let mut i = 0;
    while i < sections.len() {
        let mut j = 0;
        while j < sections[i].len() {
            let segment = &sections[i][j];
            largest[0] = larger(largest[0], larger(segment.from.abs(), segment.to.abs()));
            largest[1] = larger(largest[1], segment.small.abs());
            j += 1;
        }
        i += 1;
    }
    largest
}

const fn larger(a: i16, b: i16) -> i16 {
    if a > b { a } else { b }
}

/// Strokes in both directions at a few currents. A free handle ends near its start.
const STROKES: [Segment; 49] = [
    Segment::hold(0, 0, 40),
    Segment::hold(300, 0, 18),
    Segment::hold(120, 0, 16),
    Segment::hold(0, 0, 12),
    Segment::hold(0, 150, 12),
    Segment::hold(0, -150, 12),
    Segment::hold(100, 0, 14),
    Segment::hold(-100, 100, 10),
    Segment::hold(0, 0, 60),
    Segment::hold(-300, 0, 18),
    Segment::hold(-120, 0, 16),
    Segment::hold(0, 0, 12),
    Segment::hold(0, -150, 12),
    Segment::hold(0, 150, 12),
    Segment::hold(-100, 0, 14),
    Segment::hold(100, -100, 10),
    Segment::hold(0, 0, 60),
    Segment::hold(250, 100, 16),
    Segment::hold(150, -100, 16),
    Segment::hold(200, 0, 10),
    Segment::hold(0, 0, 10),
    Segment::hold(0, 120, 16),
    Segment::hold(150, -100, 12),
    Segment::hold(-150, 0, 12),
    Segment::hold(0, 0, 60),
    Segment::hold(-250, -100, 16),
    Segment::hold(-150, 100, 16),
    Segment::hold(-200, 0, 10),
    Segment::hold(0, 0, 10),
    Segment::hold(0, -120, 16),
    Segment::hold(-150, 100, 12),
    Segment::hold(150, 0, 12),
    Segment::hold(0, 0, 60),
    Segment::hold(200, 150, 14),
    Segment::hold(200, -150, 12),
    Segment::hold(100, 0, 16),
    Segment::hold(-50, 150, 12),
    Segment::hold(150, 0, 12),
    Segment::hold(0, -100, 12),
    Segment::hold(100, 100, 12),
    Segment::hold(0, 0, 70),
    Segment::hold(-200, -150, 14),
    Segment::hold(-200, 150, 12),
    Segment::hold(-100, 0, 16),
    Segment::hold(50, -150, 12),
    Segment::hold(-150, 0, 12),
    Segment::hold(0, 100, 12),
    Segment::hold(-100, -100, 12),
    Segment::hold(0, 0, 70),
];

/// Steps between levels of one sign and of both, and slow sweeps.
const LEVELS: [Segment; 35] = [
    Segment::hold(0, 0, 60),
    Segment::hold(300, 0, 160),
    Segment::hold(900, 0, 60),
    Segment::hold(500, 0, 40),
    Segment::hold(800, 0, 80),
    Segment::hold(250, 0, 120),
    Segment::hold(600, 0, 40),
    Segment::hold(350, 0, 60),
    Segment::hold(900, 0, 100),
    Segment::hold(200, 0, 25),
    Segment::hold(900, 0, 25),
    Segment::hold(200, 0, 25),
    Segment::hold(900, 0, 25),
    Segment::hold(200, 0, 25),
    Segment::hold(900, 0, 25),
    Segment::hold(200, 0, 25),
    Segment::hold(900, 0, 25),
    Segment::hold(200, 0, 25),
    Segment::hold(900, 0, 25),
    Segment::hold(200, 0, 25),
    Segment::hold(900, 0, 25),
    Segment::hold(200, 0, 25),
    Segment::hold(900, 0, 25),
    Segment::hold(150, 0, 100),
    Segment::hold(-400, 0, 60),
    Segment::hold(-900, 0, 80),
    Segment::hold(-500, 0, 60),
    Segment::hold(-700, 0, 40),
    Segment::hold(-300, 0, 100),
    Segment::hold(900, 0, 60),
    Segment::hold(-900, 0, 60),
    Segment::hold(900, 0, 40),
    Segment::sweep(900, 100, 40, 16),
    Segment::sweep(100, 900, 40, 16),
    Segment::hold(0, 0, 100),
];

/// The sections in their order.
pub(super) const SECTIONS: [&[Segment]; 2] = [&STROKES, &LEVELS];
