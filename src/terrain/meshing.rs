//! Points that become a mesh within a program: the steps of a pipe of programs, finalization and
//! triangulation, with temporary files for pipes.

use std::fs::File;
use std::io::{BufReader, BufWriter, Seek, Write};
use std::path::{Path, PathBuf};

use spmesh_base::error::{Error, ErrorKind, Result, counted};
use spmesh_base::temporary::TemporaryFile;
use spmesh_pipeline::finalize::{self, Budget, CELL_POINTS, InRegions, Leaves, Order, Passes, Spooling};
use spmesh_pipeline::reduce::{self, Duplicates};
use spmesh_stream::StreamReader;

/// Bytes of the buffers of temporary files.
const BUFFER_LEN: usize = 1 << 18;

/// How points are triangulated.
#[derive(Debug, Clone)]
pub struct Meshing {
    /// Which of several points with the same x and y counts.
    pub duplicates: Duplicates,
    /// Memory for points. Units: bytes.
    pub memory: u64,
    /// Threads that finalize and triangulate.
    pub threads: usize,
    /// Folder for temporary files; that of the system if `None`.
    pub temp_dir: Option<PathBuf>,
}

impl Meshing {
    /// Triangulating with half of a budget.
    ///
    /// # Errors
    /// Memory, if that is too little for points.
    pub fn of_half(
        duplicates: Duplicates,
        memory: u64,
        threads: usize,
        temp_dir: Option<&Path>,
    ) -> Result<Meshing> {
        let least = 2 * Budget::process_min(threads);
        if memory >= least {
            let temp_dir = temp_dir.map(Path::to_path_buf);
            return Ok(Meshing { duplicates, memory: memory / 2, threads, temp_dir });
        }
        let [given, least] = [memory >> 20, least.div_ceil(1 << 20)];
        let threads = counted(threads as u64, "thread", "threads");
        let text = format!("--memory of {given} MiB is too little for {threads}: give {least}M or more");
        Err(Error::new(ErrorKind::Memory, text))
    }

    /// The mesh of points, as a stream from a temporary file that is called `name` in messages.
    ///
    /// # Errors
    /// Those of finalizing and triangulating.
    pub fn mesh(&self, points: &dyn Passes, name: &str) -> Result<StreamReader<BufReader<File>>> {
        self.stream(name, |output| self.write(points, false, output))
    }

    /// Writes the mesh of points, which may be compressed.
    ///
    /// # Errors
    /// As [`Meshing::mesh`]; if writing fails.
    pub fn write(&self, points: &dyn Passes, compress: bool, output: impl Write + Send) -> Result<()> {
        let options = finalize::Options {
            leaves: Leaves::Collapsed { cell_points: CELL_POINTS, level_max: None },
            order: Order::Chunked,
            compress: false,
            thin: None,
            budget: Budget::of_process(self.memory, self.threads)?,
            temp_dir: self.temp_dir.clone(),
            spooling: Spooling::Auto,
            regions: InRegions::NEVER,
            weighted: None,
        };
        let finalized =
            self.stream("points", |output| finalize::run(points, &options, &mut (), output).map(drop))?;
        let options = reduce::Options {
            duplicates: self.duplicates,
            threads: self.threads,
            memory: Some(self.memory),
            compress,
            ..reduce::Options::default()
        };
        reduce::triangulate(finalized, output, &options, |_| {}).map(drop)
    }

    /// What `write` writes, as a stream from a temporary file.
    fn stream(
        &self,
        name: &str,
        write: impl FnOnce(&mut BufWriter<File>) -> Result<()>,
    ) -> Result<StreamReader<BufReader<File>>> {
        let failed = |e| Error::io("writing a temporary file", e);
        let file = TemporaryFile::create(self.temp_dir.as_deref())?.into_file();
        let mut output = BufWriter::with_capacity(BUFFER_LEN, file);
        write(&mut output)?;
        output.flush().map_err(failed)?;
        let mut file = output.into_inner().map_err(|e| failed(e.into_error()))?;
        file.rewind().map_err(failed)?;
        StreamReader::new(BufReader::with_capacity(BUFFER_LEN, file), name)
    }
}
