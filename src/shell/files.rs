//! The files of a command line: no output may replace an input, be another output, or be a pipe that is read.

use std::any::TypeId;
use std::path::{Path, PathBuf};

use clap::parser::ValueSource;
use clap::{Arg, ArgMatches, Command};

use spmesh_base::error::Result;
use spmesh_base::places::check_apart;

/// Flags that name outputs, in all programs. Every other path is an input, or a folder.
const OUTPUTS: [&str; 7] = ["output", "report", "plan", "residuals", "rejected", "summary", "json"];

/// Whether an argument has its default value, and one is given that does not go with it.
fn is_idle(argument: &Arg, command: &Command, matches: &ArgMatches) -> bool {
    let is_given =
        |other: &Arg| matches.value_source(other.get_id().as_str()) == Some(ValueSource::CommandLine);
    let excludes = |one: &Arg, other: &Arg| {
        command.get_arg_conflicts_with(one).iter().any(|conflict| conflict.get_id() == other.get_id())
    };
    let is_excluded = |other: &Arg| excludes(argument, other) || excludes(other, argument);
    !is_given(argument) && command.get_arguments().any(|other| is_given(other) && is_excluded(other))
}

/// Checks the paths of a command line against each other, before anything is opened. Files that it does not
/// show, such as those beside an input, are checked when they are opened (see [`spmesh_base::inputs`]).
///
/// # Errors
/// As [`check_apart`].
pub(super) fn check(command: &Command, matches: &ArgMatches) -> Result<()> {
    if let Some((name, matches)) = matches.subcommand() {
        return command.find_subcommand(name).map_or(Ok(()), |command| check(command, matches));
    }
    let (mut inputs, mut outputs) = (Vec::new(), Vec::new());
    for argument in command.get_arguments() {
        let is_path = argument.get_value_parser().type_id() == TypeId::of::<PathBuf>();
        if !is_path || is_idle(argument, command, matches) {
            continue;
        }
        let paths = matches.get_raw(argument.get_id().as_str()).into_iter().flatten().map(Path::new);
        match argument.get_long().and_then(|long| OUTPUTS.iter().find(|&&flag| flag == long)) {
            Some(flag) => outputs.extend(paths.map(|path| (format!("--{flag}"), path))),
            None => inputs.extend(paths),
        }
    }
    let outputs: Vec<_> = outputs.iter().map(|(flag, path)| (flag.as_str(), *path)).collect();
    check_apart(inputs, &outputs)
}
