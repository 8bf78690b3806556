//! The parser of a command line, in what all programs have in common.

use std::ffi::OsString;

use clap::{Arg, ArgMatches, Command, Parser};

/// The arguments of a command line, whose first element is the program's name. Options and the command `help` are
/// those of [`matches()`].
///
/// # Errors
/// The parser's error, for [`explain`](crate::explain()).
pub fn parsed<A: Parser>(arguments: impl IntoIterator<Item = OsString>) -> Result<A, clap::Error> {
    let mut root = options_with_negative_numbers(A::command());
    let matches = matches(&mut root, arguments)?;
    A::from_arg_matches(&matches).map_err(|error| error.format(&mut root))
}

/// What the parser of [`options_with_negative_numbers`] finds in the arguments. `help NAME`, also with an option
/// `--help`, is `NAME --help`: of an unknown name the error has the nearest one.
///
/// # Errors
/// The parser's error, for [`explain`](crate::explain()).
pub fn matches(
    root: &mut Command,
    arguments: impl IntoIterator<Item = OsString>,
) -> Result<ArgMatches, clap::Error> {
    let arguments: Vec<_> = arguments.into_iter().collect();
    match root.has_subcommands() {
        true => root.try_get_matches_from_mut(of_help(arguments)),
        false => root.try_get_matches_from_mut(arguments),
    }
}

/// `command` with a negative number for the value of each option, so that the message about it names the option.
#[must_use]
pub fn options_with_negative_numbers(command: Command) -> Command {
    let negative = |argument: Arg| {
        let is_option = argument.get_action().takes_values() && !argument.is_positional();
        match is_option {
            true => argument.allow_negative_numbers(true),
            false => argument,
        }
    };
    let command = command.mut_args(negative);
    command.mut_subcommands(options_with_negative_numbers)
}

/// `arguments` with the command `help` as the option `--help`. Other ones are as they are.
fn of_help(arguments: Vec<OsString>) -> Vec<OsString> {
    let [program, first, rest @ ..] = &arguments[..] else {
        return arguments;
    };
    let names: Vec<_> = (rest.iter())
        .filter(|name| !["--help", "-h"].map(OsString::from).contains(name))
        .collect();
    match names[..] {
        _ if first != "help" => arguments,
        [] => vec![program.clone(), "--help".into()],
        [name] if !name.to_string_lossy().starts_with('-') && name != "help" => {
            vec![program.clone(), name.clone(), "--help".into()]
        }
        _ => arguments,
    }
}

#[cfg(test)]
mod tests {
    use clap::error::ErrorKind;
    use clap::{Arg, Command, value_parser};

    use super::{matches, of_help, options_with_negative_numbers};

    fn program() -> Command {
        let number = Arg::new("n").long("n").value_parser(value_parser!(u32));
        let inner = Command::new("list").about("Lists all").arg(number.clone());
        let root = Command::new("tool")
            .bin_name("tool")
            .arg(number)
            .subcommand(inner);
        options_with_negative_numbers(root)
    }

    fn error(line: &str) -> (ErrorKind, String) {
        let arguments = line.split(' ').map(Into::into);
        let error = matches(&mut program(), arguments).unwrap_err();
        (error.kind(), error.to_string())
    }

    #[test]
    fn help_takes_the_option_help_and_the_name_of_a_command() {
        for (line, same) in [
            ("tool help", "tool --help"),
            ("tool help --help", "tool --help"),
            ("tool help -h", "tool --help"),
            ("tool help list", "tool list --help"),
            ("tool help list --help", "tool list --help"),
            ("tool help -h list", "tool list --help"),
            ("tool help help", "tool help help"),
            ("tool help list --n", "tool help list --n"),
            ("tool list --help", "tool list --help"),
            ("tool", "tool"),
        ] {
            let arguments = line.split(' ').map(Into::into);
            assert_eq!(of_help(arguments.collect()).join(" ".as_ref()), same);
        }
    }

    #[test]
    fn help_of_an_unknown_command_is_told_as_that_command() {
        let (kind, said) = error("tool help lst");
        assert_eq!(kind, ErrorKind::InvalidSubcommand, "{said}");
        assert!(said.contains("'lst'"), "{said}");
    }

    #[test]
    fn option_with_a_negative_number_is_named() {
        for line in ["tool --n -5", "tool list --n -5"] {
            let (kind, said) = error(line);
            assert_eq!(kind, ErrorKind::ValueValidation, "{line}: {said}");
            assert!(said.contains("'-5' for '--n"), "{line}: {said}");
        }
    }
}
