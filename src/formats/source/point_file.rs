//! Files whose points are written again.

use std::path::{Path, PathBuf};

use crate::detect::{Format, Reader, read_head};
use crate::las::LasFile;
use crate::source::TextOptions;
use crate::source::input::check_text_options;
use crate::source::origin::{Admitted, Origin, name_of};
use crate::source::stream_file::StreamFile;
use crate::text::copy::TextFile;
use spmesh_base::error::{Error, Result};

/// A file whose points are written again.
#[derive(Debug)]
pub enum PointFile {
    /// LAS, LAZ or COPC.
    Las(Box<LasFile>),
    /// Lines of text.
    Text(Box<TextFile>),
    /// A stream of points.
    Stream(Box<StreamFile>),
}

impl PointFile {
    /// Opens the file at `path` ("-" is stdin) and reads its header, or the first lines of a text. `reader`
    /// is the program, for messages, and takes no other formats.
    ///
    /// Cost: the header. Stdin, and LAS files within gzip, are copied to an unlinked temporary file in
    /// `temp_dir`, or in the system's folder for temporary files.
    ///
    /// # Errors
    /// If the file cannot be opened, is of another format, or its header is damaged; the file is named.
    pub fn open(
        path: &Path,
        reader: &'static Reader,
        temp_dir: Option<&Path>,
        text: &TextOptions,
    ) -> Result<PointFile> {
        let name = name_of(path);
        let temp_dir = temp_dir.map_or_else(std::env::temp_dir, PathBuf::from);
        let mut notices = Vec::new();
        let origin = Origin::new(path, Admitted::Formats(reader), &temp_dir, &mut notices)?;
        let detect = || -> Result<(Format, bool)> {
            let mut plain = origin.plain()?;
            let head = read_head(&mut plain).map_err(|e| Error::io("reading", e))?;
            let format = reader.detect(&head)?;
            check_text_options(text, format)?;
            Ok((format, plain.is_compressed()))
        };
        let (format, is_compressed) = detect().map_err(|e| e.of_input(&name))?;
        if format == Format::Stream {
            return Ok(PointFile::Stream(Box::new(StreamFile::new(name, origin, notices)?)));
        }
        if format != Format::Las {
            return Ok(PointFile::Text(Box::new(TextFile::new(name, origin, text, notices)?)));
        }
        let origin = if is_compressed { origin.unpacked(&name, &temp_dir, &mut notices) } else { Ok(origin) };
        let origin = origin.map_err(|e| e.of_input(&name))?;
        Ok(PointFile::Las(Box::new(LasFile::of(origin, name, notices)?)))
    }

    /// Its name in messages.
    pub fn name(&self) -> &str {
        match self {
            PointFile::Las(file) => file.name(),
            PointFile::Text(file) => file.name(),
            PointFile::Stream(file) => file.name(),
        }
    }

    /// How many points it has, if that is stated.
    pub fn stated_points(&self) -> Option<u64> {
        match self {
            PointFile::Las(file) => Some(file.points()),
            PointFile::Text(_) => None,
            PointFile::Stream(file) => file.header().points,
        }
    }

    /// Oddities that the user should know.
    pub fn notices(&self) -> &[String] {
        match self {
            PointFile::Las(file) => file.notices(),
            PointFile::Text(file) => file.notices(),
            PointFile::Stream(file) => file.notices(),
        }
    }
}
