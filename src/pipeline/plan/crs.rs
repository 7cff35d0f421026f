//! Coordinate reference systems in plans.

use data_encoding::HEXLOWER;
use serde::{Deserialize, Serialize};

use spmesh_base::error::{Error, Result};
use spmesh_stream::Crs;

/// A coordinate reference system: text, or the three GeoTIFF records of LAS files in hexadecimal digits.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum PlannedCrs {
    Unknown,
    Wkt(String),
    GeoKeys([String; 3]),
}

impl PlannedCrs {
    pub(super) fn of(crs: &Crs) -> PlannedCrs {
        match crs {
            Crs::Unknown => PlannedCrs::Unknown,
            Crs::Wkt(text) => PlannedCrs::Wkt(text.clone()),
            Crs::GeoKeys { directory, doubles, ascii } => {
                PlannedCrs::GeoKeys([directory, doubles, ascii].map(|bytes| HEXLOWER.encode(bytes)))
            }
        }
    }

    pub(super) fn crs(&self) -> Result<Crs> {
        let bytes = |text: &String| {
            HEXLOWER.decode(text.as_bytes()).map_err(|e| Error::malformed(format!("coordinate system: {e}")))
        };
        Ok(match self {
            PlannedCrs::Unknown => Crs::Unknown,
            PlannedCrs::Wkt(text) => Crs::Wkt(text.clone()),
            PlannedCrs::GeoKeys([directory, doubles, ascii]) => {
                Crs::GeoKeys { directory: bytes(directory)?, doubles: bytes(doubles)?, ascii: bytes(ascii)? }
            }
        })
    }
}
