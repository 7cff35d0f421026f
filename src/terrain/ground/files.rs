//! Files with the classes of their points.

use std::io::{Seek, Write};
use std::num::NonZeroUsize;

use super::{Class, Found};
use crate::height::{rewrite, stored_point};
use spmesh_base::error::{Error, Result};
use spmesh_formats::las::{Changes, LasFile};
use spmesh_formats::source::{Filters, StreamFile, TextFile};
use spmesh_stream::Coordinates;
use spmesh_stream::model::attributes::{Attribute, NumberType};

/// How files are written.
#[derive(Debug, Clone)]
pub struct RewriteOptions {
    /// Points that these drop keep the class that they have.
    pub filters: Filters,
    /// Whether points are compressed; as in the input if `None`.
    pub is_compressed: Option<bool>,
    /// Memory for points under way. Units: bytes.
    pub memory: u64,
    /// Threads that decompress, as many that compress, and as many that find classes.
    pub threads: usize,
}

impl RewriteOptions {
    fn threads(&self) -> NonZeroUsize {
        NonZeroUsize::new(self.threads).unwrap_or(NonZeroUsize::MIN)
    }
}

/// Bytes of a point of a text or stream, its line and what is found for it, about.
const TEXT_POINT_LEN: u64 = 200;
/// Most points of these whose classes are found together.
const TEXT_POINTS_MAX: u64 = 1 << 18;

/// The name of the column of classes.
const COLUMN: &str = "class";
/// The name of the attribute of classes, which is that of LAS files.
const ATTRIBUTE: &str = "classification";

/// Counts of a file, or of several.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct ClassCounts {
    /// Points of the file.
    pub points: u64,
    /// Those of each class, in the order of [`super::Class::ALL`].
    pub classes: [u64; 4],
    /// Those that kept the class that they had.
    pub kept: u64,
}

impl ClassCounts {
    /// Adds points that got classes.
    fn count(&mut self, classes: &[Class]) {
        classes.iter().for_each(|class| self.classes[class.number()] += 1);
        self.points += classes.len() as u64;
    }

    /// Adds the counts of another file.
    pub fn add(&mut self, other: &ClassCounts) {
        self.points += other.points;
        self.kept += other.kept;
        self.classes.iter_mut().zip(other.classes).for_each(|(sum, count)| *sum += count);
    }
}

/// Writes the lines of `file` again, each point with its class in one more column; calls `progress` with the
/// number of points written.
///
/// Memory: `options.memory`.
///
/// # Errors
/// Malformed, if the file is; if reading or writing fails.
pub fn write_text_classes<W: Write>(
    found: &Found,
    file: &TextFile,
    mut output: W,
    options: &RewriteOptions,
    mut progress: impl FnMut(u64),
) -> Result<(W, ClassCounts)> {
    let mut classifier = found.classifier(&Coordinates::F64, options.threads());
    let most = (options.memory / TEXT_POINT_LEN).clamp(1, TEXT_POINTS_MAX) as usize;
    let (mut counts, mut classes) = (ClassCounts::default(), Vec::new());
    file.write_with((COLUMN, Some(0)), most, &mut output, |points, values| {
        classifier.of(points, &mut classes)?;
        counts.count(&classes);
        values.clear();
        values.extend(classes.iter().map(|&class| f64::from(class as u8)));
        progress(counts.points);
        Ok(())
    })?;
    Ok((output, counts))
}

/// Writes the stream `file` again, each point with its class as one more attribute; calls `progress` with the
/// number of points written.
///
/// Memory: `options.memory`.
///
/// # Errors
/// Usage, if points have such an attribute; malformed, if the stream is; if reading or writing fails.
pub fn write_stream_classes<W: Write>(
    found: &Found,
    file: &StreamFile,
    output: W,
    options: &RewriteOptions,
    mut progress: impl FnMut(u64),
) -> Result<(W, ClassCounts)> {
    let header = file.header();
    let mut classifier = found.classifier(&header.coordinates, options.threads());
    let point_len = TEXT_POINT_LEN + 3 * header.attributes.row_len() as u64;
    let most = (options.memory / point_len).clamp(1, TEXT_POINTS_MAX) as usize;
    let (mut counts, mut classes) = (ClassCounts::default(), Vec::new());
    let attribute = Attribute::new(ATTRIBUTE, NumberType::U8);
    let output = file.write_with(attribute, most, output, |points, numbers| {
        classifier.of(points, &mut classes)?;
        counts.count(&classes);
        numbers.clear();
        numbers.extend(classes.iter().map(|&class| class as u8));
        progress(counts.points);
        Ok(())
    })?;
    Ok((output, counts))
}

/// Writes `file` again with the classes of its points; calls `progress` with the number of points written.
/// All else stays as it is, also the order of the points. Also returns what could not be kept.
///
/// Memory: `options.memory`.
///
/// # Errors
/// Malformed, if the file is; if reading or writing fails.
pub fn write_classes<W: Write + Seek>(
    found: &Found,
    file: &LasFile,
    output: W,
    options: &RewriteOptions,
    mut progress: impl FnMut(u64),
) -> Result<(W, ClassCounts, Vec<String>)> {
    let changes = Changes {
        is_compressed: options.is_compressed.unwrap_or(file.is_compressed()),
        ..Changes::default()
    };
    let mut classifier = found.classifier(file.coordinates(), options.threads());
    let of_file = |e: Error| e.of_input(file.name());
    let (record_len, classes_of) = (file.record_len(), file.classes(&options.filters));
    let mut counts = ClassCounts::default();
    let (mut wanted, mut points, mut classes) = (Vec::new(), Vec::new(), Vec::new());
    let written = rewrite(file, output, &changes, options.memory, options.threads, |batch, copy| {
        points.clear();
        wanted.clear();
        for (number, record) in batch.chunks_exact(record_len).enumerate() {
            if classes_of.keeps(record) {
                wanted.push(number);
                points.push(stored_point(record));
            }
        }
        classifier.of(&points, &mut classes).map_err(of_file)?;
        for (&number, &class) in wanted.iter().zip(&classes) {
            counts.classes[class.number()] += 1;
            classes_of.set(&mut batch[number * record_len..][..record_len], class as u8);
        }
        let records = (batch.len() / record_len) as u64;
        counts.points += records;
        counts.kept += records - wanted.len() as u64;
        copy.write(batch)?;
        progress(counts.points);
        Ok(())
    })?;
    let (output, notices) = written;
    Ok((output, counts, notices))
}
