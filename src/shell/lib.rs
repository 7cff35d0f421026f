//! What every program has: parsed flags, messages, progress, and errors as exit codes. Flags that several
//! programs share are here, too.

pub mod batch;
pub mod cells;
pub mod compression;
pub mod crs;
pub mod endings;
mod files;
mod geotiff;
mod meshes;
pub mod messages;
mod named;
pub mod outline;
pub mod progress;
pub mod resources;
pub mod stats;
pub mod text_flags;

use std::ffi::{OsStr, OsString};
use std::io::{BufRead, BufReader, IsTerminal, Read};
use std::os::unix::ffi::OsStrExt;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{Args, Parser};

use meshes::Source;
pub use meshes::{Mesh, MeshReader, Needs, open_within};
pub use messages::{notice, say};
pub use named::{Names, named, of_ending, value_name};
pub use spmesh_base::allocator::Allocator;
use spmesh_base::error::{Error, ErrorKind};
use spmesh_base::inputs;
use spmesh_base::limits::{LIST_FILES_MAX, TEXT_LINE_MAX};
use spmesh_base::places::check_pipes;
use spmesh_base::system;
pub use spmesh_base::system::peak_memory;
use spmesh_base::temporary::remove_names_at_signals;
use spmesh_formats::detect::BYTE_ORDER_MARK;
use spmesh_formats::source::Plain;
use spmesh_stream::StreamReader;
use spmesh_stream::model::bounds::Bounds;
pub use stats::{Report, StatsFlag};

/// Runs a tool: parses its flags, calls `run`, and turns the result into an exit code and a message.
///
/// A closed output pipe ends the tool silently with 141, as a signal would; wrong usage gives 2.
pub fn main<Flags: Parser>(run: impl FnOnce(Flags) -> anyhow::Result<()>) -> ExitCode {
    system::save_address_space();
    system::report_large_files();
    remove_names_at_signals();
    inputs::watch();
    system::exit_at_abort("not enough memory\n", ErrorKind::Memory.exit_code());
    let arguments = join_stats_format(std::env::args_os());
    let flags: Flags = match messages::parse(&arguments) {
        Ok(flags) => flags,
        Err(code) => return code,
    };
    system::widen_pipe(&std::io::stdin());
    system::widen_pipe(&std::io::stdout());
    match run(flags) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => messages::fail(Flags::command().get_name(), &error),
    }
}

/// From now on, a tool that lacks memory ends with this advice.
pub fn advise_on_memory(tool: &str, advice: &str) {
    let message = format!("{tool}: not enough memory: {advice}\n");
    system::exit_at_abort(message.leak(), ErrorKind::Memory.exit_code());
}

/// Joins `--stats json` into one argument. clap needs `--stats=json`, or it would take the file in `--stats
/// FILE` for a format. Arguments after `--` are files.
fn join_stats_format(arguments: impl Iterator<Item = OsString>) -> Vec<OsString> {
    let mut joined: Vec<OsString> = Vec::new();
    let mut only_files = false;
    for argument in arguments {
        only_files |= argument == "--";
        let is_format = !only_files && (argument == "text" || argument == "json");
        match joined.last_mut() {
            Some(last) if is_format && last == "--stats" => {
                last.push("=");
                last.push(argument);
            }
            _ => joined.push(argument),
        }
    }
    joined
}

/// Flags that every tool has.
#[derive(Debug, Clone, Args)]
pub struct Common {
    /// Print nothing but errors on stderr
    #[arg(short, long, global = true)]
    pub quiet: bool,

    /// Show progress: on a terminal, never, or as JSON lines on stderr. In a pipe, the last program shows it
    #[arg(long, value_enum, default_value_t = progress::When::Auto, global = true)]
    pub progress: progress::When,
}

/// A size with a unit, in bytes: `512M`, `2G`, `65536`. K, M and G are powers of 1024.
///
/// # Errors
/// If it is not a positive number with one of the units.
pub fn parse_size(text: &str) -> Result<u64, String> {
    let digits = text.trim_end_matches(|c: char| c.is_ascii_alphabetic());
    let unit: u64 = match text[digits.len()..].to_ascii_uppercase().as_str() {
        "" | "B" => 1,
        "K" | "KB" | "KIB" => 1 << 10,
        "M" | "MB" | "MIB" => 1 << 20,
        "G" | "GB" | "GIB" => 1 << 30,
        unit => return Err(format!("unknown unit {unit:?}, expected K, M or G")),
    };
    let number: f64 = digits.parse().map_err(|_| format!("{text:?} is not a size like 512M"))?;
    let bytes = number * unit as f64;
    if (1.0..9e18).contains(&bytes) { Ok(bytes as u64) } else { Err(format!("{text:?} is out of range")) }
}

