//! The table of formats.

use std::path::Path;

/// A format that streams are converted from or to. A new format is one row in the table of this file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// The binary stream.
    Spm,
    /// Its text twin.
    Text,
    /// Wavefront OBJ.
    Obj,
    /// Stanford PLY.
    Ply,
    /// Isenburg's streaming points, text.
    Spa,
    /// Isenburg's streaming points, binary.
    Spb,
    /// Isenburg's streaming meshes, text.
    Sma,
    /// Isenburg's streaming meshes, binary.
    Smb,
    /// VTK's unstructured grids in XML; written only.
    Vtu,
    /// Medit's meshes as text; written only.
    Medit,
    /// AutoCAD's DXF as text; written only.
    Dxf,
    /// LandXML; written only.
    LandXml,
    /// GeoJSON of the edges on lines; written only.
    GeoJson,
    /// Points as `spfinalize` reads them: LAS, LAZ, COPC, lines of coordinates, VTK; read only.
    Points,
}

struct Row {
    format: Format,
    name: &'static str,
    /// Empty if several extensions or none stand for it.
    extension: &'static str,
    is_binary: bool,
    is_read: bool,
    is_written: bool,
}

const ROWS: [Row; 14] = [
    Row {
        format: Format::Spm,
        name: "spm",
        extension: "spm",
        is_binary: true,
        is_read: true,
        is_written: true,
    },
    Row {
        format: Format::Text,
        name: "text",
        extension: "txt",
        is_binary: false,
        is_read: true,
        is_written: true,
    },
    Row {
        format: Format::Obj,
        name: "obj",
        extension: "obj",
        is_binary: false,
        is_read: true,
        is_written: true,
    },
    Row {
        format: Format::Ply,
        name: "ply",
        extension: "ply",
        is_binary: true,
        is_read: true,
        is_written: true,
    },
    Row {
        format: Format::Spa,
        name: "spa",
        extension: "spa",
        is_binary: false,
        is_read: true,
        is_written: true,
    },
    Row {
        format: Format::Spb,
        name: "spb",
        extension: "spb",
        is_binary: true,
        is_read: true,
        is_written: true,
    },
    Row {
        format: Format::Sma,
        name: "sma",
        extension: "sma",
        is_binary: false,
        is_read: true,
        is_written: true,
    },
    Row {
        format: Format::Smb,
        name: "smb",
        extension: "smb",
        is_binary: true,
        is_read: true,
        is_written: true,
    },
    Row {
        format: Format::Vtu,
        name: "vtu",
        extension: "vtu",
        is_binary: true,
        is_read: false,
        is_written: true,
    },
    Row {
        format: Format::Medit,
        name: "medit",
        extension: "mesh",
        is_binary: false,
        is_read: false,
        is_written: true,
    },
    Row {
        format: Format::Dxf,
        name: "dxf",
        extension: "dxf",
        is_binary: false,
        is_read: false,
        is_written: true,
    },
    Row {
        format: Format::LandXml,
        name: "landxml",
        extension: "xml",
        is_binary: false,
        is_read: false,
        is_written: true,
    },
    Row {
        format: Format::GeoJson,
        name: "geojson",
        extension: "geojson",
        is_binary: false,
        is_read: false,
        is_written: true,
    },
    Row {
        format: Format::Points,
        name: "points",
        extension: "",
        is_binary: false,
        is_read: true,
        is_written: false,
    },
];

impl Format {
    fn row(self) -> &'static Row {
        ROWS.iter().find(|row| row.format == self).expect("every format has its row")
    }

    /// Names of the formats that are written.
    pub fn names_written() -> impl Iterator<Item = &'static str> {
        ROWS.iter().filter(|row| row.is_written).map(|row| row.name)
    }

    /// Names of the formats that are read.
    pub fn names_read() -> impl Iterator<Item = &'static str> {
        ROWS.iter().filter(|row| row.is_read).map(|row| row.name)
    }

    /// Whether it is read.
    pub fn is_read(self) -> bool {
        self.row().is_read
    }

    /// The format with this name, if there is one.
    pub fn from_name(name: &str) -> Option<Self> {
        ROWS.iter().find(|row| row.name == name).map(|row| row.format)
    }

    /// The format that the extension of `path` names, if it names one.
    pub fn from_path(path: &Path) -> Option<Self> {
        let extension = path.extension()?.to_str()?;
        if extension.is_empty() {
            return None;
        }
        ROWS.iter().find(|row| row.extension.eq_ignore_ascii_case(extension)).map(|row| row.format)
    }

    /// Name on the command line.
    pub fn name(self) -> &'static str {
        self.row().name
    }

    /// Whether the format is binary, so that a terminal cannot show it.
    pub fn is_binary(self) -> bool {
        self.row().is_binary
    }
}
