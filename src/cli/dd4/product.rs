//! Flags that say what is made of the diagram.

use std::fmt;
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};

use crate::cells4::Point4;
use crate::convert::Format;
use crate::dd4::{Form, write_diagram, write_simplices, write_slice, write_surface, write_values};
use crate::diagram4::Diagram;
use crate::error::{Error, Result};
use crate::output::Output;
use crate::source::points4::{From4, Request, Selection, Spacing, read_points4};
use crate::spacetime::{Interpolator, Rule, Slice, isosurface, slice, subdivide};

/// Examples for the end of the help.
pub const EXAMPLES: &str = "\
  Simplices, for programs that take nothing else:
    dd4 heart.spm --triangulate canonical -o simplices.spm
  Values between the points, at two sites and at those of a file:
    dd4 heart.txt --at 12.5,30,8,3.25 --at 12.5,30,8,3.5
    dd4 heart.txt --at-file sites.txt -o values.tsv
  The volume half way between two time steps, and a surface in it:
    dd4 heart.txt --slice 3.5 -o half.vtu
    dd4 heart.txt --slice 3.5 --isosurface 0.4 -o half.ply";

/// What is written: the cells of the diagram, unless something else is asked for.
#[derive(Debug, Clone, Default, Args)]
#[command(next_help_heading = "Products")]
pub struct ProductFlags {
    /// Write simplices instead of cells: each cell as cones from its lexicographically greatest vertices (canonical), or
    /// as cones from the barycentres of all faces that are no simplices (barycentric), where values are means
    #[arg(long, value_enum, value_name = "canonical|barycentric", hide_possible_values = true, conflicts_with_all = ["at", "at_file", "slice"])]
    triangulate: Option<TriangulateFlag>,

    /// Write the value at a site, interpolated, as a line of x y z t value; nan outside of the points' convex hull. May
    /// be given several times
    #[arg(long, value_name = "X,Y,Z,T", allow_hyphen_values = true, value_parser = parse_site, conflicts_with = "slice")]
    at: Vec<Point4>,

    /// The same at the sites of a file with lines of x y z t
    #[arg(long, value_name = "FILE", conflicts_with = "slice")]
    at_file: Option<PathBuf>,

    /// Write the tetrahedra that a time cuts out of the diagram, with interpolated values: VTU, or Medit by the name of
    /// the output (.mesh)
    #[arg(long, value_name = "T", allow_hyphen_values = true, value_parser = parse_finite)]
    slice: Option<f64>,

    /// Write the surface of this value in the slice, facing where values are less: PLY, or by the name of the output OBJ,
    /// VTU or Medit (.obj, .vtu, .mesh)
    #[arg(long, value_name = "V", allow_hyphen_values = true, value_parser = parse_finite, requires = "slice")]
    isosurface: Option<f64>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum TriangulateFlag {
    /// Vertices are pulled
    Canonical,
    /// Barycentres are added
    Barycentric,
}

/// What is made of a diagram.
#[derive(Debug, Clone, PartialEq)]
pub enum Product {
    /// Its cells.
    Cells,
    /// Simplices.
    Simplices(Rule),
    /// Values at sites.
    Values(Vec<Point4>),
    /// Tetrahedra at a time.
    Slice(f64),
    /// A surface of equal value at a time.
    Isosurface {
        /// The time.
        time: f64,
        /// The value.
        level: f64,
    },
}

impl ProductFlags {
    /// What is asked for. Reads the sites of `--at-file`, so that a mistake there is found before the work.
    ///
    /// # Errors
    /// If that file cannot be read.
    pub fn product(&self) -> Result<Product> {
        let rule = self.triangulate.map(|flag| match flag {
            TriangulateFlag::Canonical => Rule::Pulled,
            TriangulateFlag::Barycentric => Rule::Barycentric,
        });
        if !self.at.is_empty() || self.at_file.is_some() {
            let mut sites = self.at.clone();
            sites.extend(self.at_file.as_deref().map(read_sites).transpose()?.unwrap_or_default());
            return Ok(Product::Values(sites));
        }
        Ok(match (rule, self.slice, self.isosurface) {
            (Some(rule), ..) => Product::Simplices(rule),
            (None, Some(time), Some(level)) => Product::Isosurface { time, level },
            (None, Some(time), None) => Product::Slice(time),
            (None, None, _) => Product::Cells,
        })
    }
}

/// The flags as they could be given.
impl fmt::Display for ProductFlags {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut flags = Vec::new();
        flags.extend(self.triangulate.map(|flag| match flag {
            TriangulateFlag::Canonical => "--triangulate canonical".to_string(),
            TriangulateFlag::Barycentric => "--triangulate barycentric".to_string(),
        }));
        flags.extend(self.at.iter().map(|[x, y, z, t]| format!("--at {x},{y},{z},{t}")));
        flags.extend(self.at_file.as_ref().map(|path| format!("--at-file {}", path.display())));
        flags.extend(self.slice.map(|time| format!("--slice {time}")));
        flags.extend(self.isosurface.map(|level| format!("--isosurface {level}")));
        f.write_str(&flags.join(" "))
    }
}

impl Product {
    /// Whether it needs values of the points.
    #[must_use]
    pub fn needs_values(&self) -> bool {
        matches!(self, Product::Values(_) | Product::Isosurface { .. })
    }

