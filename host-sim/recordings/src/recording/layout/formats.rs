//! Logs of other programs, which are read by their own column names.

use crate::recording::options::Column;

/// A part of a header that is the name of a column.
#[derive(Clone, Copy, Debug)]
enum Called {
    /// The whole name.
    Name(&'static str),
    /// The end of a longer name; only one column of a log may end so.
    End(&'static str),
}

use Called::{End, Name};

/// A column of a foreign log.
#[derive(Clone, Copy, Debug)]
struct Foreign {
    column: Column,
    called: Called,
    unit: &'static str,
}

const fn foreign(column: Column, called: Called, unit: &'static str) -> Foreign {
    Foreign {
        column,
        called,
        unit,
    }
}

/// The log of another program.
#[derive(Debug)]
pub(crate) struct Format {
    /// Name in messages.
    pub(crate) name: &'static str,
    /// A column that distinguishes this log; any name fits where it is empty.
    mark: &'static str,
    /// Its columns, the preferred one first where several measure the same.
    columns: &'static [Foreign],
    /// Whether the log is of this project.
    pub(crate) own: bool,
    /// Where the names of the columns come from.
    pub(crate) source: &'static str,
}

/// The known logs. A header belongs to the first one whose mark, time and position it has.
pub(crate) const FORMATS: &[Format] = &[
    Format {
        name: "Limpid, fine encoder",
        mark: "",
        columns: &[
            foreign(Column::T, Name("time_s"), "s"),
            foreign(Column::CountsLarge, Name("fine_count"), "counts"),
            foreign(Column::Current, Name("motor_torque_nm"), "N.m"),
            foreign(Column::TrueOmega, Name("true_omega_rad_s"), "rad/s"),
        ],
        own: true,
        source: "tests/data/real/README.md",
    },
    Format {
        name: "moteus",
        mark: "q_A",
        columns: &[
            foreign(Column::T, Name("timestamp"), "s"),
            foreign(Column::CountsLarge, Name("position"), "rev"),
            foreign(Column::Current, Name("q_A"), "A"),
        ],
        own: false,
        source: "mjbots/moteus, utils/gui/moteus_gui/tview.py (log as CSV or JSONL) and \
                 fw/bldc_servo_structs.h (channel servo_stats)",
    },
    Format {
        name: "moteus",
        mark: "POSITION",
        columns: &[
            foreign(Column::T, Name("time"), "s"),
            foreign(Column::CountsLarge, Name("POSITION"), "rev"),
            foreign(Column::Current, Name("Q_CURRENT"), "A"),
        ],
        own: false,
        source: "mjbots/moteus, lib/python/examples/csv_output.py (names of moteus.Register)",
    },
    Format {
        name: "ODrive",
        mark: "",
        columns: &[
            foreign(Column::T, Name("time"), "s"),
            foreign(Column::CountsLarge, End("encoder.shadow_count"), "counts"),
            foreign(Column::CountsLarge, End("encoder.pos_estimate"), "rev"),
            foreign(Column::CountsLarge, End("pos_vel_mapper.pos_rel"), "rev"),
            foreign(Column::CountsLarge, End("axis0.pos_estimate"), "rev"),
            foreign(Column::CountsLarge, End("axis1.pos_estimate"), "rev"),
            foreign(Column::Current, End("Iq_measured"), "A"),
        ],
        own: false,
        source: "odriverobotics/ODrive, GUI/src/components/plots/Plot.vue (Export) and \
                 Firmware/odrive-interface.yaml; pos_vel_mapper and axis0.pos_estimate are of firmware 0.6",
    },
    Format {
        name: "VESC Tool",
        mark: "ms_today",
        columns: &[
            foreign(Column::T, Name("ms_today"), "ms"),
            foreign(Column::CountsLarge, Name("encoder_position"), "deg"),
            foreign(Column::Current, Name("q_axis_current"), "A"),
        ],
        own: false,
        source: "vedderb/vesc_tool, vescinterface.cpp (log of real-time data)",
    },
    Format {
        name: "PlotJuggler",
        mark: "",
        columns: &[
            foreign(Column::T, Name("__time"), "s"),
            foreign(Column::T, Name("time"), "s"),
            foreign(Column::CountsLarge, End("/position"), "rad"),
            foreign(Column::Current, End("/effort"), "N.m"),
        ],
        own: false,
        source: "facontidavide/PlotJuggler, plotjuggler_plugins/ToolboxCSV and datasamples/turtle.csv; \
                 position (rad) and effort (N.m) are those of the ROS message JointState",
    },
];

/// The output of `motor.monitor()` of SimpleFOC: numbers separated by tabs, without names or time.
pub(crate) const SIMPLEFOC: Format = Format {
    name: "SimpleFOC",
    mark: "",
    columns: &[
        foreign(Column::CountsLarge, Name("angle"), "rad"),
        foreign(Column::Current, Name("current.q"), "mA"),
    ],
    own: false,
    source: "simplefoc/Arduino-FOC, src/common/base_classes/FOCMotor.cpp (monitor)",
};

/// Names of the columns of [`SIMPLEFOC`] by their number: the default variables, and all of them.
pub(crate) const SIMPLEFOC_COLUMNS: [&[&str]; 2] = [
    &["target", "voltage.q", "velocity", "angle"],
    &[
        "target",
        "voltage.q",
        "voltage.d",
        "current.q",
        "current.d",
        "velocity",
        "angle",
    ],
];

/// A column of a known log in a header.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Found {
    pub(crate) column: Column,
    /// Its place in the header.
    pub(crate) place: usize,
    pub(crate) unit: &'static str,
}

/// A known log, for lists in the documentation.
#[derive(Clone, Debug)]
pub struct KnownLog {
    /// Name of the program.
    pub name: &'static str,
    /// Each column that is read: the project's name, the log's name and its unit. A log's name that
    /// begins with `...` is the end of a longer name.
    pub columns: Vec<[String; 3]>,
    /// Where the names come from.
    pub source: &'static str,
}

/// The logs of other programs that are read by their own column names.
#[must_use]
pub fn known_logs() -> Vec<KnownLog> {
    let column = |foreign: &Foreign| {
        let theirs = match foreign.called {
            Name(name) => name.to_owned(),
            End(end) => format!("...{end}"),
        };
        [
            foreign.column.name().to_owned(),
            theirs,
            foreign.unit.to_owned(),
        ]
    };
    let known = |format: &'static Format| KnownLog {
        name: format.name,
        columns: format.columns.iter().map(column).collect(),
        source: format.source,
    };
    Format::all().map(known).collect()
}

