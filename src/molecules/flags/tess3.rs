//! `tess3`: flags.

mod balls;
mod frames;
mod method;
mod periodic;
mod picture;
mod report;
mod selection;
mod tables;

pub use crate::tess3::heap::CountingHeap;

use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Parser;

use crate::tess3::sweep::{COLUMNS, Sweep, sweep};
use crate::tess3::{Arithmetic, ModelName, Options, Product, Radius, Report, Stats};
use balls::BallFlags;
use frames::FrameFlags;
use method::MethodFlags;
use periodic::PeriodicFlags;
use picture::PictureFlags;
use selection::SelectionFlags;
use spmesh_base::error::{Error, Result, counted};
use spmesh_base::output::Output;
use spmesh_base::parallel::available_threads;
use spmesh_formats::drivers::Format;
use spmesh_formats::ledger::Batch;
use spmesh_formats::molecules::{FrameReader, Structure, read_structure};
use spmesh_formats::sink::TableFormat;
use spmesh_shell::batch::{BatchFlags, BatchMessages, SUMMARY_ENDINGS};
use spmesh_shell::compression::Compression;
use spmesh_shell::endings;
use spmesh_shell::resources::parse_threads;
use spmesh_shell::{Common, Names, StatsFlag, advise_on_memory, named, notice, refuse_terminal, value_name};

const TOOL: &str = "tess3";

/// The name of the summary in the folder of a sweep.
const SUMMARY_NAME: &str = "summary.tsv";

const EXAMPLES: &str = "\
Examples:
  The mesh of all atoms, and an exact proof that it is right:
    tess3 1abc.cif.gz -o 1abc.spm
    spinfo --audit 1abc.spm
  Contacts between residues: edges of the triangulation of the alpha carbons of two chains:
    tess3 1abc.pdb --chain A,B --atoms ca --contacts -o contacts.tsv
  Proteins, nucleic acids and ligands of a biological assembly, without water and ions:
    tess3 1abc.cif --assembly 1 --classes polymer,ligand -o 1abc.spm
  Tetrahedra with circumradius and volume; only those of the alpha complex of radius 4 Å:
    tess3 1abc.pdb --hetatm off --alpha 4 --table | sort -gk10
  Accessible area of each residue, molecular surface, areas of contacts between chains, and pockets:
    tess3 1abc.cif.gz --classes polymer --sasa --per residue -o sasa.tsv
    tess3 1abc.cif.gz --classes polymer --ses --per molecule
    tess3 1abc.cif.gz --classes polymer --contact-areas --between chains -o interface.tsv
    tess3 1abc.cif.gz --classes polymer --pockets -o pockets.tsv
  Areas that chains take from each other, and what each residue at a ligand loses to it:
    tess3 1abc.cif.gz --classes polymer --buried-areas
    tess3 1abc.cif.gz --classes polymer,ligand --buried-areas --between classes --per residue
  Areas of each residue in every tenth frame of a trajectory:
    tess3 --top 1abc.gro 1abc.xtc --frames ::10 --classes polymer --sasa --per residue -o sasa.parquet
  The same areas for pandas, Polars or DuckDB:
    tess3 1abc.cif.gz --classes polymer --sasa -o sasa.parquet
  Persistent homology, with GUDHI or another program that reads lists of simplices:
    tess3 1abc.pdb --filtration -o 1abc.txt
  Many structures, two at a time; later only what is new or changed:
    find pdb -name '*.cif.gz' | tess3 --lof - --out-dir meshes --threads 2
    find pdb -name '*.cif.gz' | tess3 --lof - --out-dir meshes --threads 2 --resume
  One table of the residues of all of them:
    find pdb -name '*.cif.gz' | tess3 --lof - --sasa --per residue --out-dir parts -o areas.parquet

Defaults: what the file shows of one molecule. That is its first model; all atoms, hydrogen too; HETATM \
records, with ligands, ions and water; and of alternate locations, for each residue, those of the conformer \
that is occupied most.

Exit codes: 0 success, 1 I/O or runtime failure, or a file of a sweep failed, 2 usage, 3 malformed or \
truncated input, 5 not enough memory, 6 input of another version of spmesh, 141 output closed by its reader.";

/// Delaunay tetrahedralization of the atoms of molecules, and of other points in space.
///
/// Reads PDB, PQR, PDBx/mmCIF, BinaryCIF, GRO, XYZ, trajectories (XTC, TRR, DCD), lines of x y z, spmesh
/// streams of points or tetrahedra, PLY, OBJ, OFF, VTK and LAS, plain or compressed (.gz, .zst), and writes
/// a tetrahedral mesh stream or a table, also of areas, volumes, contacts and pockets of atoms as balls. The
/// triangulation is exact and canonical: it depends on the set of points only.
#[derive(Debug, Parser)]
#[command(name = TOOL, version, after_help = EXAMPLES)]
#[command(mut_arg("stats", |stats| stats.help("Print statistics on stderr")))]
#[command(mut_arg("out_dir", |folder| folder.help("Sweep: write an output for each file to this folder, and a \
    summary")))]