    /// The form of a mesh in space of this name.
    fn form(&self, path: &Path) -> Result<Form> {
        let usual = if matches!(self, Product::Slice(_)) { Form::Vtu } else { Form::Ply };
        match Format::from_path(path) {
            None => Ok(usual),
            Some(Format::Vtu) => Ok(Form::Vtu),
            Some(Format::Medit) => Ok(Form::Medit),
            Some(Format::Ply) => Ok(Form::Ply),
            Some(Format::Obj) => Ok(Form::Obj),
            Some(other) => Err(Error::usage(format!(
                "{}: meshes in space cannot be written as {}: the output must be .vtu, .mesh, or for surfaces .ply or .obj",
                path.display(),
                other.name()
            ))),
        }
    }

    /// Whether what goes to a path is binary.
    fn is_binary(&self, path: &Path) -> Result<bool> {
        Ok(match self {
            Product::Cells | Product::Simplices(_) => true,
            Product::Values(_) => false,
            Product::Slice(_) | Product::Isosurface { .. } => {
                matches!(self.form(path)?, Form::Vtu | Form::Ply)
            }
        })
    }

    /// The output at a path, refused early where it cannot be.
    ///
    /// # Errors
    /// Usage, if the name asks for another format, or what is binary would go to a terminal; I/O.
    pub fn create(&self, path: &Path) -> Result<Output> {
        Output::create(path, self.is_binary(path)?)
    }
}

/// What a product came to.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Written {
    /// Bytes.
    pub bytes: u64,
    /// What the user should know.
    pub notices: Vec<String>,
}

/// Makes a product of a diagram and writes it to an output that [`Product::create`] made for `path`.
///
/// # Errors
/// Usage, if values are needed and the points have none, the slice is at a time before or after all points, or the name
/// of the output asks for a format that does not hold the product; I/O. Then there is no output.
pub fn write(product: &Product, diagram: &Diagram, path: &Path, mut output: Output) -> Result<Written> {
    let notices = match product {
        Product::Cells => {
            return write_diagram(diagram, output).map(|bytes| Written { bytes, notices: Vec::new() });
        }
        Product::Simplices(rule) => {
            let (points, values) = (&diagram.points, diagram.values.as_deref());
            let parts = subdivide(points, values, &diagram.cells, *rule, |_| true)?;
            write_simplices(&parts, diagram.merged, &mut output)?;
            flat_notice(parts.flat).into_iter().collect()
        }
        Product::Values(sites) => {
            let values = interpolate(diagram, sites)?;
            write_values(sites, &values, &mut output)?;
            outside_notice(&values).into_iter().collect()
        }
        Product::Slice(time) => {
            let slice = slice(diagram, *time)?;
            let mut notices = slice_notices(&slice);
            notices.extend(write_slice(&slice, product.form(path)?, &mut output)?);
            notices
        }
        Product::Isosurface { time, level } => {
            let slice = slice(diagram, *time)?;
            let surface = isosurface(&slice, *level)?;
            let mut notices = slice_notices(&slice);
            if surface.triangles.is_empty() && !slice.tetrahedra.is_empty() {
                notices.push(empty_notice(&slice, *level));
            }
            write_surface(&surface, product.form(path)?, &mut output)?;
            notices
        }
    };
    let bytes = output.bytes_written();
    output.commit()?;
    Ok(Written { bytes, notices })
}

fn interpolate(diagram: &Diagram, sites: &[Point4]) -> Result<Vec<Option<f64>>> {
    let mut interpolator = Interpolator::new(diagram)?;
    sites.iter().map(|&site| interpolator.value(site)).collect()
}

fn flat_notice(flat: u64) -> Option<String> {
    (flat > 0).then(|| format!("{flat} simplices are flat, because barycentres are rounded: left out"))
}

fn outside_notice(values: &[Option<f64>]) -> Option<String> {
    let outside = values.iter().filter(|value| value.is_none()).count();
    let verb = if outside == 1 { "is" } else { "are" };
    let message = "outside of the convex hull of the points: nan";
    (outside > 0).then(|| format!("{outside} of {} sites {verb} {message}", values.len()))
}

fn slice_notices(slice: &Slice) -> Vec<String> {
    let is_empty = slice.tetrahedra.is_empty();
    let empty =
        is_empty.then(|| format!("the slice is empty: the points span no volume at time {}", slice.time));
    empty.into_iter().chain(flat_notice(slice.flat)).collect()
}

fn empty_notice(slice: &Slice, level: f64) -> String {
    let values = slice.values.iter().flatten().filter(|value| !value.is_nan());
    let range = values.fold(None, |range: Option<(f64, f64)>, &value| {
        Some(range.map_or((value, value), |(least, most)| (least.min(value), most.max(value))))
    });
    match range {
        Some((least, most)) => {
            format!("the surface is empty: values in the slice go from {least} to {most}, not across {level}")
        }
        None => "the surface is empty: no values in the slice are known".into(),
    }
}

fn read_sites(path: &Path) -> Result<Vec<Point4>> {
    // All sites count, whatever else stands in their lines.
    let selection = Selection { keep_nan: true, ..Selection::default() };
    let from = From4::File(path.to_path_buf());
    let request = Request { from, spacing: Spacing::Index, selection, temp_dir: None };
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
            ("--slice -0.5", Product::Slice(-0.5)),
            ("--slice 3 --isosurface -2", Product::Isosurface { time: 3.0, level: -2.0 }),
        ];
        for (text, product) in cases {
            let flags = flags(&text.split_whitespace().collect::<Vec<_>>()).unwrap();
            assert_eq!((flags.to_string(), flags.product().unwrap()), (text.to_string(), product));
        }
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
        assert!(flags(&["--at-file", "/nonexistent/sites"]).unwrap().product().is_err());
    }
}