/// Parses `N` numbers, separated by commas.
///
/// # Errors
/// If the number of fields is not `N`, or a field is not a number.
pub fn parse_numbers<const N: usize>(text: &str) -> Result<[f64; N], String> {
    let numbers: Result<Vec<f64>, _> = text.split(',').map(|number| number.trim().parse()).collect();
    let numbers = numbers.map_err(|_| format!("{text:?} are not {N} numbers between commas"))?;
    let found = numbers.len();
    numbers.try_into().map_err(|_| format!("found {found} numbers, expected {N} between commas"))
}

/// Parses a box in space, MINX,MINY,MINZ,MAXX,MAXY,MAXZ, or in the plane, MINX,MINY,MAXX,MAXY; a box in the
/// plane is infinitely high.
///
/// # Errors
/// If the text is anything else.
pub fn parse_box(text: &str) -> Result<Bounds, String> {
    if text.split(',').count() == 6 {
        let [x, y, z, max_x, max_y, max_z] = parse_numbers(text)?;
        return Ok(Bounds { min: [x, y, z], max: [max_x, max_y, max_z] });
    }
    let [x, y, max_x, max_y] =
        parse_numbers(text).map_err(|message| format!("{message}, or 6 with those of z"))?;
    Ok(Bounds::over([x, y], [max_x, max_y]))
}

/// Opens an input that is read in order: stdin for `-`, a file otherwise; with the name that messages use.
/// gzip data is decompressed, and the manifest of a mesh in parts is opened as the mesh.
///
/// # Errors
/// If the file cannot be opened, or stdin is a terminal.
pub fn open_input(path: &Path) -> spmesh_base::error::Result<(Box<dyn Read + Send>, String)> {
    let (source, name) = Source::open(path, Plain::new)?;
    Ok((source.read()?, name))
}

/// Opens a stream, `-` for stdin.
///
/// # Errors
/// As [`open_input`]; if its header is malformed.
pub fn open_stream(path: &Path) -> spmesh_base::error::Result<StreamReader<Box<dyn Read + Send>>> {
    let (input, name) = open_input(path)?;
    StreamReader::new(input, name)
}

/// As [`open_input`], for a program that holds what it reads: see [`Plain::held`].
///
/// # Errors
/// As [`open_input`].
pub fn open_held(path: &Path) -> spmesh_base::error::Result<(Box<dyn Read + Send>, String)> {
    let (source, name) = Source::open(path, Plain::held)?;
    Ok((source.read()?, name))
}

/// The files that `--lof` lists, one per line; empty lines and lines that start with `#` do not
/// count. `-` is stdin.
///
/// # Errors
/// If the list cannot be read, or is no list of at most [`LIST_FILES_MAX`] files; usage, if it lists no file.
pub fn read_list(list: &Path) -> spmesh_base::error::Result<Vec<PathBuf>> {
    let (input, name) = open_held(list)?;
    let files = listed(BufReader::new(input)).map_err(|e| e.of_input(&name))?;
    if files.is_empty() {
        return Err(Error::usage("lists no files").of_input(&name));
    }
    check_pipes(files.iter().map(PathBuf::as_path))?;
    Ok(files)
}

fn listed(mut input: impl BufRead) -> spmesh_base::error::Result<Vec<PathBuf>> {
    let (mut files, mut line) = (Vec::new(), Vec::new());
    for number in 1.. {
        line.clear();
        let mut rest = (&mut input).take(TEXT_LINE_MAX as u64 + 1);
        if rest.read_until(b'\n', &mut line).map_err(|e| Error::io("reading", e))? == 0 {
            break;
        }
        let at = |message: String| Error::malformed(message).at(format!("line {number}"));
        if line.contains(&0) || line.len() > TEXT_LINE_MAX {
            return Err(at("this is no list of files: expected the path of one in each line".to_string()));
        }
        let path = if number == 1 { line.strip_prefix(BYTE_ORDER_MARK).unwrap_or(&line) } else { &line };
        let path = path.trim_ascii();
        if files.len() == LIST_FILES_MAX {
            return Err(at(format!("more than {LIST_FILES_MAX} files: divide the list")));
        }
        if !path.is_empty() && !path.starts_with(b"#") {
            files.push(OsStr::from_bytes(path).into());
        }
    }
    Ok(files)
}

/// Refuses to read from a terminal.
///
/// # Errors
/// Usage, if stdin is one.
pub fn refuse_terminal() -> spmesh_base::error::Result<()> {
    if std::io::stdin().is_terminal() {
        return Err(Error::usage("stdin is a terminal: give a file or pipe a stream in (see --help)"));
    }
    Ok(())
}