#[command(mut_arg("lof", |list| list.requires("out_dir")))]
#[command(mut_arg("summary", |summary| summary.help("Where the summary of a sweep goes, a line per mesh: a table, \
    JSON Lines if the name ends in .jsonl, or Parquet if it ends in .parquet; - is stdout [default: summary.tsv in \
    the folder]")))]
#[command(mut_arg("keep_going", |flag| flag.help("Go on with the other files when one fails; this is the \
    default")))]
pub struct Flags {
    /// Structure or points; - is stdin. Several only with --out-dir
    #[arg(value_name = "FILE")]
    inputs: Vec<PathBuf>,

    /// Where the mesh or the table goes; - is stdout. With --out-dir, one table of the rows of all files.
    /// FILE.pdb, .cif or .defattr (ChimeraX) are atoms with the values of --sasa, --volumes or --ses
    /// [default: -]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,

    #[command(flatten)]
    selection: SelectionFlags,

    #[command(flatten)]
    frames: FrameFlags,

    /// Write a table of the tetrahedra: atoms, circumradius and volume (Å, Å³), instead of the mesh
    #[arg(long, conflicts_with = "contacts")]
    table: bool,

    /// Write a table of the edges, neighbours of any distance: pairs of atoms, distance (Å), and the number
    /// of tetrahedra around
    #[arg(long)]
    contacts: bool,

    /// Write the filtration of the alpha complex: each simplex with the square of the radius (Å²) from which
    /// on it belongs to the complex, in an order that programs for persistent homology take. A line has the
    /// dimension, the vertices, counted from 0 in the selection, the value, and a bound on its error
    #[arg(long, conflicts_with_all = ["table", "contacts", "alpha"])]
    filtration: bool,

    /// Format of tables, also in a sweep: text with tabs, JSON Lines, or Parquet [default: that of the ending
    /// of --output, else tsv]
    #[arg(long, value_name = "tsv|jsonl|parquet", hide_possible_values = true)]
    #[arg(value_parser = named(tables::NAMES))]
    format: Option<TableFormat>,

    /// Write only simplices of the alpha complex of this radius (Å): those with an empty circumscribed sphere
    /// of at most that radius
    #[arg(long, value_name = "RADIUS")]
    alpha: Option<Radius>,

    /// Format of the input, if its content does not tell
    #[arg(long, value_name = "FORMAT", value_parser = named(FORMATS))]
    from: Option<Format>,

    #[command(flatten)]
    batch: BatchFlags,

    /// Number of files of a sweep in parallel, or of threads for one structure [default: one per core]
    #[arg(long, value_name = "N", value_parser = parse_threads())]
    threads: Option<NonZeroUsize>,

    /// Stop a sweep at the first file that fails
    #[arg(long, requires = "out_dir", conflicts_with = "keep_going")]
    strict: bool,

    #[command(flatten)]
    compression: Compression,

    #[command(flatten)]
    stats: StatsFlag,

    #[command(flatten)]
    common: Common,

    #[command(flatten)]
    balls: BallFlags,

    #[command(flatten)]
    picture: PictureFlags,

    #[command(flatten)]
    periodic: PeriodicFlags,

    // The last, as its heading holds for all flags after it.
    #[command(flatten)]
    method: MethodFlags,
}

/// Values of `--from`.
const FORMATS: Names<Format> = &[
    ("pdb: PDB", Format::Pdb),
    ("pqr: PQR: PDB with charges and radii", Format::Pqr),
    ("mmcif: PDBx/mmCIF", Format::Mmcif),
    ("bcif: BinaryCIF", Format::BinaryCif),
    ("gro: GRO of GROMACS", Format::Gro),
    ("xtc: XTC of GROMACS, with --top", Format::Xtc),
    ("trr: TRR of GROMACS, with --top", Format::Trr),
    ("dcd: DCD, with --top", Format::Dcd),
    ("xyz: XYZ of chemistry: number of atoms, comment, and lines of element x y z", Format::Xyz),
    ("points: Points as spfinalize reads them: lines of x y z, streams, LAS, VTK", Format::Text),
    ("ply: Vertices of a PLY file", Format::Ply),
    ("obj: Vertices of an OBJ file", Format::Obj),
    ("off: Vertices of an OFF file", Format::Off),
];

