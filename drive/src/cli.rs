//! The command line.

mod arguments;

use std::ffi::OsString;
use std::time::Duration;

use clap::CommandFactory as _;
use drivers::{Command, Setting};
use haptic_control::SceneKind;
use terminal::explain;
use terminal::failure::Failure;
use terminal::output::{is_stdout, note, print_bytes};
use terminal::parse::parsed;

use self::arguments::{Action, Arguments, Hold};
use crate::board::{Answer, Board};
use crate::bring_up;
use crate::calibrate;
use crate::identity;
use crate::named::{self, Known, Tuning};
use crate::port::{Port, list};
use crate::record::Recorder;
use crate::session::{self, Plan};
use crate::settings::{self, Assignment};
use crate::timed::Change;
use crate::watch::state;

impl Hold {
    fn plan(self, answer: &Answer) -> Plan {
        Plan {
            scene: None,
            changes: Vec::new(),
            seconds: self.seconds,
            every: Some(self.every),
            has_stdout: self.record.as_deref().is_some_and(is_stdout),
            recorder: self.record.map(|out| Recorder::new(&answer.hello, out)),
            keeps_alive: true,
        }
    }
}

/// Runs the command line `arguments`, whose first element is the program's name.
///
/// # Errors
/// A [`Failure`] with its exit status.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> Result<(), Failure> {
    let arguments: Vec<_> = arguments.into_iter().collect();
    match parsed::<Arguments>(arguments.clone()) {
        Ok(arguments) => act(arguments),
        Err(error) => explain(&error, &asked(&arguments)),
    }
}

/// The program, with the command among the arguments, whose help has the usage.
fn asked(arguments: &[OsString]) -> String {
    let commands = Arguments::command();
    let command = |argument: &OsString| commands.find_subcommand(argument);
    match arguments.iter().skip(1).find_map(command) {
        Some(command) => format!("cargo drive {}", command.get_name()),
        None => "cargo drive".to_owned(),
    }
}

/// How the board is reached.
struct Connection {
    /// Name of the port; `None` for the one port with a board.
    port: Option<String>,
    /// Longest wait for an answer.
    patience: Duration,
}

impl Connection {
    fn open(&self) -> Result<Board, Failure> {
        let port = Port::open(self.port.as_deref())?;
        Ok(Board::new(port, self.patience))
    }

    /// A board that speaks the protocol of this tool, and its identity.
    fn compatible(&self) -> Result<(Board, Answer), Failure> {
        let mut board = self.open()?;
        let answer = board.compatible()?;
        Ok((board, answer))
    }
}

fn act(arguments: Arguments) -> Result<(), Failure> {
    let connection = Connection {
        port: arguments.port,
        patience: Duration::from_secs_f64(arguments.timeout),
    };
    match arguments.action {
        Action::List(_) => match connection.port {
            None => print_ports(),
            Some(name) => Err(Failure::Input(format!(
                "--port {name}: list opens no port; leave --port out"
            ))),
        },
        Action::Info => {
            let answer = connection.open()?.identify()?;
            print_bytes(identity::text(&answer).as_bytes())
        }
        Action::Disarm => {
            // Every protocol has this command, so that nothing is asked before it.
            let frame = connection.open()?.disarm()?;
            note(format_args!("disarmed: {}", state(&frame)));
            Ok(())
        }
        Action::Arm(hold) => {
            let (mut board, answer) = connection.compatible()?;
            session::armed(&mut board, &answer, hold.plan(&answer))
        }
        Action::KeepAlive(hold) => {
            let (mut board, answer) = connection.compatible()?;
            session::kept_alive(&mut board, &answer, hold.plan(&answer))
        }
        Action::Select {
            scene,
            tune,
            estimator,
            hold,
        } => {
            let mut changes = Vec::new();
            for timed in &tune {
                changes.push((timed.at_s, timed.tuning(scene)?));
            }
            for timed in &estimator {
                changes.push((timed.at_s, timed.estimator()?));
            }
            render(connection.open()?, scene, changes, hold)
        }
        Action::Torque { value, hold } => {
            let torque = Tuning::new(SceneKind::Torque, "torque", value)?;
            let changes = vec![(0.0, Change::Tuning(torque))];
            render(connection.open()?, SceneKind::Torque, changes, hold)
        }
        Action::Tune {
            scene,
            parameter,
            value,
        } => tune(&connection, &Tuning::new(scene, &parameter, value)?),
        Action::Estimator { number } => {
            let (mut board, _) = connection.compatible()?;
            let name = named::called(number);
            board.change(Command::Estimator(number), &name)?;
            note(format_args!("{name}, until the next reset"));
            Ok(())
        }
        Action::Settings { assignments, store } => {
            change_settings(&connection, &assignments, store)
        }
        Action::BringUp { turns, store } => bring_up::run(&mut connection.open()?, turns, store),
        Action::Calibrate { store } => calibrate::run(&mut connection.open()?, store),
        Action::Record { out, seconds } => {
            let (mut board, answer) = connection.compatible()?;
            let recorder = Some(Recorder::new(&answer.hello, out));
            let plan = shown(None, seconds, recorder);
            session::unarmed(&mut board, &answer, plan)
        }
        Action::Watch { every, seconds } => {
            let (mut board, answer) = connection.compatible()?;
            session::unarmed(&mut board, &answer, shown(Some(every), seconds, None))
        }
    }
}

