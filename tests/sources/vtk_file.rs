//! Writes VTK files according to "VTK file formats", by code that shares nothing with the reader.

use std::io::Write;

use spmesh_stream::model::bounds::Point;

/// How an array is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    Ascii,
    Binary,
    AppendedRaw,
    AppendedBase64,
}

/// How blocks are compressed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Packing {
    Plain,
    Zlib,
    Lz4,
}

/// An XML file.
#[derive(Debug, Clone)]
pub struct VtkXml {
    pub form: Form,
    pub packing: Packing,
    pub is_wide: bool,
    pub is_big: bool,
    pub is_double: bool,
    /// Uncompressed bytes of a block.
    pub block_len: usize,
    pub pieces: Vec<Vec<Point>>,
}

impl VtkXml {
    /// Uncompressed appended doubles, as this project writes them.
    pub fn of(pieces: Vec<Vec<Point>>) -> Self {
        VtkXml {
            form: Form::AppendedRaw,
            packing: Packing::Plain,
            is_wide: true,
            is_big: false,
            is_double: true,
            block_len: 100,
            pieces,
        }
    }

    /// The file. One array stands before the points, and one after them.
    pub fn bytes(&self) -> Vec<u8> {
        let order = if self.is_big { "BigEndian" } else { "LittleEndian" };
        let lengths = if self.is_wide { "UInt64" } else { "UInt32" };
        let compressor = match self.packing {
            Packing::Plain => "",
            Packing::Zlib => " compressor=\"vtkZLibDataCompressor\"",
            Packing::Lz4 => " compressor='vtkLZ4DataCompressor'",
        };
        let mut text = format!(
            "<?xml version=\"1.0\"?>\n<!-- <Points> -->\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" \
             byte_order=\"{order}\" header_type=\"{lengths}\"{compressor}>\n<UnstructuredGrid>\n<FieldData>\n\
             <DataArray type=\"Float64\" Name=\"TIME\" format=\"ascii\">0.5</DataArray></FieldData>\n"
        );
        let mut appended = Vec::new();
        for piece in &self.pieces {
            let temperatures: Vec<f64> = piece.iter().map(|point| point[0] + 1.0).collect();
            text += &format!("<Piece NumberOfPoints=\"{}\" NumberOfCells='0'>\n<PointData>\n", piece.len());
            text += &self.array("Name=\"t\"", &temperatures, &mut appended);
            text += "</PointData>\n<Points>\n";
            let attributes = "Name=\"Points\" NumberOfComponents=\"3\"";
            text += &self.array(attributes, piece.as_flattened(), &mut appended);
            text += "</Points>\n<Cells>\n";
            text += &self.array("Name=\"offsets\"", &[], &mut appended);
            text += "</Cells>\n</Piece>\n";
        }
        text += "</UnstructuredGrid>\n";
        let encoding = match self.form {
            Form::AppendedRaw => "raw",
            Form::AppendedBase64 => "base64",
            _ => return (text + "</VTKFile>\n").into_bytes(),
        };
        let mut bytes = (text + &format!("<AppendedData encoding=\"{encoding}\">\n  _")).into_bytes();
        bytes.extend(appended);
        bytes.extend(b"\n</AppendedData>\n</VTKFile>\n");
        bytes
    }

    fn array(&self, attributes: &str, values: &[f64], appended: &mut Vec<u8>) -> String {
        let kind = if self.is_double { "Float64" } else { "Float32" };
        let open = format!("<DataArray type=\"{kind}\" {attributes}");
        match self.form {
            Form::Ascii => {
                let values: Vec<String> = values.iter().map(f64::to_string).collect();
                format!("{open} format=\"ascii\">\n {}\n</DataArray>\n", values.join(" \n "))
            }
            Form::Binary => {
                let text = String::from_utf8(self.packed(values, true)).unwrap();
                format!("{open} format=\"binary\">\n  {text}\n<InformationKey/></DataArray>\n")
            }
            Form::AppendedRaw | Form::AppendedBase64 => {
                let offset = appended.len();
                appended.extend(self.packed(values, self.form == Form::AppendedBase64));
                format!("{open} format=\"appended\" offset=\"{offset}\"/>\n")
            }
        }
    }

    /// Lengths and data of an array.
    fn packed(&self, values: &[f64], is_base64: bool) -> Vec<u8> {
        let bytes: Vec<u8> = values
            .iter()
            .flat_map(|&value| match (self.is_double, self.is_big) {
                (true, false) => value.to_le_bytes().to_vec(),
                (true, true) => value.to_be_bytes().to_vec(),
                (false, false) => (value as f32).to_le_bytes().to_vec(),
                (false, true) => (value as f32).to_be_bytes().to_vec(),
            })
            .collect();
        let length = |len: usize| match (self.is_wide, self.is_big) {
            (true, false) => (len as u64).to_le_bytes().to_vec(),
            (true, true) => (len as u64).to_be_bytes().to_vec(),
            (false, false) => (len as u32).to_le_bytes().to_vec(),
            (false, true) => (len as u32).to_be_bytes().to_vec(),
        };
        let encoded = |bytes: &[u8]| if is_base64 { base64(bytes) } else { bytes.to_vec() };
        if self.packing == Packing::Plain {
            return encoded(&[length(bytes.len()), bytes].concat());
        }
        let blocks: Vec<Vec<u8>> = bytes.chunks(self.block_len).map(|block| self.compressed(block)).collect();
        let mut lengths = [blocks.len(), self.block_len, bytes.len() % self.block_len].map(length).concat();
        blocks.iter().for_each(|block| lengths.extend(length(block.len())));
        // The lengths are encoded separately from the data.
        [encoded(&lengths), encoded(&blocks.concat())].concat()
    }

    fn compressed(&self, block: &[u8]) -> Vec<u8> {
        if self.packing == Packing::Lz4 {
            return lz4(block);
        }
        let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::default());
        encoder.write_all(block).unwrap();
        encoder.finish().unwrap()
    }
}

/// An LZ4 block that is one run of literals. The high half of the token is 15, so the length goes on in the
/// following bytes, up to and including the first that is less than 255.
fn lz4(literals: &[u8]) -> Vec<u8> {
    if literals.len() < 15 {
        return [&[(literals.len() as u8) << 4], literals].concat();
    }
    let mut block = vec![0xf0];
    let more = literals.len() - 15;
    block.resize(1 + more / 255, 255);
    block.push((more % 255) as u8);
    block.extend(literals);
    block
}

/// Base64 with padding (RFC 4648).
fn base64(bytes: &[u8]) -> Vec<u8> {
    const ALPHABET: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = Vec::new();
    for group in bytes.chunks(3) {
        let byte = |at: usize| u32::from(group.get(at).copied().unwrap_or(0));
        let bits = byte(0) << 16 | byte(1) << 8 | byte(2);
        for digit in 0..4 {
            let is_padding = digit > group.len();
            text.push(if is_padding { b'=' } else { ALPHABET[(bits >> (18 - 6 * digit) & 63) as usize] });
        }
    }
    text
}
