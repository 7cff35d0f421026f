//! Finds the arrays of points in an XML file of VTK.
//!
//! `VTKFile` holds an element named after the type of dataset, which holds pieces. Each piece has its points
//! as one array: as text, as base64, or at an offset into the appended data after all elements.

use std::io::Read;
use std::ops::Range;

use crate::raw::byte_order::ByteOrder;
use crate::raw::sample::SampleType;
use crate::source::origin::FileView;
use crate::source::point_arrays::{Place, PointArray};
use crate::text::numbers::Writing;
use crate::vtk::blocks::Compressor;
use crate::vtk::elements::{Elements, Tag};
use crate::vtk::framed::Framed;
use crate::vtk::lengths::Lengths;
use spmesh_base::error::{Error, Result};

/// Types of datasets that list their points.
const DATASETS: [&str; 3] = ["UnstructuredGrid", "PolyData", "StructuredGrid"];

/// End of a file. A file without it is truncated.
const END: &[u8] = b"</VTKFile>";

/// Number of bytes at the end of a file in which [`END`] is searched.
const TAIL_LEN: u64 = 256;

/// Content of the root element's tag.
struct FileHeader {
    dataset: String,
    lengths: Lengths,
    /// Name of the compressor of all data except text.
    compressor: Option<String>,
}

/// An array of points or of an attribute, as described by its element.
struct Described {
    piece: u64,
    points: u64,
    components: u8,
    sample: SampleType,
    format: Format,
    /// Offset in the file after the tag, for messages.
    byte: u64,
    /// Attributes of the points, by their names.
    data: Vec<(String, Described)>,
}

/// Place of an array's values.
enum Format {
    Ascii(Range<u64>),
    Base64(Range<u64>),
    /// Offset from the start of the appended data.
    Appended(u64),
}

/// The appended data.
struct Appended {
    start: u64,
    is_base64: bool,
}

/// Reads the elements of a file, and returns the places of its points.
///
/// Cost: a pass over everything but appended data. Memory: one tag, and 100 bytes per piece.
///
/// # Errors
/// If the XML is damaged or truncated, there are no pieces, or an array is not described as VTK does it;
/// usage, if the type of dataset does not list points, or the compressor is not supported.
pub(crate) fn read(file: &FileView) -> Result<Vec<PointArray>> {
    let mut elements = Elements::new(file)?;
    let root = elements.child()?.filter(|root| root.name == "VTKFile");
    let root = root.ok_or_else(|| Error::malformed("found another element, expected VTKFile"))?;
    let header = FileHeader::of(&root)?;
    let (mut described, mut pieces, mut appended) = (Vec::new(), 0, None);
    while let Some(tag) = elements.child()? {
        if tag.name == header.dataset {
            pieces += read_dataset(&mut elements, &mut described)?;
        } else if tag.name == "AppendedData" {
            appended = Some(read_appended(&mut elements, &tag)?);
            expect_end(file)?;
            break;
        } else {
            elements.skip()?;
        }
    }
    if pieces == 0 {
        return Err(root.error(&format!("found no pieces of {}", header.dataset)));
    }
    let place = |array: Described| {
        let at = format!("piece {}, array at byte {}", array.piece, array.byte);
        array.place(file, &header, appended.as_ref()).map_err(|e| e.at(at))
    };
    described.into_iter().map(place).collect()
}

/// Reads all pieces, and returns their number.
fn read_dataset(elements: &mut Elements, described: &mut Vec<Described>) -> Result<u64> {
    let mut pieces = 0;
    while let Some(tag) = elements.child()? {
        if tag.name == "Piece" {
            pieces += 1;
            read_piece(elements, &tag, pieces, described)?;
        } else {
            elements.skip()?;
        }
    }
    Ok(pieces)
}

