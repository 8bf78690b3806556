//! Sums and terms of a window.

/// Sums of a window, all from its begin on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Block {
    /// Direction of the large motor in every quarter; 0 if it is uncertain in one.
    pub(super) direction: i32,
    /// At the end: charge, A, large and small motor, counts.
    pub(super) end: [f32; 3],
    /// Means over the window.
    pub(super) mean: [f32; 3],
}

/// Terms of the balance with the described constants, A.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Terms {
    pub(super) current: f32,
    pub(super) inertia: f32,
    pub(super) slip: f32,
    /// Largest error of their sum.
    pub(super) error: f32,
    /// Direction of the large motor; 0 if it is uncertain.
    pub(super) direction: i32,
}

pub(super) const REST: Terms = Terms {
    current: 0.0,
    inertia: 0.0,
    slip: 0.0,
    error: 0.0,
    direction: 0,
};

pub(super) const EMPTY: Block = Block {
    direction: 0,
    end: [0.0; 3],
    mean: [0.0; 3],
};
