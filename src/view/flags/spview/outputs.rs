//! The outputs of pictures: one file, or numbered files at moments of the stream.

use std::io::Write;
use std::iter;
use std::path::{Path, PathBuf};

use crate::Picture;
use clap::ValueEnum;
use spmesh_base::error::{Error, Result};
use spmesh_base::output::Output;
use spmesh_base::places::check_apart;
use spmesh_shell::{endings, of_ending};

/// The values of `--format`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum Format {
    Svg,
    Png,
    Html,
}

/// The outputs of pictures.
pub(super) struct Outputs {
    format: Format,
    target: Target,
    pictures: u64,
}

enum Target {
    /// One picture. The output is opened before the work, so that a failure shows at once. It gets its name
    /// at the end, when the whole stream has been read.
    One { output: Output, is_written: bool },
    /// Several pictures.
    Numbered { names: Names },
}

/// Names of numbered pictures: the parts before and after the number, and its least number of digits.
struct Names {
    before: String,
    digits: usize,
    after: String,
}

impl Names {
    /// Opens the output of a picture.
    fn create(&self, number: u64, format: Format) -> Result<Output> {
        let Names { before, digits, after } = self;
        let path = PathBuf::from(format!("{before}{number:0digits$}{after}"));
        Output::create(&path, format == Format::Png)
    }
}

impl Outputs {
    /// # Errors
    /// Usage, if the name, the format and the number of pictures do not fit together; if the output cannot be
    /// created.
    pub(super) fn new(
        path: &Path,
        format: Option<Format>,
        is_numbered: bool,
        is_tee: bool,
    ) -> Result<Outputs> {
        let is_stdout = path == Path::new("-");
        if is_tee && is_stdout {
            return Err(Error::usage(
                "--tee passes the stream on to stdout: give the picture a name with -o",
            ));
        }
        let tee = is_tee.then_some(("--tee", Path::new("-")));
        let outputs: Vec<_> = iter::once(("--output", path)).chain(tee).collect();
        check_apart([], &outputs)?;
        if format.is_none() {
            endings::check(path, &[endings::PICTURE])?;
        }
        let format = format.or_else(|| of_ending(ENDINGS, path)).unwrap_or(Format::Svg);
        let target = if is_numbered {
            if is_stdout {
                return Err(Error::usage(
                    "--snapshot makes several pictures: give their names with -o shots/%04d.png",
                ));
            }
            let names = pattern(path)?;
            // A failure of the first picture shows before the work, too.
            drop(names.create(1, format)?);
            Target::Numbered { names }
        } else {
            Target::One { output: Output::create(path, format == Format::Png)?, is_written: false }
        };
        Ok(Outputs { format, target, pictures: 0 })
    }

    /// Writes a picture.
    pub(super) fn put(&mut self, picture: &Picture) -> Result<()> {
        self.pictures += 1;
        match &mut self.target {
            Target::One { is_written: true, .. } => Ok(()),
            Target::One { output, is_written } => {
                *is_written = true;
                write(self.format, picture, output)
            }
            Target::Numbered { names } => {
                let mut output = names.create(self.pictures, self.format)?;
                write(self.format, picture, &mut output)?;
                output.commit()
            }
        }
    }

    /// Completes a single picture when the stream has been read. Returns a message for the user, if there is
    /// one.
    pub(super) fn finish(self) -> Result<Option<String>> {
        match self.target {
            Target::One { output, .. } => output.commit().map(|()| None),
            Target::Numbered { .. } if self.pictures == 1 => Ok(Some("1 picture".to_string())),
            Target::Numbered { .. } => Ok(Some(format!("{} pictures", self.pictures))),
        }
    }
}

fn write(format: Format, picture: &Picture, output: &mut Output) -> Result<()> {
    let failed = |error| Error::io("writing the picture", error);
    match format {
        Format::Svg => output.write_all(picture.svg.as_bytes()).map_err(failed),
        Format::Png => output.write_all(&picture.png()?).map_err(failed),
        Format::Html => picture.html(output),
    }
}

/// The formats that endings of names stand for.
const ENDINGS: &[(&str, Format)] =
    &[("svg", Format::Svg), ("png", Format::Png), ("html", Format::Html), ("htm", Format::Html)];

/// Parses a name with one `%d` or `%04d` in it.
fn pattern(path: &Path) -> Result<Names> {
    let unfit = || {
        let path = path.display();
        Error::usage(format!(
            "{path}: expected a name with one %d or %04d, which stands for the number of the picture"
        ))
    };
    let text = path.to_str().ok_or_else(unfit)?;
    let (before, rest) = text.split_once('%').ok_or_else(unfit)?;
    let (digits, after) = rest.split_once('d').ok_or_else(unfit)?;
    let digits = match digits.strip_prefix('0') {
        None if digits.is_empty() => 1,
        Some(digits) => digits.parse().ok().filter(|digits| (1..=20).contains(digits)).ok_or_else(unfit)?,
        None => return Err(unfit()),
    };
    if after.contains('%') {
        return Err(unfit());
    }
    Ok(Names { before: before.to_string(), digits, after: after.to_string() })
}

/// A moment of a stream.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Moment {
    /// After this part of it, from 0 to 1.
    Part(f64),
    /// After this number of triangles or points.
    Count(u64),
}

/// A number of triangles or points between pictures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Every(pub(super) u64);

/// Parses a moment: an integer is a count, any other number a part.
pub(super) fn parse_moment(text: &str) -> std::result::Result<Moment, String> {
    if let Ok(count) = text.parse() {
        return Ok(Moment::Count(count));
    }
    match text.parse::<f64>() {
        Ok(part) if (0.0..=1.0).contains(&part) => Ok(Moment::Part(part)),
        _ => Err(format!("{text:?} is neither a part between 0.0 and 1.0 nor an integer")),
    }
}

/// Parses `every=N` with N above zero.
pub(super) fn parse_every(text: &str) -> std::result::Result<Every, String> {
    let count = text.strip_prefix("every=").and_then(|count| count.parse().ok());
    count.filter(|&count| count > 0).map(Every).ok_or_else(|| format!("{text:?} is not like every=1000000"))
}
