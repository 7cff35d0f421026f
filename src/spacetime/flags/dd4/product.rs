//! Flags for the product of the diagram.

use std::fmt;
use std::path::{Path, PathBuf};

use clap::Args;

use crate::dd4::Product;
use crate::slices::Rule;
use spmesh_base::error::{Error, Result};
use spmesh_formats::drivers::Format;
use spmesh_formats::volumes::{From4, Request, Selection, Spacing, read_points4};
use spmesh_shell::{Names, named, value_name};
use spmesh_stream::model::cells4::Point4;

/// Examples for the end of the help.
pub const EXAMPLES: &str = "  Simplices, for programs that take nothing else:
    dd4 heart.spm --triangulate canonical -o simplices.spm
  Values between the points, at two sites and at those of a file:
    dd4 heart.txt --at 12.5,30,8,3.25 --at 12.5,30,8,3.5
    dd4 heart.txt --at-file sites.txt -o values.tsv
  The volume half way between two time steps, and a surface in it:
    dd4 heart.txt --slice 3.5 -o half.vtu
    dd4 heart.txt --slice 3.5 --isosurface 0.4 -o half.ply";

/// The output: the cells of the diagram by default.
#[derive(Debug, Clone, Default, Args)]
#[command(next_help_heading = "Products")]
pub struct ProductFlags {
    /// Write simplices instead of cells: each cell as cones from its lexicographically greatest vertices
    /// (canonical), or as cones from the barycentres of all faces that are no simplices (barycentric), where
    /// values are means; these are not Delaunay
    #[arg(long, value_name = "canonical|barycentric", hide_possible_values = true)]
    #[arg(value_parser = named(RULES))]
    #[arg(conflicts_with_all = ["at", "at_file", "slice"])]
    triangulate: Option<Rule>,

    /// Write the value at a site, interpolated, as a line of x y z t value; nan outside of the points' convex
    /// hull. May be given several times
    #[arg(long, value_name = "X,Y,Z,T", allow_hyphen_values = true, value_parser = parse_site, conflicts_with = "slice")]
    at: Vec<Point4>,

    /// The same at the sites of a file with lines of x y z t
    #[arg(long, value_name = "FILE", conflicts_with = "slice")]
    at_file: Option<PathBuf>,

    /// Write the tetrahedra that a time cuts out of the diagram, with interpolated values: VTU, or Medit by
    /// the name of the output (.mesh)
    #[arg(long, value_name = "T", allow_hyphen_values = true, value_parser = parse_finite)]
    slice: Option<f64>,

    /// Write the surface of this value in the slice, facing lower values: PLY, or by the name of the
    /// output OBJ, VTU or Medit (.obj, .vtu, .mesh)
    #[arg(long, value_name = "V", allow_hyphen_values = true, value_parser = parse_finite, requires = "slice")]
    isosurface: Option<f64>,
}

/// How faces that are no simplices are divided.
const RULES: Names<Rule> = &[("canonical", Rule::Pulled), ("barycentric", Rule::Barycentric)];

impl ProductFlags {
    /// The file of sites.
    pub(super) fn file(&self) -> Option<&Path> {
        self.at_file.as_deref()
    }

    /// Whether sites come from stdin.
    pub(super) fn reads_stdin(&self) -> bool {
        self.file().is_some_and(|path| path.as_os_str() == "-")
    }

    /// Whether the product is binary. Does not read sites.
    pub(super) fn is_binary(&self, output: &Path) -> Result<bool> {
        let has_sites = self.at_file.is_some();
        Ok(!has_sites && self.product(output)?.is_binary())
    }

    /// The requested product, for an output path. Reads the sites of `--at-file`, so that a mistake there is
    /// found before the computation.
    ///
    /// # Errors
    /// If that file cannot be read; usage, if the format of the path cannot hold the product.
    pub fn product(&self, output: &Path) -> Result<Product> {
        if !self.at.is_empty() || self.at_file.is_some() {
            let mut sites = self.at.clone();
            sites.extend(self.at_file.as_deref().map(read_sites).transpose()?.unwrap_or_default());
            return Ok(Product::Values(sites));
        }
        if self.slice.is_none() {
            check_stream(output)?;
        }
        Ok(match (self.triangulate, self.slice, self.isosurface) {
            (Some(rule), ..) => Product::Simplices(rule),
            (None, Some(time), Some(level)) => {
                Product::Isosurface { time, level, format: format_of(output, true)? }
            }
            (None, Some(time), None) => Product::Slice { time, format: format_of(output, false)? },
            (None, None, _) => Product::Cells,
        })
    }
}

/// The flags as a user would type them.
impl fmt::Display for ProductFlags {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut flags = Vec::new();
        flags.extend(self.triangulate.map(|rule| format!("--triangulate {}", value_name(RULES, &rule))));
        flags.extend(self.at.iter().map(|[x, y, z, t]| format!("--at {x},{y},{z},{t}")));
        flags.extend(self.at_file.as_ref().map(|path| format!("--at-file {}", path.display())));
        flags.extend(self.slice.map(|time| format!("--slice {time}")));
        flags.extend(self.isosurface.map(|level| format!("--isosurface {level}")));
        f.write_str(&flags.join(" "))
    }
}

/// Refuses output names of formats that cannot hold cells of four dimensions.
fn check_stream(path: &Path) -> Result<()> {
    match Format::from_path(path) {
        None | Some(Format::Stream) => Ok(()),
        Some(other) => Err(Error::usage(format!(
            "{}: what is in four dimensions is written as a stream (.spm), not as {}: for a mesh at a time use --slice",
            path.display(),
            other.value()
        ))),
    }
}