fn read_piece(elements: &mut Elements, tag: &Tag, piece: u64, described: &mut Vec<Described>) -> Result<()> {
    let points = match tag.get("NumberOfPoints") {
        Some(count) => count.parse().ok(),
        None => tag.get("Extent").and_then(points_of_extent),
    };
    let points = points.ok_or_else(|| tag.error("found no number of points"))?;
    let before = described.len();
    let mut data = Vec::new();
    while let Some(child) = elements.child()? {
        if child.name == "PointData" && points > 0 {
            data.extend(read_data(elements, piece, points)?);
            continue;
        }
        if child.name != "Points" || points == 0 {
            elements.skip()?;
            continue;
        }
        while let Some(array) = elements.child()? {
            if array.get("NumberOfComponents") != Some("3") {
                return Err(array.error("points need NumberOfComponents=\"3\""));
            }
            described.push(Described::of(elements, &array, piece, points, 3)?);
        }
    }
    if let Some(points) = described[before..].last_mut() {
        points.data = data;
    }
    match described.len() - before {
        0 if points > 0 => Err(tag.error(&format!("{points} points, and no array of them"))),
        0 | 1 => Ok(()),
        arrays => Err(tag.error(&format!("{arrays} arrays of points, expected one: write one time step"))),
    }
}

/// Reads the arrays of attributes; those that are no numbers are skipped.
fn read_data(elements: &mut Elements, piece: u64, points: u64) -> Result<Vec<(String, Described)>> {
    let mut data = Vec::new();
    while let Some(array) = elements.child()? {
        let components = array.get("NumberOfComponents").map_or(Some(1), |count| count.parse().ok());
        let name = array.get("Name").map(unescaped);
        let is_number = array.get("type").is_some_and(|name| type_of(name).is_some());
        match (array.name.as_str(), name, components) {
            ("DataArray", Some(name), Some(components @ 1..)) if is_number => {
                data.push((name, Described::of(elements, &array, piece, points, components)?));
            }
            _ => elements.skip()?,
        }
    }
    Ok(data)
}

/// Text of an attribute of XML; as it is if it cannot be resolved.
fn unescaped(text: &str) -> String {
    quick_xml::escape::unescape(text).map_or_else(|_| text.to_string(), std::borrow::Cow::into_owned)
}

/// The number of points in an extent, which gives the first and last index along each axis.
fn points_of_extent(extent: &str) -> Option<u64> {
    let ends: Option<Vec<i64>> = extent.split_ascii_whitespace().map(|end| end.parse().ok()).collect();
    let [min_x, max_x, min_y, max_y, min_z, max_z] = ends?[..] else { return None };
    [(min_x, max_x), (min_y, max_y), (min_z, max_z)].into_iter().try_fold(1u64, |points, (min, max)| {
        let along = u64::try_from(max.checked_sub(min)?.checked_add(1)?).ok()?;
        points.checked_mul(along)
    })
}

fn read_appended(elements: &mut Elements, tag: &Tag) -> Result<Appended> {
    let is_base64 = match tag.get("encoding") {
        Some("raw") => false,
        Some("base64") => true,
        other => {
            let found = other.unwrap_or_default();
            return Err(tag.error(&format!("encoding {found:?}, expected raw or base64")));
        }
    };
    Ok(Appended { start: elements.behind_underscore()?, is_base64 })
}

/// Checks that the file was not truncated after the part that is read.
fn expect_end(file: &FileView) -> Result<()> {
    let mut tail = Vec::new();
    let mut end = file.range(file.len().saturating_sub(TAIL_LEN), file.len());
    end.read_to_end(&mut tail).map_err(|e| Error::io("reading", e))?;
    if tail.windows(END.len()).any(|window| window == END) {
        return Ok(());
    }
    Err(Error::malformed("truncated: the file does not end with </VTKFile>")
        .at(format!("byte {}", file.len())))
}

impl FileHeader {
    fn of(root: &Tag) -> Result<FileHeader> {
        let dataset = root.get("type").unwrap_or_default().to_string();
        if !DATASETS.contains(&dataset.as_str()) {
            let reason = match dataset.as_str() {
                "ImageData" | "RectilinearGrid" => "it lists no points, which lie on a lattice",
                "PUnstructuredGrid" | "PPolyData" | "PStructuredGrid" => "it names other files: give those",
                _ => "expected UnstructuredGrid, PolyData or StructuredGrid",
            };
            return Err(Error::usage(format!("is a VTK file of type {dataset:?}: {reason}")));
        }
        let order = match root.get("byte_order") {
            None | Some("LittleEndian") => ByteOrder::Little,
            Some("BigEndian") => ByteOrder::Big,
            Some(other) => return Err(root.error(&format!("byte_order {other:?}"))),
        };
        let is_wide = match root.get("header_type") {
            None | Some("UInt32") => false,
            Some("UInt64") => true,
            Some(other) => return Err(root.error(&format!("header_type {other:?}"))),
        };
        let compressor = root.get("compressor").filter(|name| !name.is_empty()).map(str::to_string);
        Ok(FileHeader { dataset, lengths: Lengths { is_wide, order }, compressor })
    }

