//! `spinfo`: flags.

mod attributes;
mod census;
mod configurations;
mod diagram;
mod report;

use std::io::{BufReader, Write};
use std::path::{Path, PathBuf};

use clap::Parser;

use report::Summary;
use spmesh_audit::configurations::{self as config_audit};
use spmesh_audit::diagram::{self as diagram4, StreamAudit};
use spmesh_audit::{Audit, Census, Counts, Given, Inventory, NearPoints, PointSet, Report, Standard};
use spmesh_base::error::{Error, ErrorKind, Result};
use spmesh_base::output::Output;
use spmesh_formats::detect::SPINFO;
use spmesh_formats::source::{Input, Opened, SourceOptions, open_planar};
use spmesh_shell::messages::escaped_json;
use spmesh_shell::progress::Progress;
use spmesh_shell::{Common, Names, advise_on_memory, named, notice, open_input};
use spmesh_stream::model::bounds::Point;
use spmesh_stream::{Coordinates, Event, Header, Kind, StreamReader, check_part, check_surface};

const INPUT_BUFFER_LEN: usize = 1 << 18;

const EXAMPLES: &str = "\
Examples:
  spinfo mesh.spm                         what is in it
  spfinalize a.laz | spdelaunay2d | spinfo --audit
                                          prove that the mesh is right
  spinfo --audit=delaunay foreign.spm     any Delaunay triangulation will do
  spinfo --audit --points a.laz mesh.spm  and it has exactly these points
  spinfo --audit --within 0.2 --points terrain.spm simple.spm
                                          its vertices are some of these, the others at most 0.2 above or below
  spinfo --audit diagram.spm              prove the cells that dd4 made; they are held in memory
  spinfo --audit configurations.spm       prove circles, facets and counts of configurations; they are held
  spinfo --audit --count-violations tetrahedra.spm
                                          how wrong is it, exactly and in plain floating point
  spinfo --json mesh.spm | jq .counts     for programs

Exit codes: 0 fine, 1 I/O or runtime failure, 2 usage, 3 the stream is malformed or truncated,
4 the audit found a violation, 5 not enough memory, 6 a stream of another version of spmesh, 141 output closed by its reader.";

/// Report what a stream holds, and prove that it is what it claims to be
#[derive(Debug, Parser)]
#[command(name = "spinfo", version, after_help = EXAMPLES)]
pub struct Flags {
    /// Stream to read; - is stdin
    #[arg(value_name = "FILE", default_value = "-")]
    input: PathBuf,

    /// Print one JSON object instead of text
    #[arg(long)]
    json: bool,

    /// Prove the claims of the stream with exact arithmetic; exit 4 at the first violation, 3 if the stream
    /// is malformed. Triangle and tetrahedral meshes are proved as they pass, holding only the live vertices
    /// and the boundary of the mesh so far; of a constrained mesh also its segments, which must be chains of
    /// edges. Cells and simplices of four dimensions and configurations are held whole. In four dimensions
    /// both standards are the same: a Delaunay diagram has no ties to resolve, and its simplices may resolve
    /// ties in any way
    #[arg(
        long,
        value_parser = named(STANDARDS),
        value_name = "STANDARD",
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = "canonical"
    )]
    audit: Option<Standard>,

    /// Also prove that the vertices of the mesh are exactly the points of this file, in any format that
    /// spfinalize reads, with the atoms of PDB and mmCIF; can be repeated. The points are held, with 4 bytes
    /// per integer coordinate and 8 bytes per other one
    #[arg(long, value_name = "FILE", requires = "audit")]
    points: Vec<PathBuf>,

    /// With --points, prove instead that the vertices of the triangle mesh are some of the points, and all
    /// others at most so far above or below its triangles, in the unit of elevations. A triangle mesh stream
    /// can be the points. They are held, with 48 bytes each
    #[arg(long, value_name = "DISTANCE", requires = "points", allow_negative_numbers = true)]
    within: Option<f64>,

    /// Count all violations instead of stopping at the first, both exactly and in plain floating-point
    /// arithmetic; for tetrahedral meshes. Holds 4 bytes per tetrahedron more than the audit, and the edges
    /// and facets between live vertices
    #[arg(long, requires = "audit", conflicts_with = "points")]
    count_violations: bool,

    #[command(flatten)]
    common: Common,
}