/// The format of a mesh in space at a path: given by its name, or the default.
fn format_of(path: &Path, is_surface: bool) -> Result<Format> {
    match Format::from_path(path) {
        None => Ok(if is_surface { Format::Ply } else { Format::VtkXml }),
        Some(format @ (Format::VtkXml | Format::Medit)) => Ok(format),
        Some(format @ (Format::Ply | Format::Obj)) if is_surface => Ok(format),
        Some(other) => Err(Error::usage(format!(
            "{}: {} cannot be written as {}: the output must be .vtu, .mesh, or for surfaces .ply or .obj",
            path.display(),
            if is_surface { "a surface" } else { "a slice" },
            other.value()
        ))),
    }
}

fn read_sites(path: &Path) -> Result<Vec<Point4>> {
    // Keep sites whose value is NaN: only the coordinates of a line count.
    let selection = Selection { keep_nan: true, ..Selection::default() };
    let from = From4::File(path.to_path_buf());
    let request = Request { from, spacing: Spacing::Index, selection, temp_dir: None, in_memory: true };
    read_points4(&request).map(|sites| sites.points)
}

fn parse_site(text: &str) -> std::result::Result<Point4, String> {
    let numbers: Option<Vec<f64>> = text.split(',').map(|x| parse_finite(x.trim()).ok()).collect();
    let site = numbers.and_then(|numbers| Point4::try_from(numbers).ok());
    site.ok_or_else(|| format!("{text:?} is not a site x,y,z,t, as in 12.5,30,8,3.25"))
}

fn parse_finite(text: &str) -> std::result::Result<f64, String> {
    let number = text.parse().ok().filter(|number: &f64| number.is_finite());
    number.ok_or_else(|| format!("{text:?} is not a finite number"))
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    use super::*;

    #[derive(Debug, Parser)]
    struct Flags {
        #[command(flatten)]
        product: ProductFlags,
    }

    fn flags(arguments: &[&str]) -> std::result::Result<ProductFlags, clap::Error> {
        Flags::try_parse_from(std::iter::once(&"dd4").chain(arguments)).map(|flags| flags.product)
    }

    #[test]
    fn flags_are_read_and_written() {
        let cases = [
            ("", Product::Cells),
            ("--triangulate canonical", Product::Simplices(Rule::Pulled)),
            ("--triangulate barycentric", Product::Simplices(Rule::Barycentric)),
            ("--at -1,2.5,0,1 --at 0,0,0,0", Product::Values(vec![[-1.0, 2.5, 0.0, 1.0], [0.0; 4]])),
            ("--slice -0.5", Product::Slice { time: -0.5, format: Format::VtkXml }),
            (
                "--slice 3 --isosurface -2",
                Product::Isosurface { time: 3.0, level: -2.0, format: Format::Ply },
            ),
        ];
        for (text, product) in cases {
            let flags = flags(&text.split_whitespace().collect::<Vec<_>>()).unwrap();
            assert_eq!(
                (flags.to_string(), flags.product(Path::new("-")).unwrap()),
                (text.to_string(), product)
            );
        }
    }

    #[test]
    fn names_choose_forms() {
        let form = |text: &str, name: &str| -> Result<Format> {
            let flags = flags(&text.split_whitespace().collect::<Vec<_>>()).unwrap();
            match flags.product(Path::new(name))? {
                Product::Slice { format, .. } | Product::Isosurface { format, .. } => Ok(format),
                other => panic!("{other:?}"),
            }
        };
        let (slice, surface) = ("--slice 1", "--slice 1 --isosurface 2");
        for (name, of_slice, of_surface) in [
            ("-", Some(Format::VtkXml), Some(Format::Ply)),
            ("a", Some(Format::VtkXml), Some(Format::Ply)),
            ("a.vtu", Some(Format::VtkXml), Some(Format::VtkXml)),
            ("a.mesh", Some(Format::Medit), Some(Format::Medit)),
            ("a.ply", None, Some(Format::Ply)),
            ("a.obj", None, Some(Format::Obj)),
            ("a.spm", None, None),
        ] {
            assert_eq!(form(slice, name).ok(), of_slice, "{name}");
            assert_eq!(form(surface, name).ok(), of_surface, "{name}");
        }
        let message = form(slice, "a.ply").unwrap_err().to_string();
        assert!(
            message.contains("a.ply: a slice cannot be written as") && message.contains(".vtu"),
            "{message}"
        );
    }

    #[test]
    fn what_does_not_go_together_is_refused() {
        let cases: [(&[&str], &str); 7] = [
            (&["--isosurface", "1"], "--slice"),
            (&["--slice", "1", "--at", "0,0,0,0"], "cannot be used"),
            (&["--slice", "1", "--triangulate", "canonical"], "cannot be used"),
            (&["--at", "1,2,3"], "12.5,30,8,3.25"),
            (&["--at", "1,2,3,inf"], "12.5,30,8,3.25"),
            (&["--slice", "nan"], "finite"),
            (&["--triangulate", "delaunay"], "delaunay"),
        ];
        for (arguments, part) in cases {
            let error = flags(arguments).unwrap_err().to_string();
            assert!(error.contains(part), "{arguments:?}: {error}");
        }
        for name in ["a.vtu", "a.PLY", "a.txt"] {
            let message = flags(&[]).unwrap().product(Path::new(name)).unwrap_err().to_string();
            assert!(message.contains(name) && message.contains("--slice"), "{message}");
        }
        assert!(flags(&["--at-file", "/nonexistent/sites"]).unwrap().product(Path::new("-")).is_err());
    }
}