impl Format {
    /// Every known log.
    pub(crate) fn all() -> impl Iterator<Item = &'static Self> {
        FORMATS.iter().chain(std::iter::once(&SIMPLEFOC))
    }

    /// The log with this header.
    pub(crate) fn of(header: &[String]) -> Option<&'static Self> {
        FORMATS.iter().find(|format| format.has(header))
    }

    /// The log of this project with this header.
    pub(crate) fn own(header: &[String]) -> Option<&'static Self> {
        FORMATS
            .iter()
            .find(|format| format.own && format.has(header))
    }

    fn has(&self, header: &[String]) -> bool {
        let found = self.find(header);
        // Names of this project may stand beside each other.
        let is_own = |column: Column| self.own && header.iter().any(|name| name == column.name());
        let has = |column| found.iter().any(|found| found.column == column) || is_own(column);
        self.is_marked(header) && has(Column::T) && has(Column::CountsLarge)
    }

    fn is_marked(&self, header: &[String]) -> bool {
        self.mark.is_empty() || header.iter().any(|name| name == self.mark)
    }

    /// The unit of the position at `place` of `header` where its name is one of a known log, which may lack other
    /// columns. A name that other programs write tells no more than the column beside it that distinguishes a log.
    pub(crate) fn position_unit(header: &[String], place: usize) -> Option<&'static str> {
        FORMATS.iter().find_map(|format| {
            let is_marked = !format.mark.is_empty() && format.is_marked(header);
            let mut positions = format.columns.iter().filter(|foreign| {
                foreign.column == Column::CountsLarge
                    && (is_marked || matches!(foreign.called, End(_)))
            });
            let position = positions.find(|foreign| foreign.places(header).contains(&place));
            position.map(|foreign| foreign.unit)
        })
    }

    /// The columns of this log in `header`.
    pub(crate) fn find(&self, header: &[String]) -> Vec<Found> {
        let mut found: Vec<Found> = Vec::new();
        for foreign in self.columns {
            let known = found.iter().any(|found| found.column == foreign.column);
            if let ([place], false) = (&foreign.places(header)[..], known) {
                found.push(Found {
                    column: foreign.column,
                    place: *place,
                    unit: foreign.unit,
                });
            }
        }
        found
    }
}

impl Foreign {
    /// The places in `header` that have this column.
    fn places(&self, header: &[String]) -> Vec<usize> {
        let here = |name: &String| match self.called {
            Name(whole) => name == whole,
            End(end) => name.ends_with(end),
        };
        (0..header.len())
            .filter(|&place| here(&header[place]))
            .collect()
    }
}

/// A header of a known log in which several columns fit the position.
#[derive(Debug)]
pub(crate) struct Ambiguous {
    pub(crate) format: &'static Format,
    pub(crate) time: Found,
    /// Places of the positions, at least two.
    pub(crate) positions: Vec<usize>,
    /// Unit of the positions.
    pub(crate) unit: &'static str,
}

impl Ambiguous {
    /// The ambiguous log with this header.
    pub(crate) fn of(header: &[String]) -> Option<Self> {
        FORMATS.iter().find_map(|format| {
            let found = format.find(header);
            let time = found.into_iter().find(|found| found.column == Column::T)?;
            let mut positions = format.columns.iter().filter_map(|foreign| {
                let places = foreign.places(header);
                let fit = foreign.column == Column::CountsLarge && places.len() > 1;
                fit.then_some((places, foreign.unit))
            });
            let (positions, unit) = positions.next().filter(|_| format.is_marked(header))?;
            Some(Self {
                format,
                time,
                positions,
                unit,
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_unit_of_a_known_log_is_a_unit() {
        for format in Format::all() {
            assert!(format.source.contains('/'), "{}", format.name);
            for foreign in format.columns {
                let unit = foreign.column.quantity().unit(foreign.unit);
                assert!(unit.is_some(), "{} {foreign:?}", format.name);
            }
        }
    }

    #[test]
    fn ambiguous_columns_are_not_chosen() {
        let header = |names: &[&str]| {
            names
                .iter()
                .map(|name| (*name).to_owned())
                .collect::<Vec<_>>()
        };
        let one = header(&["__time", "/joints/a/position", "/joints/a/velocity"]);
        assert_eq!(
            Format::of(&one).map(|format| format.name),
            Some("PlotJuggler")
        );
        let two = header(&["__time", "/joints/a/position", "/joints/b/position"]);
        assert!(Format::of(&two).is_none());
        let ambiguous = Ambiguous::of(&two).unwrap();
        assert_eq!((ambiguous.positions, ambiguous.unit), (vec![1, 2], "rad"));
        assert!(Ambiguous::of(&one).is_none());
    }
}
