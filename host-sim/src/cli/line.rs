//! The command line as reports and shards show it.

use std::ffi::OsString;
use std::path::Path;

use terminal::wording::quoted;

/// Options that name an output or a part. All of them have a value.
const OUTPUTS: [&str; 3] = ["--out", "--json", "--shard"];

/// The command line with quotes where a shell needs them.
pub(super) fn command_line(arguments: &[OsString]) -> String {
    shown(arguments.iter().skip(1))
}

/// The command line without the options that name an output or a part: the same for all shards of a
/// run.
pub(super) fn run_line(arguments: &[OsString]) -> String {
    let mut is_value = false;
    let kept = arguments.iter().skip(1).filter(|argument| {
        let text = argument.to_string_lossy();
        let (name, value) = match text.split_once('=') {
            Some((name, _)) => (name, true),
            None => (&*text, false),
        };
        let is_output = !is_value && OUTPUTS.contains(&name);
        let dropped = is_output || is_value;
        is_value = is_output && !value;
        !dropped
    });
    shown(kept)
}

/// A command line of [`run_line`] with its outputs, as it is typed for a run without shards.
pub(super) fn with_outputs(run_line: &str, out: Option<&Path>, json: Option<&Path>) -> String {
    let mut line = run_line.to_owned();
    for (name, path) in [("--out", out), ("--json", json)] {
        if let Some(path) = path {
            line += &format!(" {name} {}", quoted(path.as_os_str()));
        }
    }
    line
}

fn shown<'a>(arguments: impl Iterator<Item = &'a OsString>) -> String {
    let quoted = arguments.map(|argument| quoted(argument));
    std::iter::once("host-sim".to_owned())
        .chain(quoted)
        .collect::<Vec<_>>()
        .join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn line_of_a_run_has_no_outputs_and_no_part() {
        let run = |line: &str| {
            let arguments: Vec<OsString> = line.split(' ').map(Into::into).collect();
            run_line(&arguments)
        };
        let wanted = "host-sim zwidth --rate 1000 --set pll.bandwidth_hz=20";
        for line in [
            "x zwidth --rate 1000 --set pll.bandwidth_hz=20",
            "x zwidth --out a --rate 1000 --json - --set pll.bandwidth_hz=20 --shard 1/4",
            "x zwidth --rate 1000 --out=a --shard=1/4 --json=--out --set pll.bandwidth_hz=20",
        ] {
            assert_eq!(run(line), wanted, "{line}");
        }
        let line = with_outputs(wanted, Some(Path::new("a b")), Some(Path::new("-")));
        assert_eq!(line, format!("{wanted} --out 'a b' --json -"));
    }
}