/// The standards for the edges or facets of a mesh.
const STANDARDS: Names<Standard> = &[
    (
        "canonical: Interior edges or facets are locally Delaunay, and ties are resolved as spdelaunay2d and tess3 do",
        Standard::Canonical,
    ),
    ("delaunay: Interior edges or facets are locally Delaunay", Standard::Delaunay),
];

/// Reads the stream to its end and prints what it holds.
///
/// # Errors
/// If the stream is malformed, cannot be read, or fails the audit (then the report is printed first).
pub fn run(flags: Flags) -> anyhow::Result<()> {
    advise_on_memory("spinfo", "audit without --points, or audit partial meshes one by one");
    // Fail before the work if stdout is closed.
    let output = Output::create(Path::new("-"), false)?;
    let (input, name) = open_input(&flags.input)?;
    let mut reader = StreamReader::new(BufReader::with_capacity(INPUT_BUFFER_LEN, input), name)?;
    let header = reader.header().clone();
    let mut proof = Proof::of(&flags, &header)?;
    let mut inventory = Inventory::new(&header);
    let mut progress = Progress::new(&flags.common, "reading", header.points);
    let mut failure = None;
    while let Some(event) = reader.next_event()? {
        // The rules of the stream come first: what breaks them is malformed, for an audit as for any reader.
        inventory.event(&event).map_err(|error| reader.locate(error))?;
        if let Err(error) = proof.event(&event, reader.rows(), &header) {
            if error.kind() != ErrorKind::Audit {
                return Err(error.of_input(reader.name()).into());
            }
            failure = Some(reader.locate(error));
            break;
        }
        progress.set(inventory.totals().points.max(inventory.totals().vertices));
    }
    drop(progress);
    let mut failure = failure.or_else(|| Some(proof.verdict()?.of_input(reader.name())));
    if let Some(error) = failure.take_if(|error| error.kind() != ErrorKind::Audit) {
        return Err(error.into());
    }
    let summary = Summary {
        name: reader.name(),
        header: &header,
        inventory: &inventory,
        audit: proof.report(),
        census: proof.counts(),
        diagram: proof.diagram(),
        configurations: proof.configurations(),
        failure: failure.as_ref(),
        bytes: reader.bytes_read(),
        plain_bytes: reader.plain_bytes_read(),
    };
    let report = if flags.json { escaped_json(&summary.json()) } else { summary.text() };
    print(&report, output)?;
    failure.map_or(Ok(()), |failure| Err(failure.into()))
}

/// The proof that the flags ask for.
enum Proof {
    /// None.
    None,
    /// A proof that a mesh or a stream of points keeps all its promises.
    Audit(Box<Audit>),
    /// A proof that cells or simplices of four dimensions are what they claim to be.
    Diagram(Box<StreamAudit>),
    /// A proof that configurations are what they claim to be.
    Configurations(Box<config_audit::StreamAudit>),
    /// A count of the violations in a tetrahedral mesh.
    Census(Box<Census>, Standard),
}

impl Proof {
    fn of(flags: &Flags, header: &Header) -> Result<Self> {
        let Some(standard) = flags.audit else { return Ok(Proof::None) };
        if header.kind.is_4d() && !flags.count_violations && flags.points.is_empty() {
            return Ok(Proof::Diagram(Box::new(StreamAudit::new(header.kind)?)));
        }
        if header.kind.has_knots() && !flags.count_violations && flags.points.is_empty() {
            return Ok(Proof::Configurations(Box::default()));
        }
        if !flags.count_violations {
            let audit = Audit::new(header, standard, given_points(flags, header)?)?;
            return Ok(Proof::Audit(Box::new(audit)));
        }
        check_part(header, Some("a count of violations"))?;
        if header.kind != Kind::TetrahedralMesh {
            let message =
                format!("--count-violations goes with a tetrahedral mesh, not with {}", header.kind.name());
            return Err(Error::usage(message));
        }
        if header.weighted.is_some() {
            return Err(Error::usage("--count-violations takes no mesh with weights: --audit proves it"));
        }
        Ok(Proof::Census(Box::default(), standard))
    }

    fn event(&mut self, event: &Event, rows: &[u8], header: &Header) -> Result<()> {
        match self {
            Proof::None => Ok(()),
            Proof::Audit(audit) => {
                audit.event_with_rows(event, rows).map_err(|violation| violation.to_error(header))
            }
            Proof::Diagram(audit) => audit.event(event),
            Proof::Configurations(audit) => audit.event(event),
            Proof::Census(census, _) => census.event(event).map_err(|violation| violation.to_error(header)),
        }
    }