/// Runs the tool.
///
/// # Errors
/// As [`crate::tess3::run`] and [`sweep`]; and if files of a sweep failed.
pub fn run(flags: Flags) -> anyhow::Result<()> {
    let started = Instant::now();
    advise_on_memory(TOOL, "take fewer points, or fewer --threads in a sweep");
    flags.frames.check(&flags.inputs)?;
    let stats = match &flags.batch.out_dir {
        Some(folder) => run_sweep(&flags, folder)?,
        None => run_one(&flags)?,
    };
    let method = flags.method.method(NonZeroUsize::MIN)?;
    flags.stats.print(|| report::stats(&stats.stats, &method, started.elapsed()));
    stats.failure.map_or(Ok(()), |failure| Err(failure.into()))
}

/// Sums of a run, and its failure, if any.
struct Finished {
    stats: Stats,
    failure: Option<Error>,
}

fn run_one(flags: &Flags) -> Result<Finished> {
    let [input] = &flags.inputs[..] else {
        let message = match flags.inputs.len() {
            0 => "no input: give a file, or - for stdin (see --help)",
            _ => {
                "several files need a folder for their outputs: --out-dir FOLDER, and for one table of all also \
                 -o FILE"
            }
        };
        return Err(Error::usage(message));
    };
    if input == Path::new("-") {
        refuse_terminal()?;
    }
    let mut options = flags.options()?;
    let picture = flags.picture.of_output(flags.output(), options.product, &flags.balls)?;
    if options.periodic.is_some() && picture.is_some_and(|picture| !picture.form.is_of_atoms()) {
        return Err(Error::usage("a periodic box has no mesh: give a name that ends in .tsv"));
    }
    if let Some(balls) = &mut options.balls {
        balls.picture = picture;
    }
    let is_table_of_bytes = options.format == TableFormat::Parquet;
    let is_binary = options.product == Product::Mesh || is_table_of_bytes || picture.is_some();
    let ending = match options.product {
        Product::Mesh => endings::STREAM,
        Product::Filtration => endings::NUMBERS,
        _ => SUMMARY_ENDINGS,
    };
    if picture.is_none() {
        endings::check(flags.output(), &[ending])?;
    }
    // Fail before the work if the output cannot be created.
    let mut output = Some(Output::create(flags.output(), is_binary)?);
    if options.frames.is_some() {
        return run_frames(flags, input, &options, output);
    }
    let started = Instant::now();
    let structure = read_structure(input, flags.from)?;
    let notices = structure.notices(&options.selection, options.periodic.is_some());
    notices.iter().for_each(|text| flags.notice(&format!("{}: {text}", structure.name)));
    check_models(&structure, &options, flags)?;
    let read = started.elapsed();
    let reports = crate::tess3::run(structure, &options, &mut |_| {
        output.take().ok_or_else(|| Error::usage("several models need a folder for their meshes"))
    })?;
    let mut stats = Stats::default();
    for report in &reports {
        report::degeneracy(report, reports.len()).into_iter().for_each(|text| flags.notice(&text));
        stats.add(report);
    }
    stats.sums.times.read = read;
    Ok(Finished { stats, failure: None })
}

/// Measures frames one by one. Notices are those of the first; others are counted.
fn run_frames(
    flags: &Flags,
    input: &Path,
    options: &Options,
    mut output: Option<Output>,
) -> Result<Finished> {
    let topology = flags.frames.topology(|text| flags.notice(text))?;
    let frames =
        FrameReader::open(input, flags.from, options.frames.unwrap_or_default(), topology.as_deref())?;
    if options.is_per_model() && !frames.is_single() {
        let message =
            "several frames need a folder for their meshes: --out-dir FOLDER, or choose one, --frames N";
        return Err(Error::usage(message).of_input(frames.name()));
    }
    let (mut stats, mut others) = (Stats::default(), 0u64);
    let mut hear = |report: Report| {
        let texts = report.warnings();
        if stats.models == 0 {
            texts.iter().for_each(|text| flags.notice(&format!("frame {}: {text}", report.model)));
        } else {
            others += u64::from(!texts.is_empty());
        }
        stats.add(&report);
    };
    let mut open = |_: Option<ModelName>| output.take().ok_or_else(|| Error::usage("frames have one output"));
    crate::tess3::run_frames(frames, options, &mut open, &mut hear)?;
    if others > 0 {
        flags.notice(&format!("{} such notices, too", counted(others, "more frame has", "more frames have")));
    }
    Ok(Finished { stats, failure: None })
}

/// Refuses runs that need several outputs.
fn check_models(structure: &Structure, options: &Options, flags: &Flags) -> Result<()> {
    let models = structure.models.len();
    if options.is_per_model() && flags.selection.wants_several_models() && models > 1 {
        let has_picture = options.balls.as_ref().is_some_and(|balls| balls.picture.is_some());
        let remedy = if has_picture { "choose one with --model N" } else { "--out-dir FOLDER" };
        let message = format!("{models} models need a folder for their meshes: {remedy}");
        return Err(Error::usage(message).of_input(&structure.name));
    }
    Ok(())
}

