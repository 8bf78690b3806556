//! Value change dumps (VCD, IEEE 1364), as logic analysers and simulators of hardware write them: a row per time
//! stamp, with the latest value of every variable.

use std::collections::HashMap;
use std::io::{self, BufRead, Chain};
use std::{iter, slice};

use csv::ByteRecord;
use vcd::{Command, IdCode, ParseError, Parser, Value, Vector};

use terminal::failure::Failure;

use crate::log::cannot_read;
use crate::recording::layout::{Layout, UNKNOWN};

/// The commands that such a file may begin with.
const BEGINS: [&str; 5] = ["$date", "$version", "$timescale", "$comment", "$scope"];

/// The column of time.
const TIME: &str = "time [ns]";

/// Whether `head` is the begin of a value change dump.
pub(super) fn is_begin(head: &str) -> bool {
    let first = head.split_whitespace().next();
    first.is_some_and(|word| BEGINS.contains(&word))
}

/// A variable.
struct Variable {
    /// Name within its scope, and with the scopes around it.
    name: String,
    path: String,
    code: IdCode,
    is_bit: bool,
}

/// Reads a value change dump.
pub(super) struct ValueChanges<R> {
    parser: Parser<Chain<R, &'static [u8]>>,
    /// Places of the columns that a code names.
    places: HashMap<IdCode, Vec<usize>>,
    /// Latest value of each column.
    values: Vec<String>,
    /// Duration of a unit of the time stamps, ns.
    scale_ns: f64,
    /// The time stamp of the next row, and its line.
    stamp: Option<(u64, u64)>,
}

impl<R: BufRead> ValueChanges<R> {
    /// Reads the definitions of the dump called `name`, and returns its columns too.
    pub(super) fn open(input: R, name: &str) -> Result<(Self, Layout), Failure> {
        // Every token ends with a white space, the last one of the file included.
        let mut parser = Parser::new(input.chain(&b"\n"[..]));
        let mut scopes = Vec::new();
        let mut variables: Vec<Variable> = Vec::new();
        let mut scale_ns = None;
        loop {
            match command(&mut parser, name)? {
                Some(Command::ScopeDef(_, scope)) => scopes.push(scope),
                Some(Command::Upscope) => {
                    scopes.pop();
                }
                Some(Command::VarDef(_, bits, code, name, index)) => {
                    // A bit of a vector has an index.
                    let index = index.filter(|_| bits == 1).map(|index| index.to_string());
                    let name = name + &index.unwrap_or_default();
                    variables.push(Variable {
                        path: [scopes.as_slice(), slice::from_ref(&name)]
                            .concat()
                            .join("."),
                        name,
                        code,
                        is_bit: bits == 1,
                    });
                }
                Some(Command::Timescale(number, unit)) => {
                    scale_ns = Some(f64::from(number) * 1e9 / unit.divisor() as f64);
                }
                Some(Command::Enddefinitions) => break,
                Some(Command::Timestamp(_)) | None => {
                    return Err(failure(&parser, name, "no $enddefinitions"));
                }
                Some(_) => {}
            }
        }
        let scale_ns = scale_ns.ok_or_else(|| failure(&parser, name, "no $timescale"))?;
        let mut called: HashMap<_, u32> = HashMap::new();
        let mut places: HashMap<_, Vec<_>> = HashMap::new();
        for (variable, place) in variables.iter().zip(1..) {
            *called.entry(variable.name.as_str()).or_default() += 1;
            places.entry(variable.code).or_default().push(place);
        }
        let name = |variable: &Variable| match called[variable.name.as_str()] {
            1 => variable.name.clone(),
            _ => variable.path.clone(),
        };
        let names = iter::once(TIME.to_owned()).chain(variables.iter().map(name));
        let names: Vec<_> = names.collect();
        let bits = variables
            .iter()
            .zip(1..)
            .filter(|(variable, _)| variable.is_bit);
        let layout = Layout {
            two_levels: bits.map(|(_, place)| place).collect(),
            ..Layout::named_values(names)
        };
        let values = vec![UNKNOWN.to_owned(); layout.names.len()];
        let dump = Self {
            parser,
            places,
            values,
            scale_ns,
            stamp: None,
        };
        Ok((dump, layout))
    }

    /// Reads the next row into `record` and returns the line of its time stamp.
    pub(super) fn read(
        &mut self,
        record: &mut ByteRecord,
        name: &str,
    ) -> Result<Option<u64>, Failure> {
        loop {
            let (code, value) = match command(&mut self.parser, name)? {
                Some(Command::Timestamp(ticks)) => {
                    let row = self.stamp.replace((ticks, self.parser.line()));
                    match row {
                        Some(row) => return Ok(Some(self.row(row, record))),
                        None => continue,
                    }
                }
                None => return Ok(self.stamp.take().map(|row| self.row(row, record))),
                Some(Command::ChangeScalar(code, value)) => (code, level(value).to_owned()),
                Some(Command::ChangeVector(code, value)) => (code, number(&value)),
                Some(Command::ChangeReal(code, value)) => (code, value.to_string()),
                Some(_) => continue,
            };
            let Some(places) = self.places.get(&code) else {
                let what = format!("no $var has the code {code}");
                return Err(failure(&self.parser, name, &what));
            };
            for place in places {
                self.values[*place].clone_from(&value);
            }
        }
    }

    fn row(&mut self, (ticks, line): (u64, u64), record: &mut ByteRecord) -> u64 {
        self.values[0] = (ticks as f64 * self.scale_ns).to_string();
        record.clear();
        for value in &self.values {
            record.push_field(value.as_bytes());
        }
        line
    }
}

/// The level of a line as other captures have it.
const fn level(value: Value) -> &'static str {
    match value {
        Value::V0 => "0",
        Value::V1 => "1",
        Value::X | Value::Z => UNKNOWN,
    }
}

/// The number that a vector is, without a sign; [`UNKNOWN`] for one that has an unknown bit or more than 64.
fn number(value: &Vector) -> String {
    let bits: String = value.iter().map(level).collect();
    u64::from_str_radix(&bits, 2).map_or(UNKNOWN.to_owned(), |number| number.to_string())
}

/// The next command; `None` at the end of the file.
fn command<R: BufRead>(parser: &mut Parser<R>, name: &str) -> Result<Option<Command>, Failure> {
    parser.next().transpose().map_err(|error| {
        let inner = error
            .get_ref()
            .and_then(|inner| inner.downcast_ref::<ParseError>());
        match (inner, error.kind()) {
            (Some(inner), _) => failure(parser, name, &inner.kind().to_string()),
            (None, io::ErrorKind::UnexpectedEof) => failure(
                parser,
                name,
                "the file ends in a command; remove the line if the file was cut there",
            ),
            (None, _) => cannot_read(name, &error),
        }
    })
}

/// Error in the line that `parser` has read.
fn failure<R: BufRead>(parser: &Parser<R>, name: &str, what: &str) -> Failure {
    Failure::Input(format!(
        "{name}: line {}: not a value change dump (VCD): {what}",
        parser.line()
    ))
}