    /// LZMA is not supported: the compressed data decide how much memory its decoder needs.
    fn compressor(&self) -> Result<Option<Compressor>> {
        match self.compressor.as_deref() {
            None => Ok(None),
            Some("vtkZLibDataCompressor") => Ok(Some(Compressor::Zlib)),
            Some("vtkLZ4DataCompressor") => Ok(Some(Compressor::Lz4)),
            Some(other) => {
                let message =
                    format!("compressed by {other}: write it with zlib, LZ4 or without compression");
                Err(Error::usage(message))
            }
        }
    }
}

impl Described {
    fn of(elements: &mut Elements, tag: &Tag, piece: u64, points: u64, components: u8) -> Result<Described> {
        if tag.name != "DataArray" {
            return Err(tag.error("expected DataArray"));
        }
        let name = tag.get("type").unwrap_or_default();
        let sample = type_of(name).ok_or_else(|| tag.error(&format!("type {name:?} is none of numbers")))?;
        let offset = || tag.get("offset").and_then(|offset| offset.parse().ok());
        let text = elements.only_text()?;
        let format = match tag.get("format") {
            Some("ascii") | None => Format::Ascii(text),
            Some("binary") => Format::Base64(text),
            Some("appended") => Format::Appended(offset().ok_or_else(|| tag.error("found no offset"))?),
            Some(other) => return Err(tag.error(&format!("format {other:?}"))),
        };
        Ok(Described { piece, points, components, sample, format, byte: tag.end, data: Vec::new() })
    }

    /// Finds the bytes of the array in the file.
    fn place(self, file: &FileView, header: &FileHeader, appended: Option<&Appended>) -> Result<PointArray> {
        let len = PointArray::len_of(self.points, self.components, self.sample)?;
        let lengths = header.lengths;
        let framed = |Range { start, end }: Range<u64>, is_base64| -> Result<Framed> {
            Ok(Framed { start, end, is_base64, lengths, compressor: header.compressor()?, len })
        };
        let is_appended = matches!(self.format, Format::Appended(_));
        // Points are read even if attributes that nobody asks for are damaged.
        let place_data =
            |(name, data): (String, Described)| Some((name, data.place(file, header, appended).ok()?));
        let data = self.data.into_iter().filter_map(place_data).collect();
        let mut writing = Writing::Binary(lengths.order);
        let place = match self.format {
            Format::Ascii(Range { start, end }) => {
                writing = Writing::Text;
                Place::Plain { start, end }
            }
            Format::Base64(text) => Place::Framed(framed(text, true)?),
            Format::Appended(offset) => {
                let appended = appended.ok_or_else(|| Error::malformed("there are no appended data"))?;
                let start = appended.start.checked_add(offset).filter(|start| *start < file.len());
                let start = start.ok_or_else(|| {
                    Error::malformed(format!("offset {offset} is beyond the end of the file"))
                })?;
                let framed = framed(start..file.len(), appended.is_base64)?;
                match framed.plain_start(file)? {
                    Some(start) => Place::Plain { start, end: start + len },
                    None => Place::Framed(framed),
                }
            }
        };
        Ok(PointArray {
            piece: Some(self.piece),
            points: self.points,
            components: self.components,
            sample: self.sample,
            writing,
            place,
            is_exact: !is_appended,
            data,
        })
    }
}

fn type_of(name: &str) -> Option<SampleType> {
    Some(match name {
        "Int8" => SampleType::I8,
        "UInt8" => SampleType::U8,
        "Int16" => SampleType::I16,
        "UInt16" => SampleType::U16,
        "Int32" => SampleType::I32,
        "UInt32" => SampleType::U32,
        "Int64" => SampleType::I64,
        "UInt64" => SampleType::U64,
        "Float32" => SampleType::F32,
        "Float64" => SampleType::F64,
        _ => return None,
    })
}
