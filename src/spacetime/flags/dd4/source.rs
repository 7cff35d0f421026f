//! Flags for the input and the selection of points.

use std::fmt;
use std::path::{Path, PathBuf};

use clap::Args;

use spmesh_base::error::{Error, Result};
use spmesh_formats::volumes::{
    Condition, From4, RawLayout, Request, Selected4, Selection, Share, Spacing, parse_sizes, read_points4,
};
use spmesh_shell::{named, refuse_terminal};

/// Examples for the end of the help.
pub const EXAMPLES: &str =
    "  Two fifths of the points of a grid of 16 sites along each axis, always the same ones:
    dd4 --grid 16x16x16x16 --sample 0.4 --seed 7 -o grid.spm
  Where a series of volumes is brighter than 0.3, in its second half:
    dd4 heart.nrrd --where 'value > 0.3 and t >= 10' -o heart.spm
  100,000 of those points; values without a header, 20 time steps of 64 x 64 x 64:
    dd4 heart.raw --raw 64x64x64x20:f32le --where 'value > 0.3' --count 100000 -o heart.spm
  In the units of the header, such as mm and s, where things move about 3 mm/s; a surface at 4.5 s:
    dd4 heart.nii --spacing world --time-scale 3 --slice 4.5 --isosurface 0.4 -o heart.ply";

/// The input and the selection of points.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Points")]
pub struct SourceFlags {
    /// Points or a volume, plain or compressed (.gz); - is stdin. Lines of x y z t, or of x y z t value; NRRD
    /// (.nrrd, .nhdr) or NIfTI-1 (.nii) of three dimensions and time; spmesh streams in four dimensions
    #[arg(value_name = "FILE", help_heading = None)]
    input: Option<PathBuf>,

    /// A full grid of so many points along x, y, z and t, instead of a file; coordinates start at 0
    #[arg(long, value_name = "XxYxZxT", conflicts_with_all = ["input", "raw"], value_parser = parse_sizes)]
    grid: Option<[u64; 4]>,

    /// The file holds nothing but the values of a volume, x fastest: sizes, and a type of i8, u8, i16, u16,
    /// i32, u32, i64, u64, f32 or f64 with its byte order, as in 64x64x64x20:f32le
    #[arg(long, value_name = "XxYxZxT:TYPE", requires = "input")]
    raw: Option<RawLayout>,

    /// Coordinates of a volume: grid indices from 0, or what its header states (world), in its units and
    /// rounded. The grid may be oblique if its axes are perpendicular: a stream then holds distances along
    /// them
    #[arg(long, default_value = "index", value_name = "index|world", hide_possible_values = true)]
    #[arg(value_parser = named(&[("index", Spacing::Index), ("world", Spacing::World)]))]
    spacing: Spacing,

    /// Only points that fulfil a condition: <, <=, >, >=, == or != between numbers and value, x, y, z, t,
    /// joined by and, or, and parentheses
    #[arg(long = "where", value_name = "CONDITION")]
    condition: Option<Condition>,

    /// Keep points whose value is missing (NaN); no comparison with NaN is true
    #[arg(long)]
    keep_nan: bool,

    /// Only this part of the points, between 0 and 1, chosen at random; the number is rounded
    #[arg(long, value_name = "SHARE", conflicts_with = "count", allow_negative_numbers = true, value_parser = parse_share)]
    sample: Option<f64>,

    /// Only so many of the points, chosen at random
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    count: Option<u64>,

    /// Seed of --sample and --count: the same seed chooses the same points
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
}

impl SourceFlags {
    /// Reads the selected points, with spools in a folder, for a diagram that may have to be in memory.
    ///
    /// # Errors
    /// As [`read_points4`]; usage, if there is no input, or stdin is a terminal.
    pub fn read(&self, temp_dir: Option<PathBuf>, in_memory: bool) -> Result<Selected4> {
        read_points4(&Request { temp_dir, in_memory, ..self.request()? })
    }

    /// The input, if it is not a grid.
    pub(super) fn file(&self) -> Option<&Path> {
        self.input.as_deref()
    }

    /// Whether points come from stdin.
    pub(super) fn is_stdin(&self) -> bool {
        self.file().is_some_and(|path| path.as_os_str() == "-")
    }

