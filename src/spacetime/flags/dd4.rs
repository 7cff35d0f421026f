//! `dd4`: flags.

mod product;
mod report;
mod source;

use std::path::PathBuf;
use std::time::Instant;

use clap::{Parser, ValueEnum};

use crate::dd4::{Made, Options, Product, Quantum, TimeScale};
use crate::diagram4::Route;
use spmesh_base::error::{Error, Result};
use spmesh_base::output::Output;
use spmesh_base::system;
use spmesh_shell::compression::Compression;
use spmesh_shell::endings;
use spmesh_shell::resources::{TempDirFlag, ThreadsFlag};
use spmesh_shell::{Common, StatsFlag, advise_on_memory, notice, parse_size, progress::Progress};

pub use product::{EXAMPLES as PRODUCT_EXAMPLES, ProductFlags};
pub use source::{EXAMPLES as SOURCE_EXAMPLES, SourceFlags};

const EXAMPLES: &str = "\
Examples:
  The diagram of lines of x y z t, and an exact proof that it is right:
    dd4 points.txt -o points.spm
    spinfo --audit points.spm
  The same where things move about 3 units of space in a unit of time:
    dd4 points.txt --time-scale 3 -o points.spm
";

// Paragraphs are single lines: they are wrapped to the width of the terminal.
const NOTES: &str = "

Cells: of each empty sphere through points that span space, the convex hull of all points on it; and \
infinite ones, one for each facet of a cell on the hull. Without --quantum, coordinates are taken as the f64 \
that they are.

Exit codes: 0 success, 1 I/O or runtime failure, 2 usage, or points that span no 4 dimensions, 3 malformed \
or truncated input, 5 not enough memory for the points, 6 input of another version of spmesh, 141 output closed by its reader.";

/// Exact Delaunay diagrams of points in four dimensions.
///
/// Reads points or volumes that change over time, and writes the cells of their Delaunay diagram with their
/// neighbours as a stream. The result is exact and unique: it depends on the set of points only.
#[derive(Debug, Parser)]
#[command(name = "dd4", version, after_help = format!("{EXAMPLES}{SOURCE_EXAMPLES}\n{PRODUCT_EXAMPLES}{NOTES}"))]
#[command(mut_arg("stats", |stats| stats.help("Print what the run did on stderr")))]
pub struct Flags {
    /// Where the diagram goes; - is stdout
    #[arg(short, long, value_name = "FILE", default_value = "-")]
    output: PathBuf,

    /// All coordinates are multiples of Q, like 0.1: compute with the integer multiples, and write these.
    /// Without this, coordinates are rounded to f64, so that points of a grid are not exactly cospherical
    #[arg(long, value_name = "Q", allow_negative_numbers = true)]
    quantum: Option<Quantum>,

    /// Multiply times by S, so that a unit of time counts as S units of space, as in --time-scale 2.5.
    /// --where,
    /// --at and --slice still take times of the input; streams hold the products
    #[arg(
        long,
        value_name = "S",
        default_value = "1",
        hide_default_value = true,
        allow_negative_numbers = true
    )]
    time_scale: TimeScale,

    /// How cells are found: by way of simplices, or directly in integers as by the first dd4 (2008), which is
    /// slower. The result is the same
    #[arg(long, value_enum, default_value_t = RouteFlag::Simplices, value_name = "simplices|direct", hide_possible_values = true)]
    route: RouteFlag,

    #[command(flatten)]
    threads: ThreadsFlag,

    /// Compute in stages, in about this much memory, as in 1400M: slower, but the output is the same. Cells
    /// wait in temporary files (see --temp-dir). Not for slices, values, simplices, and --route direct
    #[arg(long, value_name = "SIZE", value_parser = parse_size)]
    memory: Option<u64>,

    #[command(flatten)]
    temp_dir: TempDirFlag,

    #[command(flatten)]
    compression: Compression,

    #[command(flatten)]
    stats: StatsFlag,

    #[command(flatten)]
    common: Common,

    // Last, because their headings would apply to all flags after them.
    #[command(flatten)]
    source: SourceFlags,

    #[command(flatten)]
    product: ProductFlags,
}

/// Values of `--route`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum RouteFlag {
    /// Simplices, then cells
    Simplices,
    /// Cells
    Direct,
}

impl RouteFlag {
    /// The route in the engine.
    fn route(self) -> Route {
        match self {
            RouteFlag::Simplices => Route::Simplices,
            RouteFlag::Direct => Route::Direct,
        }
    }
}

/// Runs the tool.
///
/// # Errors
/// As [`SourceFlags::read`], [`crate::dd4::make`] and [`crate::dd4::Product::write`].
pub fn run(flags: Flags) -> anyhow::Result<()> {
    Ok(flags.run()?)
}

impl Flags {
    fn run(&self) -> Result<()> {
        let started = Instant::now();
        let memory = if self.memory.is_some() { "less " } else { "" };
        let advice = format!("give {memory}--memory, or take fewer points, as with --count or --where");
        advise_on_memory("dd4", &advice);
        let (quantum, time_scale) = (self.quantum, self.time_scale);
        let (route, threads) = (self.route.route(), self.threads.get());
        let options = Options { quantum, time_scale, route, threads };
        if self.source.is_stdin() && self.product.reads_stdin() {
            return Err(Error::usage("points and sites cannot both come from stdin"));
        }
        endings::check(&self.output, &[endings::STREAM, endings::MESH, endings::TABLE])?;
        // Fail before the computation if the output cannot be created.
        let mut output = Output::create(&self.output, self.product.is_binary(&self.output)?)?;
        let product = self.product.product(&self.output)?;
        if self.memory.is_some() {
            self.check_memory(&product)?;
            // Each stage frees what the one before took.
            system::give_back_large_blocks();
        }
        let compress = self.compression.of_output(product.is_stream())?;
        let progress = Progress::waiting(&self.common, "reading");
        let points = self.source.read(self.temp_dir.to_owned(), self.memory.is_none())?;
        let read = started.elapsed();
        drop(progress);
        for warning in &points.warnings {
            // Warnings about a spool already name the input.
            let warning = warning.strip_prefix(&format!("{}: ", points.name)).unwrap_or(warning);
            self.notice(&format!("{}: {warning}", points.name));
        }
        let progress = Progress::waiting(&self.common, "triangulating");
        let make_started = Instant::now();
        let (notices, mut report) = if let Some(memory) = self.memory {
            let temp_dir = self.temp_dir.get();
            crate::dd4::write_streamed(points, &options, memory, temp_dir, compress, &mut output)?
        } else {
            let Made { diagram, placement, report } = crate::dd4::make(points, &product, &options)?;
            (product.write(&diagram, &placement, compress, &mut output)?, report)
        };
        report.output_bytes = output.bytes_written();
        output.commit()?;
        report.write_time = make_started.elapsed().saturating_sub(report.diagram_time);
        drop(progress);
        notices.iter().for_each(|text| self.notice(text));
        report::merged(&report).into_iter().for_each(|text| self.notice(&text));
        self.stats.print(|| report::stats(&report, read, started.elapsed()));
        Ok(())
    }

    /// Refuses what needs the whole diagram in memory.
    fn check_memory(&self, product: &Product) -> Result<()> {
        if *product == Product::Cells && self.route == RouteFlag::Simplices {
            return Ok(());
        }
        Err(Error::usage("--memory is for cells alone: all others are made of a diagram that is in memory"))
    }

    fn notice(&self, message: &str) {
        notice("dd4", &self.common, message);
    }
}