/// Tunes a parameter until the next reset.
fn tune(connection: &Connection, tuning: &Tuning) -> Result<(), Failure> {
    if tuning.scene() == SceneKind::Torque {
        // The set-point is zero each time its scene is selected.
        return Err(Failure::Input(format!(
            "{tuning}: lasts only while the scene runs; use cargo drive torque VALUE"
        )));
    }
    let (mut board, answer) = connection.compatible()?;
    tuning.check(&answer.hello)?;
    board.change(tuning.command(), &tuning.to_string())?;
    note(format_args!("{tuning}, until the next reset"));
    Ok(())
}

/// Changes settings, shows all of them, and stores them if `store` says so.
fn change_settings(
    connection: &Connection,
    assignments: &[Assignment],
    store: bool,
) -> Result<(), Failure> {
    let (mut board, answer) = connection.compatible()?;
    for it in assignments {
        if it.setting == Setting::Estimator {
            named::numbered(it.value as u8, &answer.hello)
                .map_err(|error| format!("estimator={}: {error}", it.value))?;
        }
    }
    settings::change(&mut board, assignments)?;
    print_bytes(settings::table(&mut board)?.as_bytes())?;
    if store {
        return settings::store(&mut board);
    }
    if !assignments.is_empty() {
        note("until the next reset; --store keeps them");
    }
    Ok(())
}

/// Arms the board and renders a scene.
fn render(
    mut board: Board,
    scene: SceneKind,
    mut changes: Vec<(f64, Change)>,
    hold: Hold,
) -> Result<(), Failure> {
    let answer = board.compatible()?;
    // Those of one time keep their order.
    changes.sort_by(|(a, _), (b, _)| a.total_cmp(b));
    let mut known = Known::least(scene);
    for (_, change) in &changes {
        if let Change::Tuning(tuning) = change {
            known.set(tuning, &answer.hello)?;
        }
    }
    let plan = Plan {
        scene: Some(scene),
        changes,
        ..hold.plan(&answer)
    };
    session::armed(&mut board, &answer, plan)
}

/// A plan that sends nothing.
fn shown(every: Option<f64>, seconds: Option<f64>, recorder: Option<Recorder>) -> Plan {
    Plan {
        scene: None,
        changes: Vec::new(),
        seconds,
        every,
        recorder,
        has_stdout: false,
        keeps_alive: false,
    }
}

fn print_ports() -> Result<(), Failure> {
    let ports = list()?;
    if ports.is_empty() {
        note("no serial port; connect the board");
    }
    let lines: String = ports
        .iter()
        .map(|port| format!("{}\n", port.display()))
        .collect();
    print_bytes(lines.as_bytes())
}
