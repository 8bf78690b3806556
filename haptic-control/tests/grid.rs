//! The grid of control ticks: missed and overrun ticks, from every count that wraps.

use haptic_control::Grid;

const PERIOD: u32 = 8400;
/// Counts at which a grid starts: 0, and some from which it wraps.
const STARTS: [u32; 4] = [0, u32::MAX, u32::MAX - PERIOD, u32::MAX - 3 * PERIOD / 2];

/// Ticks that begin so many counts after they were due, each of which takes no time.
fn begin(start: u32, after: &[u64]) -> Vec<u32> {
    let mut grid = Grid::<PERIOD>::new(start);
    let mut due = u64::from(start) + u64::from(PERIOD);
    let mut missed = Vec::new();
    for late in after {
        let now = due + late;
        missed.push(grid.begin(now as u32));
        grid.end(now as u32);
        due += u64::from(PERIOD) * (1 + late / u64::from(PERIOD));
        assert_eq!(grid.due(), due as u32, "from {start}");
    }
    missed
}

#[test]
fn tick_within_its_period_misses_none() {
    for start in STARTS {
        let after = [0, 1, 20, 0, u64::from(PERIOD) - 1, 0, 8000];
        assert_eq!(begin(start, &after), [0; 7], "from {start}");
    }
}

#[test]
fn a_halt_of_n_periods_counts_n_missed_ticks() {
    let period = u64::from(PERIOD);
    for start in STARTS {
        // 10 ms, 1 s and 50 s: the counter wraps after 51 s.
        for n in [1, 2, 100, 10_000, 500_000] {
            for beside in [0, 1, period - 1] {
                let after = [3, n * period + beside, 3];
                assert_eq!(begin(start, &after), [0, n as u32, 0], "from {start}");
            }
        }
    }
}

/// A tick of 1.2 periods delays the next by 0.2 of one, that one by 0.4, and the sixth begins a
/// whole period late.
#[test]
fn every_tick_longer_than_the_period_is_counted() {
    for start in STARTS {
        let mut grid = Grid::<PERIOD>::new(start);
        let mut now = start.wrapping_add(PERIOD);
        let mut counted = Vec::new();
        for _ in 0..11 {
            counted.push(grid.begin(now));
            now = now.wrapping_add(PERIOD + PERIOD / 5);
            grid.end(now);
        }
        assert_eq!(counted, [0, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1], "from {start}");
    }
}

#[test]
fn tick_just_inside_its_period_is_no_overrun() {
    for (spent, counted) in [(PERIOD - 1, 0), (PERIOD, 1), (PERIOD + 1, 1)] {
        for start in STARTS {
            let mut grid = Grid::<PERIOD>::new(start);
            let due = grid.due();
            assert_eq!(grid.begin(due), 0);
            grid.end(due.wrapping_add(spent));
            let next = grid.due().wrapping_add(10);
            assert_eq!(grid.begin(next), counted, "{spent} from {start}");
            grid.end(next);
            assert_eq!(grid.begin(grid.due()), 0, "after {spent} from {start}");
        }
    }
}

#[test]
fn longest_tick_is_kept_until_it_is_read() {
    for start in STARTS {
        let mut grid = Grid::<PERIOD>::new(start);
        for (latency, spent) in [(4, 3000), (9, 5000), (4, 2000)] {
            let due = grid.due();
            grid.begin(due.wrapping_add(latency));
            grid.end(due.wrapping_add(latency + spent));
        }
        assert_eq!((grid.take_longest(), grid.take_longest()), (5009, 0));
    }
}

/// The task sets the comparison after it has read the counter. A halt between the two lets the next tick
/// pass without an interrupt, and the end of the task has to make up for it.
#[test]
fn end_of_a_tick_reports_that_the_next_one_is_due_however_long_ago() {
    for start in STARTS {
        for halted in [0, 1, PERIOD, 3 * PERIOD, 100_000 * PERIOD] {
            let mut grid = Grid::<PERIOD>::new(start);
            let due = grid.due();
            grid.begin(due);
            assert!(!grid.end(due.wrapping_add(PERIOD - 1)));
            grid.begin(grid.due());
            assert!(grid.end(grid.due().wrapping_add(halted)), "{halted}");
        }
    }
}

#[test]
fn overrun_that_is_shorter_than_one_before_is_counted() {
    for start in STARTS {
        let mut grid = Grid::<PERIOD>::new(start);
        for spent in [9, 3, 1] {
            let due = grid.due();
            grid.begin(due);
            assert!(grid.end(due.wrapping_add(spent * PERIOD)));
            let begins = due.wrapping_add(spent * PERIOD + 10);
            assert_eq!(grid.begin(begins), spent - 1 + u32::from(spent == 1));
            grid.end(begins.wrapping_add(100));
        }
        assert!(grid.take_longest() >= 9 * PERIOD);
        assert_eq!(grid.take_longest(), 0, "it was read");
    }
}
