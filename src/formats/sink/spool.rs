//! Data that waits in temporary files until its counts are known.

use std::fs::File;
use std::io::{BufReader, BufWriter, Read, Seek, Write};
use std::path::Path;

use crate::sink::world::world_of;
use spmesh_base::error::{Error, Result};
use spmesh_base::temporary::TemporaryFile;
use spmesh_stream::model::bounds::{Bounds, Point};
use spmesh_stream::{Event, Header};

const BUFFER_LEN: usize = 1 << 16;

/// A temporary file.
pub(crate) struct Spool(BufWriter<File>);

impl Spool {
    /// An empty file in `temp_dir`, or in the system's folder for temporary files.
    pub(crate) fn new(temp_dir: Option<&Path>) -> Result<Self> {
        let file = TemporaryFile::create(temp_dir)?;
        Ok(Spool(BufWriter::with_capacity(BUFFER_LEN, file.into_file())))
    }

    /// Appends bytes.
    pub(crate) fn bytes(&mut self, bytes: &[u8]) -> Result<()> {
        self.0.write_all(bytes).map_err(spool_error)
    }

    /// Appends text.
    pub(crate) fn text(&mut self, text: std::fmt::Arguments) -> Result<()> {
        self.0.write_fmt(text).map_err(spool_error)
    }

    /// Copies all to the output.
    pub(crate) fn copy_to(&mut self, output: &mut impl Write) -> Result<()> {
        let mut input = self.rewound()?;
        std::io::copy(&mut input, output)
            .map_err(|e| Error::io("copying a temporary file to the output", e))?;
        Ok(())
    }

    /// Reads all bytes as records of `N` bytes.
    pub(crate) fn records<const N: usize>(&mut self) -> Result<Records<'_, N>> {
        Ok(Records(self.rewound()?))
    }

    fn rewound(&mut self) -> Result<BufReader<&File>> {
        self.0.flush().map_err(spool_error)?;
        self.0.rewind().map_err(spool_error)?;
        Ok(BufReader::with_capacity(BUFFER_LEN, self.0.get_ref()))
    }
}

impl Write for Spool {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.0.write(bytes)
    }

    fn flush(&mut self) -> std::io::Result<()> {
        self.0.flush()
    }
}

/// The records of a temporary file.
pub(crate) struct Records<'a, const N: usize>(BufReader<&'a File>);

impl<const N: usize> Records<'_, N> {
    /// The next record, which must be there.
    pub(crate) fn next(&mut self) -> Result<[u8; N]> {
        let mut record = [0; N];
        self.0.read_exact(&mut record).map_err(|e| Error::io("reading a temporary file", e))?;
        Ok(record)
    }
}

fn spool_error(cause: std::io::Error) -> Error {
    Error::io("writing a temporary file", cause)
}

/// The coordinates of a vertex in its record.
pub(crate) fn place_of(record: &[u8; 24]) -> Point {
    [0, 8, 16].map(|at| f64::from_le_bytes(record[at..at + 8].try_into().expect("eight bytes")))
}

/// Vertices, simplices and labels of a stream, for formats that state their counts first and hold all
/// vertices before all simplices. Points are vertices without simplices.
///
/// Memory: buffers only. Disk: 24 bytes per vertex, 8 per corner of a simplex and per label.
pub(crate) struct MeshSpool {
    header: Header,
    /// World coordinates, three f64 each, little-endian.
    pub(crate) vertices: Spool,
    /// Ids, a u64 per corner, little-endian.
    pub(crate) corners: Spool,
    /// Labels, a u64 each, little-endian.
    pub(crate) labels: Spool,
    /// The box of the vertices; `None` without vertices.
    pub(crate) bounds: Option<Bounds>,
    /// The numbers of each attribute, as they are stored.
    pub(crate) columns: Vec<Spool>,
    /// Number of labels, and the greatest one.
    pub(crate) label_count: u64,
    pub(crate) label_max: u64,
}

impl MeshSpool {
    /// Opens the temporary files.
    pub(crate) fn new(header: &Header, temp_dir: Option<&Path>) -> Result<Self> {
        Ok(MeshSpool {
            header: header.clone(),
            vertices: Spool::new(temp_dir)?,
            corners: Spool::new(temp_dir)?,
            labels: Spool::new(temp_dir)?,
            bounds: None,
            columns: Vec::new(),
            label_count: 0,
            label_max: 0,
        })
    }

    /// Takes attributes, too.
    pub(crate) fn with_attributes(mut self, temp_dir: Option<&Path>) -> Result<Self> {
        self.columns = self.header.attributes.iter().map(|_| Spool::new(temp_dir)).collect::<Result<_>>()?;
        Ok(self)
    }

    /// The header of the stream.
    pub(crate) fn header(&self) -> &Header {
        &self.header
    }

    /// Takes an event that is not the end, with the rows of its points.
    pub(crate) fn event(&mut self, event: &Event, rows: &[u8]) -> Result<()> {
        let points = match event {
            Event::Points(points) => points,
            Event::Patch(patch) => &patch.new,
            Event::Labels(labels) => return self.labels(labels),
            _ => return Ok(()),
        };
        for &point in points {
            let coordinates = world_of(&self.header, point);
            self.bounds.get_or_insert(Bounds::of_point(coordinates)).extend(coordinates);
            coordinates.iter().try_for_each(|x| self.vertices.bytes(&x.to_le_bytes()))?;
        }
        for (column, (_, place)) in self.columns.iter_mut().zip(self.header.attributes.places()) {
            let row_len = self.header.attributes.row_len();
            rows.chunks_exact(row_len).try_for_each(|row| column.bytes(&row[place.clone()]))?;
        }
        if let Event::Patch(patch) = event {
            let mut ids = patch.simplices.iter().map(|&local| patch.id(local));
            ids.try_for_each(|id| self.corners.bytes(&id.to_le_bytes()))?;
        }
        Ok(())
    }

    fn labels(&mut self, labels: &[u64]) -> Result<()> {
        self.label_count += labels.len() as u64;
        self.label_max = labels.iter().copied().fold(self.label_max, u64::max);
        labels.iter().try_for_each(|label| self.labels.bytes(&label.to_le_bytes()))
    }
}