    /// The violation that is found at the end of the stream. [`Proof::Audit`] fails earlier, at the event.
    fn verdict(&mut self) -> Option<Error> {
        match self {
            Proof::Diagram(audit) => {
                audit.prove().err().map(|violation| Error::new(ErrorKind::Audit, violation.to_string()))
            }
            Proof::Configurations(audit) => audit.prove().err(),
            Proof::Census(census, standard) if !census.counts().is_clean(*standard) => {
                Some(Error::new(ErrorKind::Audit, "the mesh is wrong: the counts are in the report"))
            }
            _ => None,
        }
    }

    fn report(&self) -> Option<Report> {
        match self {
            Proof::Audit(audit) => Some(audit.report()),
            _ => None,
        }
    }

    fn diagram(&self) -> Option<&std::result::Result<diagram4::Proof, diagram4::Violation>> {
        match self {
            Proof::Diagram(audit) => audit.proof(),
            _ => None,
        }
    }

    fn configurations(&self) -> Option<&std::result::Result<config_audit::Proof, config_audit::Violation>> {
        match self {
            Proof::Configurations(audit) => audit.proof(),
            _ => None,
        }
    }

    fn counts(&self) -> Option<&Counts> {
        match self {
            Proof::Census(census, _) => Some(census.counts()),
            _ => None,
        }
    }
}

/// The points of `--points`, to be compared with the mesh.
fn given_points(flags: &Flags, mesh: &Header) -> Result<Option<Given>> {
    if flags.points.is_empty() {
        return Ok(None);
    }
    if mesh.kind.vertices_per_simplex() == 0 {
        return Err(Error::usage(format!("--points goes with a mesh, not with {}", mesh.kind.name())));
    }
    let stdin = Path::new("-");
    if flags.input == stdin && flags.points.iter().any(|path| path == stdin) {
        return Err(Error::usage("mesh and points cannot both come from stdin"));
    }
    let grid = match mesh.coordinates {
        Coordinates::F64 => None,
        Coordinates::I32 { scale, offset } => Some((scale, offset)),
    };
    let options = SourceOptions {
        reader: &SPINFO,
        dims: mesh.dims,
        grid,
        holds_points: true,
        ..SourceOptions::default()
    };
    if let Some(distance) = flags.within {
        return near_points(flags, distance, mesh, &options).map(|near| Some(Given::Near(Box::new(near))));
    }
    let input = Input::open(&flags.points, &options)?;
    let mut points = PointSet::new(input.description().coordinates, mesh.dims);
    for_each_batch(flags, &input, |batch| points.extend(batch))?;
    points.finish(&mesh.coordinates).map(|points| Some(Given::All(points)))
}

/// The points that are to be near the mesh.
fn near_points(flags: &Flags, distance: f64, mesh: &Header, options: &SourceOptions) -> Result<NearPoints> {
    check_surface(mesh, true)?;
    if !(0.0..f64::INFINITY).contains(&distance) {
        return Err(Error::usage(format!("--within {distance}: give a number from 0 on")));
    }
    let mut points = Vec::new();
    let coordinates = match open_planar(&flags.points, options)? {
        Opened::Points(input) => {
            for_each_batch(flags, &input, |batch| points.extend_from_slice(batch))?;
            input.description().coordinates
        }
        Opened::Events(mut events) => {
            while let Some(event) = events.next_event()? {
                if let Event::Patch(patch) = event {
                    points.extend(patch.new);
                }
            }
            events.header().coordinates
        }
    };
    NearPoints::new(coordinates, points, &mesh.coordinates, distance)
}

/// Passes all points of an input on.
fn for_each_batch(flags: &Flags, input: &Input, mut take: impl FnMut(&[Point])) -> Result<()> {
    input.notices().iter().for_each(|text| notice("spinfo", &flags.common, text));
    let (mut reader, mut batch) = (input.read()?, Vec::new());
    loop {
        reader.next_batch(&mut batch)?;
        if batch.is_empty() {
            input.withheld_notice().iter().for_each(|text| notice("spinfo", &flags.common, text));
            return Ok(());
        }
        take(&batch);
    }
}

fn print(text: &str, mut output: Output) -> Result<()> {
    output.write_all(text.as_bytes()).map_err(|e| Error::io("writing the report", e))?;
    output.commit()
}
