use estimator_core::{Amps, ClockTicks, Count, Edge, Sample, Signals};

/// The measurements of one tick. What an estimator does not read may be zero.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct limpid_sample_t {
    /// Count of the shaft whose velocity is estimated, modulo 2^32.
    pub count: u32,
    /// Count of the shaft on the other side of the coupling, modulo 2^32.
    pub coupled: u32,
    /// Motor current commanded over the period that ends with this sample, A. NaN and infinities count
    /// as 0, magnitudes above 1000 A as 1000 A.
    pub current: f32,
    /// Not 0 if `edge_boundary` and `edge_age` are valid: there has been an edge with a time stamp.
    pub has_edge: u32,
    /// Boundary that the latest edge crossed: boundary e lies between counts e - 1 and e.
    pub edge_boundary: u32,
    /// Time from the latest edge to this sample, in ticks of the clock that stamps edges, saturating.
    pub edge_age: u32,
}

impl limpid_sample_t {
    /// The sample of `estimator-core`. Where the estimator's update is a call, a current or an edge that it
    /// does not read would be copied and checked for nothing: they are constants.
    #[inline(always)]
    pub(crate) fn sample(&self, needs: Signals) -> Sample {
        Sample {
            count: Count(self.count),
            coupled: Count(self.coupled),
            current: if needs.current {
                Amps::new(self.current)
            } else {
                Amps::ZERO
            },
            edge: (needs.edge && self.has_edge != 0).then_some(Edge {
                boundary: Count(self.edge_boundary),
                age: ClockTicks(self.edge_age),
            }),
        }
    }
}