    fn request(&self) -> Result<Request> {
        let from = match (&self.input, self.grid, self.raw) {
            (_, Some(lens), _) => From4::Grid(lens),
            (Some(path), _, Some(layout)) => From4::Raw(path.clone(), layout),
            (Some(path), _, None) => From4::File(path.clone()),
            (None, None, _) => {
                return Err(Error::usage("no input: give a file, - for stdin, or --grid (see --help)"));
            }
        };
        if let From4::File(path) | From4::Raw(path, _) = &from
            && path.as_os_str() == "-"
        {
            refuse_terminal()?;
        }
        let share = self.sample.map(Share::Part).or(self.count.map(Share::Count));
        let condition = self.condition.clone();
        let selection = Selection { condition, keep_nan: self.keep_nan, share, seed: self.seed };
        Ok(Request { from, spacing: self.spacing, selection, temp_dir: None, in_memory: true })
    }
}

/// The flags without the file, as a user would type them.
impl fmt::Display for SourceFlags {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut flags = Vec::new();
        flags.extend(self.grid.map(|[x, y, z, t]| format!("--grid {x}x{y}x{z}x{t}")));
        flags.extend(self.raw.map(|layout| format!("--raw {layout}")));
        flags.extend((self.spacing == Spacing::World).then(|| "--spacing world".to_string()));
        flags.extend(self.condition.as_ref().map(|condition| format!("--where '{condition}'")));
        flags.extend(self.keep_nan.then(|| "--keep-nan".to_string()));
        if let Some(share) = self.sample.map(Share::Part).or(self.count.map(Share::Count)) {
            flags.push(format!("{share} --seed {}", self.seed));
        }
        f.write_str(&flags.join(" "))
    }
}

fn parse_share(text: &str) -> std::result::Result<f64, String> {
    let share = text.parse().ok().filter(|share| *share > 0.0 && *share <= 1.0);
    share.ok_or_else(|| {
        format!("{text:?} is not a share above 0 and up to 1; for a number of points use --count")
    })
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    use super::*;

    #[derive(Debug, Parser)]
    struct Flags {
        #[command(flatten)]
        source: SourceFlags,
    }

    fn flags(arguments: &[&str]) -> std::result::Result<SourceFlags, clap::Error> {
        let program = std::iter::once(&"dd4");
        Flags::try_parse_from(program.chain(arguments)).map(|flags| flags.source)
    }

    #[test]
    fn flags_are_read_and_written() {
        for text in [
            "",
            "--grid 16x16x16x16 --sample 0.4 --seed 7",
            "--raw 64x64x64x20:f32le --where 'value>0.3' --keep-nan --count 100000 --seed 1",
            "--spacing world",
        ] {
            let mut arguments: Vec<String> =
                text.split_whitespace().map(|word| word.replace('\'', "")).collect();
            if !text.starts_with("--grid") {
                arguments.push("volume".to_string());
            }
            let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
            assert_eq!(flags(&arguments).unwrap().to_string(), text);
        }
    }

    #[test]
    fn the_points_of_a_grid_are_made() {
        let points = flags(&["--grid", "4x4x4x4", "--sample", "0.4", "--seed", "7"])
            .unwrap()
            .read(None, true)
            .unwrap();
        assert_eq!(points.points.len(), 102);
        assert_eq!(points.name, "grid 4x4x4x4");
    }

    #[test]
    fn what_does_not_go_together_is_refused() {
        let cases: [(&[&str], &str); 11] = [
            (&["--grid", "4x4x4x4", "points.txt"], "cannot be used"),
            (&["--raw", "4x4x4x4:u8"], "FILE"),
            (&["--grid", "4x4x4"], "16x16x16x16"),
            (&["a", "--sample", "0.5", "--count", "5"], "cannot be used"),
            (&["a", "--sample", "0"], "use --count"),
            (&["a", "--sample", "1.5"], "use --count"),
            (&["a", "--sample", "nan"], "use --count"),
            (&["a", "--count", "0"], "0 is not in"),
            (&["a", "--where", "value >"], "column 8"),
            (&["a", "--raw", "4x4x4x4:f32"], "f32le"),
            (&["a", "--spacing", "metric"], "metric"),
        ];
        for (arguments, part) in cases {
            let error = flags(arguments).unwrap_err().to_string();
            assert!(error.contains(part), "{arguments:?}: {error}");
        }
        assert!(flags(&[]).unwrap().read(None, true).unwrap_err().to_string().contains("no input"));
    }
}
