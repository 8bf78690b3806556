//! The checks that stop the device.

use estimator_core::{Hertz, Sample};
use haptic_control::{Balance, BalanceState, DualStage, Monitor, MonitorState, Stop};

/// Monitor and balance of a run, with the reason for which they stopped it.
pub(super) struct Protection {
    monitor: (Monitor, MonitorState),
    balance: (Balance, BalanceState),
    stopped: Option<Stop>,
}

impl Protection {
    /// The checks of `device` from the sample `first` on.
    pub(super) fn start(device: &DualStage, rate: Hertz, first: &Sample) -> Self {
        let monitor = Monitor::new(device, rate);
        let balance = Balance::new(device, rate);
        Self {
            monitor: (monitor, monitor.start(first)),
            balance: (balance, balance.start(first)),
            stopped: None,
        }
    }

    /// Checks a sample. Returns the reason of the first stop of the run, if there was one.
    pub(super) fn check(&mut self, sample: &Sample) -> Option<Stop> {
        let (monitor, watch) = &mut self.monitor;
        let (balance, balanced) = &mut self.balance;
        // Both see every sample, also after a stop.
        let found = (
            monitor.check(watch, sample),
            balance.check(balanced, sample),
        );
        self.stopped = self.stopped.or(found.0).or(found.1);
        self.stopped
    }
}
