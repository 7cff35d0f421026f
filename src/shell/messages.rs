//! Texts for people: messages and tables on stderr, help and versions on stdout. Control characters of file
//! names and inputs are escaped here, because a terminal would obey them.

use std::ffi::{OsStr, OsString};
use std::io::Write;
use std::process::ExitCode;

use clap::Parser;

use super::{Common, files};
use spmesh_base::error::{Error, ErrorKind, Result};
use spmesh_base::output::open_stdout;
use spmesh_base::upstream;

/// Tools whose output is a stream, in whatever way they are called.
const STREAM_WRITERS: [&str; 4] = ["spfinalize", "spdelaunay2d", "spdelaunay3d", "configgen"];

/// Prints a message for the user on stderr, with the tool's name before it.
pub fn notice(tool: &str, common: &Common, message: &str) {
    if !common.quiet {
        say_line(&format!("{tool}: {message}"));
    }
}

/// Prints lines on stderr. Unlike `eprint!`, it does not panic if stderr is closed.
pub fn say(lines: &str) {
    let _ = std::io::stderr().write_all(escaped_lines(lines).as_bytes());
}

/// Prints one line on stderr.
pub fn say_line(text: &str) {
    let _ = std::io::stderr().write_all(format!("{}\n", escaped(text)).as_bytes());
}

/// Prints the error that ends a run, and returns the exit code; passes both on along a pipe. The end of a pipe
/// is no news.
pub fn fail(tool: &str, error: &anyhow::Error) -> ExitCode {
    let code = error.downcast_ref::<Error>().map_or(1, Error::exit_code);
    if code == ErrorKind::ClosedPipe.exit_code() {
        return ExitCode::from(code);
    }
    // The program before this one in the pipe has said what is wrong.
    let upstream = upstream::failure();
    if upstream.is_none() {
        say_line(&format!("{tool}: {error:#}"));
    }
    let code = upstream.unwrap_or(code);
    if code == ErrorKind::Salvaged.exit_code() {
        upstream::output_is_whole();
    }
    let arguments: Vec<OsString> = std::env::args_os().collect();
    expect_output(tool, &arguments);
    upstream::mark_failure(code);
    ExitCode::from(code)
}

/// Parses the command line. If the run ends here, after help, a version or wrong usage, returns the exit code.
pub fn parse<Flags: Parser>(arguments: &[OsString]) -> std::result::Result<Flags, ExitCode> {
    let mut command = Flags::command();
    let parsed = command.try_get_matches_from_mut(arguments).and_then(|mut matches| {
        let checked = files::check(&command, &matches);
        let flags = Flags::from_arg_matches_mut(&mut matches).map_err(|e| e.format(&mut command))?;
        Ok((flags, checked))
    });
    let message = match parsed {
        Ok((flags, Ok(()))) => return Ok(flags),
        Ok((_, Err(error))) => return Err(fail(command.get_name(), &error.into())),
        // Messages repeat arguments.
        Err(message) => Flags::try_parse_from(arguments.iter().map(|argument| printable(argument)))
            .err()
            .unwrap_or(message),
    };
    if message.use_stderr() {
        let _ = message.print();
        expect_output(Flags::command().get_name(), arguments);
        upstream::mark_failure(ErrorKind::Usage.exit_code());
        return Err(ExitCode::from(ErrorKind::Usage.exit_code()));
    }
    match print_help(&message) {
        Ok(()) => Err(ExitCode::SUCCESS),
        Err(error) => Err(fail(Flags::command().get_name(), &error.into())),
    }
}

/// Marks a failure on stdout if the tool would have written a stream there.
fn expect_output(tool: &str, arguments: &[OsString]) {
    let is_output = |argument: &OsString| {
        let text = argument.to_string_lossy();
        text.starts_with("--output") || text.starts_with("-o")
    };
    if STREAM_WRITERS.contains(&tool) && !arguments.iter().any(is_output) {
        upstream::expect_binary_stdout();
    }
}

/// Prints help or a version on stdout.
fn print_help(text: &clap::Error) -> Result<()> {
    let mut stdout = open_stdout()?;
    let printed = text.print().and_then(|()| stdout.flush());
    printed.map_err(|e| Error::io("printing", e).of_input("stdout"))
}

/// The argument without control characters.
fn printable(argument: &OsStr) -> OsString {
    match argument.to_str() {
        Some(text) if !text.contains(is_obeyed) => argument.to_os_string(),
        _ => escaped(&argument.to_string_lossy()).into(),
    }
}

/// Whether a terminal obeys the character instead of showing it: control characters, marks that change the
/// direction of text, and separators of lines.
fn is_obeyed(char: char) -> bool {
    char.is_control()
        || matches!(char, '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// One line of text for a terminal.
pub fn escaped(text: &str) -> String {
    escaped_but(text, None)
}

/// Lines of text for a terminal.
pub fn escaped_lines(text: &str) -> String {
    escaped_but(text, Some('\n'))
}

fn escaped_but(text: &str, kept: Option<char>) -> String {
    let mut plain = String::with_capacity(text.len());
    for char in text.chars() {
        if is_obeyed(char) && Some(char) != kept {
            plain.extend(char.escape_default());
        } else {
            plain.push(char);
        }
    }
    plain
}

/// JSON for a terminal. serde leaves some control characters as they are; they only occur in strings.
pub fn escaped_json(json: &str) -> String {
    let mut plain = String::with_capacity(json.len());
    for char in json.chars() {
        if is_obeyed(char) && char != '\n' {
            plain += &format!("\\u{:04x}", u32::from(char));
        } else {
            plain.push(char);
        }
    }
    plain
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_terminal_obeys_is_escaped() {
        let text = "a\u{1b}[31m\u{7}\u{9b}2J\u{7f}\u{202e}b\n\tMünchen";
        assert_eq!(escaped(text), "a\\u{1b}[31m\\u{7}\\u{9b}2J\\u{7f}\\u{202e}b\\n\\tMünchen");
        assert_eq!(escaped_lines("a\nb\r\n"), "a\nb\\r\n");
    }

    #[test]
    fn escaped_json_means_the_same() {
        let value = serde_json::json!({"crs": "a\u{1b}\u{7f}\u{9b}\u{2028}\n\"é"});
        let text = escaped_json(&value.to_string());
        assert!(!text.contains(is_obeyed), "{text}");
        assert_eq!(serde_json::from_str::<serde_json::Value>(&text).unwrap(), value);
    }
}