fn run_sweep(flags: &Flags, folder: &Path) -> Result<Finished> {
    let paths = flags.batch.summary_paths(folder, SUMMARY_NAME)?;
    let mut options = flags.options()?;
    let table = flags.table_of_sweep(&options)?;
    if table.is_some() {
        options.format = TableFormat::Rows;
    }
    flags.picture.refuse("does not go with sweeps, which write tables: give -o FILE.ply or FILE.vtu")?;
    let batch = Batch {
        program: TOOL,
        version: env!("CARGO_PKG_VERSION").to_string(),
        files: flags.batch.files(&flags.inputs)?,
        list: flags.batch.lof.clone(),
        shared: flags.frames.shared(),
        options: flags.options_text(&options),
        folder: folder.to_path_buf(),
        summary: paths.summary,
        parquet: paths.parquet,
        columns: COLUMNS,
        resume: flags.batch.resume,
        strict: flags.strict,
    };
    let topology = flags.frames.topology(|text| flags.notice(text))?;
    let wanted =
        Sweep { batch, format: flags.from, topology, options, threads: flags.threads().get(), table };
    let mut messages = BatchMessages::new(TOOL, "triangulating", &flags.common);
    let (outcome, stats) = sweep(&wanted, &mut |news| messages.hear(news))?;
    Ok(Finished { stats, failure: messages.conclude(&outcome, &paths.shown) })
}

impl Flags {
    fn options(&self) -> Result<Options> {
        let cells = self.periodic.product(&self.balls)?;
        let product = match (self.balls.product().or(cells), self.table, self.contacts, self.filtration) {
            (Some(product), ..) => product,
            (_, true, ..) => Product::Tetrahedra,
            (_, _, true, _) => Product::Contacts,
            (.., true) => Product::Filtration,
            _ => Product::Mesh,
        };
        // A sweep has threads for its files.
        let threads = if self.batch.out_dir.is_some() { NonZeroUsize::MIN } else { self.threads() };
        let method = self.method.method(threads)?;
        let balls = self.balls.options(product, threads)?;
        let has_weights = product == Product::Filtration || balls.is_some();
        if has_weights && method.arithmetic != Arithmetic::Exact {
            return Err(Error::usage("--filtration and --radii need --arithmetic exact"));
        }
        if product == Product::Mesh && balls.is_some() && self.alpha.is_some() {
            return Err(Error::usage("--alpha does not go with --radii"));
        }
        Ok(Options {
            selection: self.selection.selection(),
            frames: self.frames.range(),
            assembly: self.selection.assembly().map(str::to_string),
            alpha: self.alpha.clone(),
            method,
            compress: self.compression.of_output(product == Product::Mesh)?,
            format: tables::format(self.format, self.output_file(), product)?,
            periodic: self.periodic.source(product, &self.balls)?,
            product,
            balls,
        })
    }

    /// The one table of a sweep, if `--output` names one.
    fn table_of_sweep(&self, options: &Options) -> Result<Option<(PathBuf, TableFormat)>> {
        let Some(output) = &self.output else { return Ok(None) };
        if !options.product.is_table() {
            let message = "--output with --out-dir is for tables, such as that of --sasa: a mesh or a filtration is \
                           of one file";
            return Err(Error::usage(message));
        }
        endings::check(output, &[SUMMARY_ENDINGS])?;
        let format = tables::format(self.format, Some(output), options.product)?;
        Ok(Some((output.clone(), format)))
    }

    /// Where the output of one file goes.
    fn output(&self) -> &Path {
        self.output.as_deref().unwrap_or(Path::new("-"))
    }

    /// The output of a run without a folder.
    fn output_file(&self) -> Option<&Path> {
        self.batch.out_dir.is_none().then(|| self.output())
    }

    fn threads(&self) -> NonZeroUsize {
        self.threads.unwrap_or_else(available_threads)
    }

    /// The options that determine the content of the outputs, as text.
    fn options_text(&self, options: &Options) -> String {
        let mut text = format!("{}{}", self.selection, self.frames);
        if let Some(format) = self.from {
            text += &format!(" --from {}", value_name(FORMATS, &format));
        }
        if let Some(radius) = &self.alpha {
            text += &format!(" --alpha {radius}");
        }
        text += &self.method.to_string();
        let compress = self.compression.of_stream();
        let names = [
            (self.table, " --table"),
            (self.contacts, " --contacts"),
            (self.filtration, " --filtration"),
            (compress, " --compress"),
        ];
        for (flag, name) in names {
            text += if flag { name } else { "" };
        }
        if options.format != TableFormat::default() {
            text += &format!(" --format {}", options.format.ending());
        }
        text += &self.periodic.text();
        text + options.balls.as_ref().map_or("", |balls| &balls.text)
    }

    fn notice(&self, message: &str) {
        notice(TOOL, &self.common, message);
    }
}
